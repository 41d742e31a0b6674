import random
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import zenoh
from zenoh.handlers import Callback

from aos_protocol.access import (
    ACTS,
    ADAPTER,
    MIDDLEWARE,
    OPERATOR,
    REGISTRY,
    SERVER,
    SOLVER,
    TABLE,
    WATCHER,
    Act,
    Party,
    may,
)

from .routed import ROBOT, Routed, round_trip

PARTIES = (
    *(Party(name=role, role=role) for role in (REGISTRY, MIDDLEWARE, SOLVER)),
    Party(name="arm", role=ADAPTER, paths=("/pick", "/gripper/open")),
    Party(name="base", role=ADAPTER, serves_others=True, elsewhere=("/pick", "/gripper/open")),
    Party(name="serve-ros2", role=SERVER),
)
"""Those that `aos-up` starts; an operator and a watcher are there in every run."""

_ALL = (*PARTIES, *(Party(name=role, role=role) for role in (OPERATOR, WATCHER)))
_PATHS = ("pick", "gripper/open", "drive")
_STRANGE = ("mission/states", "call", "serve/arm/1/x", "nothing/of/the/table", "live/arm/more")
_PAYLOAD = b"attempt"
_ANSWER_S = 5.0


class Attempt(NamedTuple):
    party: Party
    act: Act
    key: str

    @property
    def is_allowed(self) -> bool:
        """Says what the table says."""
        return may(ROBOT, self.party, self.act, self.key)

    def __str__(self) -> str:
        return f"{self.party.name} {self.act} {self.key}"


def attempts(share: float = 1.0, seed: int = 1) -> Iterator[Attempt]:
    chance = random.Random(seed)
    for key in _keys():
        for party in _ALL:
            for act in ACTS:
                if share >= 1.0 or chance.random() < share:
                    yield Attempt(party, act, key)


def _keys() -> Iterator[str]:
    names = [party.name for party in _ALL]
    for row in TABLE:
        found = [row.key.replace("<skill>", "pick").replace("<topic>", "camera/front")]
        found = [key.replace("<version>", "1").replace("<instance>", "x") for key in found]
        for place, fillings in (("<service>", names), ("<adapter>", ["arm", "base"]), ("<path>", _PATHS)):
            found = [key.replace(place, filling) for key in found for filling in fillings]
        yield from (f"aos/{ROBOT}/{key}" for key in dict.fromkeys(found))
    yield from (f"aos/{ROBOT}/{key}" for key in _STRANGE)
    yield "aos/another/mission/state"


def wrong(routed: Routed, tried: Iterable[Attempt]) -> Iterator[str]:
    for attempt in tried:
        partners = [other for other in _ALL if other != attempt.party]
        able = [one for one in partners if may(ROBOT, one, _OPPOSITE[attempt.act], attempt.key)]
        # Where nobody may do the opposite, two try what neither may.
        partner, passes = (able or partners)[0], attempt.is_allowed and bool(able)
        has = has_effect(routed, attempt, partner)
        # Round trips of a busy machine overtake what was said before: Zenoh sends them first.
        again = (has_effect(routed, attempt, partner) for _ in range(4))
        if has != passes and not (passes and any(again)):
            yield f"{attempt}: {'passes' if has else 'has no effect'}"


def has_effect(routed: Routed, attempt: Attempt, partner: Party) -> bool:
    own, other = routed.session(attempt.party.name), routed.session(partner.name)
    is_first = attempt.act in ("asks", "tells", "announces")
    actor, listener = (own, other) if is_first else (other, own)
    return _EXCHANGES[attempt.act](actor, listener, attempt.key)


_OPPOSITE: dict[Act, Act] = {
    "asks": "answers",
    "answers": "asks",
    "tells": "hears",
    "hears": "tells",
    "announces": "watches",
    "watches": "announces",
}


def _asked(actor: zenoh.Session, partner: zenoh.Session, key: str) -> bool:
    """The actor asks, the partner answers: has the answer come?"""

    def on_query(query: zenoh.Query):
        with query:
            query.reply(key, _PAYLOAD)

    queryable = partner.declare_queryable(key, Callback(on_query, indirect=False))
    try:
        round_trip(partner, actor)
        replies = list(actor.get(key, payload=_PAYLOAD, timeout=_ANSWER_S))
    finally:
        queryable.undeclare()
        round_trip(partner, actor)
    return any(reply.ok is not None for reply in replies)


def _told(actor: zenoh.Session, partner: zenoh.Session, key: str) -> bool:
    heard: list[Any] = []
    subscriber = partner.declare_subscriber(key, Callback(heard.append, indirect=False))
    try:
        round_trip(partner, actor)
        actor.put(key, _PAYLOAD, congestion_control=zenoh.CongestionControl.BLOCK)
        round_trip(actor, partner)
    finally:
        subscriber.undeclare()
        round_trip(partner)
    return bool(heard)


def _announced(actor: zenoh.Session, partner: zenoh.Session, key: str) -> bool:
    seen: list[Any] = []
    watch = partner.liveliness().declare_subscriber(key, Callback(seen.append, indirect=False), history=True)
    try:
        round_trip(partner, actor)
        token = actor.liveliness().declare_token(key)
        round_trip(actor, partner)
        token.undeclare()
        round_trip(actor, partner)
    finally:
        watch.undeclare()
        round_trip(partner)
    return bool(seen)


_EXCHANGES: dict[Act, Callable[[zenoh.Session, zenoh.Session, str], bool]] = {
    "asks": _asked,
    "answers": _asked,
    "tells": _told,
    "hears": _told,
    "announces": _announced,
    "watches": _announced,
}
