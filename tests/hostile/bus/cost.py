"""The cost of names, passwords and access control, for a question and for a session."""

import statistics
import time
from pathlib import Path

import zenoh
from zenoh.handlers import Callback

from aos_protocol.access import ADAPTER, OPERATOR, Party, grants
from aos_protocol.keys import Keys
from aos_runtime.access_check import Access
from aos_runtime.bus_config import client_config

from .matrix import PARTIES
from .routed import ROBOT, open_router, round_trip, routed

_KEY = Keys(ROBOT).call("/pick")
_ANSWER_S = 5.0


def cost(folder: Path, questions: int, sessions: int) -> str:
    """Lines with the medians of both, in turns."""
    with routed(folder, PARTIES) as router, open_router(folder) as endpoint:
        guarded = (router.session(OPERATOR), router.session("arm"))
        plain = tuple(zenoh.open(client_config(endpoint)) for _ in range(2))
        servers = [_serve(pair[1]) for pair in (guarded, plain)]
        for pair in (guarded, plain):
            round_trip(pair[1], pair[0])
        times: tuple[list[float], list[float]] = ([], [])
        for _ in range(questions):
            for own, pair in zip(times, (guarded, plain), strict=True):
                own.append(_asked_s(pair[0]))
        opening: tuple[list[float], list[float]] = ([], [])
        credential = router.passes.credential(OPERATOR)
        for _ in range(sessions):
            opening[0].append(_opened_s(client_config(router.endpoint, credential=credential)))
            opening[1].append(_opened_s(client_config(endpoint)))
        del servers
        for session in plain:
            session.close()
    lines = [_line("a question", *times), _line("a session", *opening), _check_line()]
    return "\n".join(lines)


def _serve(session: zenoh.Session) -> zenoh.Queryable[None]:
    def on_query(query: zenoh.Query) -> None:
        with query:
            query.reply(_KEY, b"answer")

    return session.declare_queryable(_KEY, Callback(on_query, indirect=False))


def _asked_s(session: zenoh.Session) -> float:
    started_s = time.perf_counter()
    (reply,) = session.get(_KEY, payload=b"question", timeout=_ANSWER_S)
    assert reply.ok is not None
    return time.perf_counter() - started_s


def _opened_s(config: zenoh.Config) -> float:
    started_s = time.perf_counter()
    session = zenoh.open(config)
    took_s = time.perf_counter() - started_s
    session.close()
    return took_s


def _check_line() -> str:
    access = Access(ROBOT, Party(name="arm", role=ADAPTER, paths=("/pick",)))
    key = Keys(ROBOT).progress("/pick")
    assert grants(ROBOT, PARTIES[0])
    access.check("tells", key)
    started_s = time.perf_counter()
    for _ in range(100_000):
        access.check("tells", key)
    return f"the look at the table before sending: {(time.perf_counter() - started_s) * 10:.2f} us"


def _line(what: str, guarded_s: list[float], plain_s: list[float]) -> str:
    known, unknown = (statistics.median(times) * 1e3 for times in (guarded_s, plain_s))
    return f"{what}: {known:.3f} ms with access control, {unknown:.3f} ms without, medians of {len(plain_s)}"
