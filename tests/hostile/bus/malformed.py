"""Messages that are none, on every key and from somebody who may send there: who listens goes on."""

from __future__ import annotations

import os
import random
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import msgspec
import zenoh
from zenoh.handlers import Callback

from aos_protocol.access import ADAPTER, OPERATOR, SERVER, TABLE, Row
from aos_protocol.codec import decode
from aos_protocol.errors import BusError
from aos_protocol.keys import Keys
from aos_protocol.messages import StopMission

from .cell import ROBOT, Cell
from .routed import round_trip

KEYS = Keys(ROBOT)
_IN_FLIGHT = 64
_ANSWER_S = 30.0
_LOOKS_S = 0.02
_MIXED = 2000
"""So many different messages are made; then they come again."""


class Flood(NamedTuple):
    """The consequences of messages on one key: times of good questions meanwhile, and how memory grew.

    Of the slowest question `waited_s` is how long threads of asker, router and services stood ready and got
    no processor, added up.
    """

    key: str
    sent: int
    took_s: float
    slowest_s: float
    waited_s: float
    grown_bytes: dict[str, int]


def noise(seed: int) -> list[bytes]:
    """Messages that nobody can read: random, cut off, nested, long, of another version, of other fields."""
    chance = random.Random(seed)
    good = msgspec.msgpack.encode({"version": "1.0", "stamp_ns": 1, "sender": "x", "body": {"id": [1, 2, 3]}})
    kinds = (
        lambda: b"",
        lambda: chance.randbytes(chance.randrange(1, 200)),
        lambda: good[: chance.randrange(1, len(good))],
        lambda: bytes(byte ^ (chance.random() < 0.1) for byte in good),
        lambda: b"\x91" * chance.randrange(1, 5000),
        lambda: b"\xdf\xff\xff\xff\xff" + chance.randbytes(20),
        lambda: b"\xc6\xff\xff\xff\xff",
        lambda: good.replace(b"1.0", b"9.9"),
        lambda: msgspec.msgpack.encode(
            {"version": "1.0", "stamp_ns": 1, "sender": "x", "body": chance.random()}
        ),
        lambda: msgspec.msgpack.encode(
            {"version": "1.0", "stamp_ns": 1, "sender": "x", "body": {"id": "x" * 5000}}
        ),
    )
    return [chance.choice(kinds)() for _ in range(_MIXED)]


def flooded_keys() -> Iterator[tuple[str, str, bool]]:
    for row in TABLE:
        key = row.key.replace("<path>", "step").replace("<skill>", "step").replace("<topic>", "camera")
        for act, is_question in (("asks", True), ("tells", False)):
            roles: tuple[str, ...] = getattr(row, act)
            if roles:
                yield _of_sender(row, key, roles, is_question)


def _of_sender(row: Row, key: str, roles: tuple[str, ...], is_question: bool) -> tuple[str, str, bool]:
    role = next((role for role in roles if role not in (ADAPTER, SERVER)), roles[0])
    user = "python" if role == ADAPTER else role
    return f"aos/{ROBOT}/{key}", user, is_question


def flooding(cell: Cell, key: str, user: str, is_question: bool, count: int) -> Flood:
    session, asker = cell.session(user), cell.session(OPERATOR)
    # A question with other fields is one to stop the mission all the same.
    messages = [one for one in noise(1) if key != KEYS.stop_mission or not _is_message(one)]
    before = {name: _memory_bytes(pid) for name, pid in cell.record.pids.items()}
    questions = _Questions(asker, [os.getpid(), *cell.record.pids.values()])
    started_s = time.monotonic()
    with questions:
        if is_question:
            _ask_all(session, key, messages, count)
        else:
            for number in range(count):
                session.put(
                    key, messages[number % len(messages)], congestion_control=zenoh.CongestionControl.BLOCK
                )
        round_trip(session, asker)
    took_s = time.monotonic() - started_s
    grown = {name: _memory_bytes(pid) - before[name] for name, pid in cell.record.pids.items()}
    slowest_s, waited_s = max(questions.times_s, default=(0.0, 0.0))
    return Flood(key, count, took_s, slowest_s, waited_s, grown)


def _ask_all(session: zenoh.Session, key: str, messages: list[bytes], count: int):
    free = threading.Semaphore(_IN_FLIGHT)
    for number in range(count):
        free.acquire()
        session.get(
            key,
            Callback(lambda _: None, free.release, indirect=False),
            payload=messages[number % len(messages)],
            timeout=_ANSWER_S,
        )
    for _ in range(_IN_FLIGHT):
        free.acquire()


class _Questions:
    """Good questions to registry, middleware and solver, one after the other, until the block ends."""

    def __init__(self, session: zenoh.Session, pids: list[int]):
        self._session = session
        self._pids = pids
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._ask)
        self.times_s: list[tuple[float, float]] = []
        """Times of each question: what it took, and what threads waited for a processor meanwhile."""

    def __enter__(self) -> _Questions:
        self._thread.start()
        return self

    def __exit__(self, *_: object):
        self._ended.set()
        self._thread.join()

    def _ask(self):
        body = {"version": "1.0", "stamp_ns": 1, "sender": "x", "body": {}}
        payload = msgspec.msgpack.encode(body)
        while not self._ended.wait(_LOOKS_S):
            for key in (KEYS.catalogue, KEYS.mapping_state, KEYS.mission_state):
                started_s, before_s = time.monotonic(), sum(map(_waited_s, self._pids))
                answers = [reply.ok for reply in self._session.get(key, payload=payload, timeout=_ANSWER_S)]
                is_answered = bool(answers) and answers[0] is not None
                took_s = time.monotonic() - started_s if is_answered else _ANSWER_S
                self.times_s.append((took_s, sum(map(_waited_s, self._pids)) - before_s))


def _is_message(payload: bytes) -> bool:
    try:
        return isinstance(decode(payload, StopMission), StopMission)
    except BusError:
        return False


def _waited_s(pid: int) -> float:
    """The time that the threads of a process stood ready and got no processor, of those that are there."""
    waited_ns = 0
    for task in Path(f"/proc/{pid}/task").iterdir():
        with suppress(OSError):  # It has ended meanwhile.
            waited_ns += int((task / "schedstat").read_text().split()[1])
    return waited_ns / 1e9


def _memory_bytes(pid: int) -> int:
    text = Path(f"/proc/{pid}/status").read_text()
    return int(text.partition("VmRSS:")[2].split()[0]) * 1024
