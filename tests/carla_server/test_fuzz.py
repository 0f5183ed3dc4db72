"""Whatever is sent to either port ends its own connection with one line, and nothing else."""

from __future__ import annotations

import contextlib
import random  # noqa: TID251  # for bytes of any kind, from a seed
import socket
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgpack
import pytest

from scenario_compiler.carla_server.protocol import CALLS
from tests.carla_server.conftest import PATIENCE, Served, served
from tests.carla_server.test_clients import resident
from tests.carla_server.values import value_of

DISTURBING = ("load_new_episode", "copy_opendrive_to_file", "start_recorder", "replay_file")
"""Calls that take long or write files; they have tests of their own."""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("fuzz"), "--map", "open_ground") as running:
        yield running


def connection(port: int) -> socket.socket:
    return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)


def ask(port: int, name: str = "version") -> Any:
    """Return the answer to a call, over a new connection."""
    with connection(port) as link:
        link.sendall(msgpack.packb([0, 1, name, [[False]]]))
        unpacker = msgpack.Unpacker()
        while True:
            unpacker.feed(link.recv(1 << 16))
            for message in unpacker:
                return message[3]


def is_ended(link: socket.socket) -> bool:
    """Return whether the other side has ended a connection."""
    with contextlib.suppress(ConnectionResetError, BrokenPipeError):
        while link.recv(1 << 16):
            pass
    return True


def anything(dice: random.Random, depth: int = 0) -> Any:
    """Return a value of any type."""
    kinds = [
        lambda: dice.randint(-(1 << 63), (1 << 64) - 1),
        lambda: dice.choice([0, 1, -1, 24, 25, 255, 1 << 31]),
        lambda: dice.choice([0.0, -1.0, 1e308, float("nan"), float("inf"), dice.gauss(0, 1e6)]),
        lambda: dice.random() < 0.5,
        lambda: None,
        lambda: "".join(chr(dice.randint(1, 0x2FF)) for _ in range(dice.randint(0, 20))),
        lambda: dice.randbytes(dice.randint(0, 30)),
        lambda: [anything(dice, depth + 1) for _ in range(dice.randint(0, 4))] if depth < 5 else [],
        lambda: {str(anything(dice, 5)): anything(dice, depth + 1)} if depth < 5 else {},
    ]
    made: Callable[[], Any] = dice.choice(kinds)
    return made()


def mutant(dice: random.Random, value: Any) -> Any:
    """Return a value with something in it changed."""
    if isinstance(value, list) and value and dice.random() < 0.8:
        changed = list(value)
        at = dice.randrange(len(changed))
        what = dice.random()
        if what < 0.1:
            del changed[at]
        elif what < 0.2:
            changed.insert(at, anything(dice))
        else:
            changed[at] = mutant(dice, changed[at])
        return changed
    return anything(dice)


def calls(dice: random.Random, count: int) -> Iterator[bytes]:
    """Yield calls of the table with arguments of which something is changed, or none, or all."""
    table = [call for call in CALLS if call.name not in DISTURBING]
    for number in range(count):
        call = dice.choice(table)
        given: Any = [value_of(layout.name) for layout in call.takes]
        if dice.random() < 0.7:
            given = mutant(dice, given)
        meta = [dice.random() < 0.5] if dice.random() < 0.95 else anything(dice)
        yield msgpack.packb([0, number, call.name, [meta, *(given if isinstance(given, list) else [given])]])


def send_calls(server: Served, count: int, seed: int) -> None:
    """Send calls over a connection after the other; each that is no call by its form ends one."""
    dice = random.Random(seed)
    link = connection(server.port)
    waiting = 0
    for packed in calls(dice, count):
        try:
            link.sendall(packed)
            waiting += 1
            if waiting == 50:
                unpacker = msgpack.Unpacker(strict_map_key=False, unicode_errors="surrogateescape")
                while waiting > 0:
                    answers = link.recv(1 << 20)
                    if not answers:
                        raise ConnectionResetError
                    unpacker.feed(answers)
                    waiting -= sum(1 for _ in unpacker)
        except OSError:
            link.close()
            link, waiting = connection(server.port), 0
    link.close()


def send_noise(port: int, count: int, seed: int) -> None:
    """Send bytes that are nothing, or the start of something."""
    dice = random.Random(seed)
    for _ in range(count):
        what = dice.randrange(4)
        noise = dice.randbytes(dice.randint(1, 400))
        if what == 1:
            whole = msgpack.packb([0, 1, "spawn_actor", [[False], anything(dice)]])
            noise = whole[: dice.randrange(len(whole))]
        elif what == 2:
            noise = msgpack.packb(anything(dice))
        elif what == 3:
            noise = struct.pack("<I", dice.randint(0, 1 << 32 - 1)) + dice.randbytes(dice.randint(0, 8))
        with contextlib.suppress(OSError), connection(port) as link:
            link.sendall(noise)


@pytest.mark.parametrize(
    "noise",
    [
        b"\xc1",
        b"GET / HTTP/1.1\r\n\r\n",
        msgpack.packb([0, 1, "version"]),
        msgpack.packb([7, 1, "version", []]),
        msgpack.packb([0, 1, 5, []]),
        msgpack.packb([0, "one", "version", [[False]]]),
        msgpack.packb({"version": 1}),
        b"\x91" * 100_000,
        b"\xdd\xff\xff\xff\xff",
        b"\xc6\xff\xff\xff\xff" + b"x" * 100,
    ],
    ids=["reserved", "http", "short", "kind", "name", "id", "map", "nested", "array", "bytes"],
)
def test_what_is_no_call_ends_its_connection(server: Served, noise: bytes) -> None:
    with connection(server.port) as link:
        link.sendall(noise)
        link.shutdown(socket.SHUT_WR)
        assert is_ended(link)
    assert ask(server.port) == [[1, "0.9.16"]]


def test_a_listener_that_says_more_than_its_number_is_ended(server: Served) -> None:
    for noise in (struct.pack("<I", 77), struct.pack("<I", 1) + b"more", b"\xff" * 100):
        with connection(server.port + 0) as calls_link:
            calls_link.sendall(msgpack.packb([0, 1, "get_episode_info", [[False]]]))
            token = msgpack.unpackb(calls_link.recv(4096))[3][0][1][1][0]
        port = struct.unpack("<IHBB16x", token)[1]
        with connection(port) as link:
            link.sendall(noise)
            assert is_ended(link)
    assert ask(server.port) == [[1, "0.9.16"]]


def fuzzed(server: Served, count: int) -> None:
    memory = resident(server.process.pid)
    send_calls(server, count, 1)
    send_noise(server.port, count // 50, 2)
    assert server.process.poll() is None
    assert ask(server.port) == [[1, "0.9.16"]]
    first, second = ask(server.port, "tick_cue"), ask(server.port, "tick_cue")
    assert second[0][1] > first[0][1]
    assert resident(server.process.pid) - memory < 200 << 20


def test_calls_of_the_wrong_layout_do_no_harm(server: Served) -> None:
    fuzzed(server, 3000)


@pytest.mark.slow
def test_a_hundred_thousand_calls_do_no_harm(tmp_path: Path) -> None:
    with served(tmp_path, "--map", "open_ground") as running:
        fuzzed(running, 100_000)
