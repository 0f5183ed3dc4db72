"""Tests marked `apart` run in a process of their own, because CARLA's client can end its process.

A test's process is a fork of the tests' own, in which the fixtures of its module (a server) have been made: those are
shared and end with the module. Its own fixtures are made and ended in its process.
"""

from __future__ import annotations

import contextlib
import copy
import os
import pickle
import signal
import warnings
from collections.abc import Iterator
from typing import Any

import pytest
from _pytest.outcomes import OutcomeException
from _pytest.runner import runtestprotocol

TRIES = 2
"""How often a test is begun whose process is ended by a signal: the client has such faults of its own."""

HANGS_AFTER = 600
"""Seconds after which a test's process is ended by SIGALRM. The client's Traffic Manager can miss that a tick begins,
and waits for it forever: `TrafficManagerLocal::SynchronousTick` (0.9.16) wakes its thread without holding the lock with
which that thread looks whether it may sleep.
"""

SHARED = ("session", "package", "module")


def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
    """Run a marked test in a process of its own."""
    if item.get_closest_marker("apart") is None or not isinstance(item, pytest.Function):
        return None
    state: Any = item.session._setupstate
    try:
        state.setup(item.parent)
        _make_shared(item)
    except (Exception, OutcomeException):
        state.teardown_exact(nextitem)
        return None  # what cannot be made is reported as it is of any test
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    for report in _reports(item):
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    state.teardown_exact(nextitem)
    return True


def _make_shared(item: pytest.Function) -> None:
    """Make the fixtures that a test shares with others of its module."""
    found: Any = item._fixtureinfo.name2fixturedefs
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pytest.PytestRemovedIn10Warning)  # the test itself has not begun
        for name in item.fixturenames:
            if name in found and found[name][-1].scope in SHARED:
                item._request.getfixturevalue(name)


def _reports(item: pytest.Function) -> Iterator[pytest.TestReport]:
    ended = 0
    for _ in range(TRIES):
        reports, ended = _run(item)
        if not ended:
            for data in reports:
                yield item.config.hook.pytest_report_from_serializable(config=item.config, data=data)
            if not reports:
                yield _failed(item, "the process of the test ended without a report")
            return
    yield _failed(item, f"the process of the test was ended {TRIES} times, by {signal.Signals(ended).name}")


def _failed(item: pytest.Function, told: str) -> pytest.TestReport:
    return pytest.TestReport(item.nodeid, item.location, {}, "failed", told, "call")


def _run(item: pytest.Function) -> tuple[list[dict[str, Any]], int]:
    """Return the reports of a test that runs in a new process, and the signal that ended the process, 0 for none.

    They are pickled, which keeps tuples: pytest looks for the reason of a skip in one.
    """
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # what has threads here holds no lock that a test takes
        child = os.fork()
    if not child:
        os.close(reading)
        _run_here(item, writing)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        written = pipe.read()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return [], os.WTERMSIG(status)
    return pickle.loads(written) if written else [], 0


def _run_here(item: pytest.Function, writing: int) -> None:
    """Run a test, write its reports, and end the process without the client's destructors."""
    signal.alarm(HANGS_AFTER)
    with contextlib.suppress(BaseException), os.fdopen(writing, "wb") as pipe:
        sibling = copy.copy(item)  # one whose module goes on: only the test's own fixtures end here
        reports = runtestprotocol(item, log=False, nextitem=sibling)
        write = item.config.hook.pytest_report_to_serializable
        pipe.write(pickle.dumps([write(config=item.config, report=report) for report in reports]))
    os._exit(0)
