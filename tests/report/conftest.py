"""Made-up runs for the tests of the report."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.report.run import Run
from scenario_compiler.roads.network import Network
from tests.report import made


@pytest.fixture(scope="session")
def network(repository: Path) -> Network:
    """The town that the made-up run takes place in."""
    return made.town(repository)


@pytest.fixture(scope="session")
def finished(network: Network) -> Run:
    """The made-up run with its pictures."""
    return made.run(network)
