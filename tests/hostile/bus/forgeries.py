"""Messages that somebody makes up in mid-mission: each must change nothing, and be told in a log."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple

import msgspec
import zenoh
from zenoh.handlers import Callback

from aos_protocol.access import OPERATOR, SOLVER, WATCHER
from aos_protocol.codec import decode_fault, encode
from aos_protocol.errors import BusError
from aos_protocol.keys import Keys, Serving
from aos_protocol.messages import (
    ActivationId,
    Cancel,
    MappingState,
    Message,
    MissionState,
    PushBundle,
    SkillCall,
    StartMission,
    StopMission,
)
from aos_runtime.bus.config import client_config
from aos_runtime.bus.credentials import Credential

from .cell import ROBOT, Cell
from .routed import round_trip

KEYS = Keys(ROBOT)
_HAND = "hand"
"""An adapter of the system, whose credential somebody has."""
_ANSWER_S = 3.0


class Forgery(NamedTuple):
    """An attempt: what it gets, which must be what is named, and the log where it is told, by which words."""

    name: str
    attempt: Callable[[Cell], str]
    gets: str
    log: str = "router"
    told: str = ""


def faults_of(cell: Cell, forgery: Forgery) -> list[str]:
    before = cell.moved
    got = forgery.attempt(cell)
    faults = [] if got == forgery.gets else [f"it got {got!r}, not {forgery.gets!r}"]
    if cell.moved != before:
        faults.append("the robot moved")
    if forgery.told and not _is_told(cell, forgery):
        faults.append(f"{forgery.told!r} is not in the log of {forgery.log}")
    return faults


def _is_told(cell: Cell, forgery: Forgery) -> bool:
    """The log is written by another process: it may be a moment behind."""
    deadline_s = time.monotonic() + _ANSWER_S
    while time.monotonic() < deadline_s:
        if forgery.told.format(mission=cell.mission) in cell.log(forgery.log):
            return True
        time.sleep(0.02)
    return False


# --- what is tried ---


def _connect(credential: Credential | None) -> Callable[[Cell], str]:
    def attempt(cell: Cell) -> str:
        config = client_config(cell.record.endpoint, credential=credential)
        try:
            zenoh.open(config).close()
        except zenoh.ZError:
            return "no connection"
        return "a connection"

    return attempt


def _tell(user: str, key: str, message: Callable[[Cell], Message]) -> Callable[[Cell], str]:
    def attempt(cell: Cell) -> str:
        session = cell.session(user)
        session.put(key, _encoded(message(cell)), congestion_control=zenoh.CongestionControl.BLOCK)
        round_trip(session)
        return "nothing"

    return attempt


def _delete(user: str, key: str) -> Callable[[Cell], str]:
    def attempt(cell: Cell) -> str:
        session = cell.session(user)
        session.delete(key)
        round_trip(session)
        return "nothing"

    return attempt


def _ask(user: str, key: str, message: Callable[[Cell], Message]) -> Callable[[Cell], str]:
    def attempt(cell: Cell) -> str:
        replies = cell.session(user).get(key, payload=_encoded(message(cell)), timeout=_ANSWER_S)
        return ", ".join(_text(reply) for reply in replies) or "nothing"

    return attempt


def _answer(
    user: str, key: str, asked: str, asker: str, message: Callable[[Cell], Message]
) -> Callable[[Cell], str]:
    """Somebody answers a key beside the one who should: the questions that he gets are counted."""

    def attempt(cell: Cell) -> str:
        taken: list[str] = []

        def on_query(query: zenoh.Query):
            with query:
                taken.append(str(query.key_expr))

        session, other = cell.session(user), cell.session(asker)
        queryable = session.declare_queryable(key, Callback(on_query, indirect=False), complete=True)
        round_trip(session, other)
        list(
            other.get(asked, payload=_encoded(message(cell)), timeout=_ANSWER_S, target=zenoh.QueryTarget.ALL)
        )
        round_trip(session)
        queryable.undeclare()
        return f"{len(taken)} questions" if taken else "nothing"

    return attempt


def _announce(user: str, key: str) -> Callable[[Cell], str]:
    def attempt(cell: Cell) -> str:
        session, other = cell.session(user), cell.session(OPERATOR)
        token = session.liveliness().declare_token(key)
        round_trip(session, other)
        seen = [reply for reply in other.liveliness().get(key, timeout=_ANSWER_S) if reply.ok is not None]
        token.undeclare()
        return "presence" if seen else "nothing"

    return attempt


def _encoded(message: Message) -> bytes:
    return encode(message, sender="solver", stamp_ns=time.time_ns())


def _text(reply: zenoh.Reply) -> str:
    if reply.ok is not None:
        return "an answer"
    try:
        return decode_fault(reply.err.payload.to_bytes()).code if reply.err else "an error"
    except (BusError, msgspec.MsgspecError):
        return "an error"


def _ended(cell: Cell) -> Message:
    return MissionState(cell.mission, "ended", 7, 1.0, ending="goal", remark="forged")


def _call(cell: Cell, **changes: Any) -> Message:
    call = SkillCall(ActivationId("by-hand", 1), "/open", {}, 5.0)
    return msgspec.structs.replace(call, **changes)


def _empty(_: Cell) -> Message:
    return StopMission()


def _denied(user: str, what: str, key: str) -> str:
    return f"{user} may not send {what} on {key}"


def _not_told(name: str, user: str, key: str, message: Callable[[Cell], Message]) -> Forgery:
    return Forgery(name, _tell(user, key, message), "nothing", told=_denied(user, "put", key))


def _not_asked(name: str, user: str, key: str, message: Callable[[Cell], Message]) -> Forgery:
    return Forgery(name, _ask(user, key, message), "nothing", told=_denied(user, "query", key))


def _not_answered(name: str, key: str, asked: str, message: Callable[[Cell], Message]) -> Forgery:
    told = _denied(_HAND, "declare queryable", key)
    return Forgery(name, _answer(_HAND, key, asked, OPERATOR, message), "nothing", told=told)


def _not_announced(name: str, key: str) -> Forgery:
    return Forgery(name, _announce(_HAND, key), "nothing", told=_denied(_HAND, "liveliness token", key))


def _with_id(cell: Cell, **changes: Any) -> Message:
    return _call(cell, id=ActivationId(cell.mission, 1), **changes)


_OPEN = KEYS.call("/open")

FORGERIES = (
    Forgery("a stranger connects", _connect(None), "no connection", told="a connection without a name"),
    Forgery(
        "a stranger guesses a password",
        _connect(Credential(OPERATOR, "guessed")),
        "no connection",
        told="a connection with a wrong password",
    ),
    Forgery(
        "a stranger has a name of his own",
        _connect(Credential("stranger", "guessed")),
        "no connection",
        told="a connection with an unknown name",
    ),
    _not_told("a watcher tells that the mission has ended", WATCHER, KEYS.mission_state, _ended),
    _not_told("an adapter tells it", _HAND, KEYS.mission_state, _ended),
    _not_told("the operator tells it", OPERATOR, KEYS.mission_state, _ended),
    Forgery(
        "somebody with the solver's password tells it",
        _tell(SOLVER, KEYS.mission_state, _ended),
        "nothing",
        log="aos-up",
        told="not believed: {mission} has ended, goal; its journal says that it goes on",
    ),
    Forgery(
        "a watcher deletes the state",
        _delete(WATCHER, KEYS.mission_state),
        "nothing",
        told=_denied(WATCHER, "delete", KEYS.mission_state),
    ),
    _not_answered("an adapter answers for the solver", KEYS.mission_state, KEYS.mission_state, _empty),
    _not_asked("a watcher calls a skill", WATCHER, _OPEN, _call),
    _not_asked("an adapter calls another one's skill", _HAND, _OPEN, _call),
    Forgery(
        "somebody calls with the epoch 999",
        _ask(OPERATOR, _OPEN, lambda cell: _with_id(cell, epoch=999)),
        "AOS506",
        log="python",
        told="AOS506",
    ),
    Forgery(
        "somebody calls with the epoch 999 for a mission to come",
        _ask(OPERATOR, _OPEN, lambda cell: _call(cell, id=ActivationId("to-come", 1), epoch=999)),
        "AOS506",
        log="python",
        told="to-come-1 comes from epoch 999",
    ),
    Forgery(
        "somebody uses an id of the mission for another motion",
        _ask(OPERATOR, _OPEN, _with_id),
        "AOS514",
        log="python",
        told="AOS514",
    ),
    Forgery("a call is in the way of the mission's", _ask(OPERATOR, _OPEN, _call), "AOS502"),
    _not_asked("a watcher stops the mission", WATCHER, KEYS.stop_mission, _empty),
    _not_asked("an adapter cancels what moves", _HAND, KEYS.cancel("/step"), lambda _: Cancel("forged")),
    _not_asked("an adapter starts a mission", _HAND, KEYS.start_mission, lambda _: StartMission()),
    _not_answered("an adapter answers for another one's path", _OPEN, _OPEN, _call),
    _not_answered("an adapter answers for all paths", f"aos/{ROBOT}/call/**", _OPEN, _call),
    _not_announced(
        "an adapter announces that it serves another one's path",
        KEYS.serve(Serving(_HAND, "1", "x", "/step")),
    ),
    _not_announced("an adapter announces a service", KEYS.live("ghost")),
    _not_asked(
        "a watcher pushes documents",
        WATCHER,
        KEYS.push_bundle,
        lambda _: PushBundle({"step.sd": b"project: cell\n"}),
    ),
    _not_told(
        "an adapter tells that other mappings run", _HAND, KEYS.mapping_state, lambda _: MappingState(99, ())
    ),
)
