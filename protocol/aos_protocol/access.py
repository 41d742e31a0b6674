"""The table of who may do what on the bus, from which everything that keeps others out is made.

A party asks, answers, tells, hears, announces and watches keys; what no row allows is denied. The router
enforces the table, and `Bus` looks at it before it sends. A new key is a row here, below its line in
`keys.py`; nothing else has to be changed.

    registry, middleware, solver   the services
    adapter                        each adapter by its own name, for the paths that the deploy file gives it
    server                         what `aos-up --serve` starts
    operator                       aos-up, the commands that change something, programs that command
    watcher                        `aos decisions`, programs that only look on

The router carries everything and says nothing itself.
"""

from functools import lru_cache
from typing import Literal, NamedTuple

import msgspec

from aos_protocol.keys import Keys

Act = Literal["asks", "answers", "tells", "hears", "announces", "watches"]
ACTS: tuple[Act, ...] = ("asks", "answers", "tells", "hears", "announces", "watches")

REGISTRY, MIDDLEWARE, SOLVER = "registry", "middleware", "solver"
ADAPTER, SERVER, OPERATOR, WATCHER = "adapter", "server", "operator", "watcher"
ROLES = (REGISTRY, MIDDLEWARE, SOLVER, ADAPTER, SERVER, OPERATOR, WATCHER)
_SERVICES = (REGISTRY, MIDDLEWARE, SOLVER, ADAPTER, SERVER)
_MOVERS = (MIDDLEWARE, SERVER, OPERATOR)

ROUND_TRIP = "aos/round-trip"
"""Everybody may ask for this presence, which there never is: the router's answer is what counts."""


class Row(NamedTuple):
    """The roles that may do something with a key. The key is written as in `keys.py`, without `aos/<robot>/`.

    `<path>` is one of the adapter's own where it answers, tells or announces, and any path elsewhere; so are
    `<service>` and `<adapter>` with its name. `<topic>` is any path.
    """

    key: str
    asks: tuple[str, ...] = ()
    answers: tuple[str, ...] = ()
    tells: tuple[str, ...] = ()
    hears: tuple[str, ...] = ()
    announces: tuple[str, ...] = ()
    watches: tuple[str, ...] = ()


TABLE: tuple[Row, ...] = (
    Row("live/<service>", announces=_SERVICES, watches=ROLES),
    Row("bundle/push", asks=(OPERATOR,), answers=(REGISTRY,)),
    Row("bundle/remove", asks=(OPERATOR,), answers=(REGISTRY,)),
    Row("bundle/history", asks=(OPERATOR, WATCHER), answers=(REGISTRY,)),
    Row("bundle/project", asks=(MIDDLEWARE, SOLVER, ADAPTER, OPERATOR, WATCHER), answers=(REGISTRY,)),
    Row("bundle/list", asks=(OPERATOR, WATCHER), answers=(REGISTRY,)),
    Row("bundle/announced", tells=(REGISTRY,), hears=(MIDDLEWARE, SOLVER, ADAPTER, OPERATOR, WATCHER)),
    Row("bundle/report", tells=(REGISTRY,), hears=(OPERATOR, WATCHER)),
    Row("activate/<skill>", asks=(SOLVER,), answers=(MIDDLEWARE,)),
    Row(
        "middleware/ready",
        asks=(SOLVER, OPERATOR, WATCHER),
        answers=(MIDDLEWARE,),
        tells=(MIDDLEWARE,),
        hears=(SOLVER, OPERATOR, WATCHER),
    ),
    Row(
        "serve/<adapter>/<version>/<instance>/<path>",
        announces=(ADAPTER,),
        watches=(MIDDLEWARE, SOLVER, SERVER, OPERATOR, WATCHER),
    ),
    Row("lack/<adapter>/<reason>/<path>", announces=(ADAPTER,), watches=(MIDDLEWARE, OPERATOR)),
    Row("returning/<program>", announces=(OPERATOR,), watches=(MIDDLEWARE, OPERATOR)),
    Row("call/<path>", asks=_MOVERS, answers=(ADAPTER,)),
    Row("cancel/<path>", asks=(*_MOVERS, SOLVER), answers=(ADAPTER,)),
    Row("progress/<path>", tells=(ADAPTER,), hears=(MIDDLEWARE, SERVER, OPERATOR, WATCHER)),
    Row("topic/<topic>", tells=(ADAPTER,), hears=(MIDDLEWARE, ADAPTER, SERVER, OPERATOR, WATCHER)),
    Row("model/check", asks=(REGISTRY,), answers=(SOLVER,)),
    Row("mission/start", asks=(OPERATOR,), answers=(SOLVER,)),
    Row("mission/stop", asks=(OPERATOR,), answers=(SOLVER,)),
    Row("mission/list", asks=(ADAPTER, OPERATOR, WATCHER), answers=(SOLVER,)),
    Row("mission/resume", asks=(OPERATOR,), answers=(SOLVER,)),
    Row("mission/steer", asks=(OPERATOR,), answers=(SOLVER,)),
    Row(
        "mission/state",
        asks=(MIDDLEWARE, ADAPTER, OPERATOR, WATCHER),
        answers=(SOLVER,),
        tells=(SOLVER,),
        hears=(MIDDLEWARE, ADAPTER, OPERATOR, WATCHER),
    ),
    Row("decision/record", tells=(SOLVER,), hears=(OPERATOR, WATCHER)),
    Row("decision/history", asks=(OPERATOR, WATCHER), answers=(SOLVER,)),
    Row("study/why", asks=(OPERATOR, WATCHER), answers=(SOLVER,)),
    Row("study/whatif", asks=(OPERATOR, WATCHER), answers=(SOLVER,)),
    Row("study/tree", asks=(OPERATOR, WATCHER), answers=(SOLVER,)),
)


class Party(msgspec.Struct, frozen=True, kw_only=True):
    """Somebody on the bus: `name` is that of its credential, `role` one of ROLES.

    An adapter serves its `paths`, and with `serves_others` all paths but those `elsewhere`.
    """

    name: str
    role: str
    paths: tuple[str, ...] = ()
    serves_others: bool = False
    elsewhere: tuple[str, ...] = ()


class Grant(NamedTuple):
    """A key expression that a party may use, or with `is_denied` may not although a wider one is granted."""

    act: Act
    key: str
    is_denied: bool = False


@lru_cache(maxsize=256)
def grants(robot: str, party: Party) -> tuple[Grant, ...]:
    """Returns what the party may do on the bus of a robot."""
    root = f"aos/{Keys(robot).robot}"
    given = [
        Grant(act, f"{root}/{key}", is_denied)
        for row in TABLE
        for act in ACTS
        if party.role in getattr(row, act)
        for key, is_denied in _keys(row.key, act, party)
    ]
    return (*given, Grant("watches", ROUND_TRIP))


def may(robot: str, party: Party, act: Act, key: str) -> bool:
    """Says whether the party may do this with a key, or with all keys of an expression."""
    matching = [
        grant.is_denied for grant in grants(robot, party) if grant.act == act and includes(grant.key, key)
    ]
    return bool(matching) and not any(matching)


def includes(pattern: str, key: str) -> bool:
    """Says whether a key expression includes a key or another expression: `*` is one part, `**` any."""
    return _includes(pattern.split("/"), key.split("/"))


def _includes(pattern: list[str], key: list[str]) -> bool:
    if not pattern or not key:
        return not key and all(part == "**" for part in pattern)
    first, *rest = pattern
    if first == "**":
        return _includes(rest, key) or _includes(pattern, key[1:])
    return (first == key[0] or (first == "*" and key[0] != "**")) and _includes(rest, key[1:])


def _keys(key: str, act: Act, party: Party) -> list[tuple[str, bool]]:
    """The expressions that a row's key stands for, each with whether it is denied."""
    is_own = act in ("answers", "tells", "announces")
    if not is_own:
        for name in ("<adapter>/<version>/<instance>/<path>", "<adapter>/<reason>/<path>"):
            key = key.replace(name, "**")
        key = key.replace("<service>", "*")
    for name, filling in (("<service>", party.name), ("<adapter>", party.name), ("<topic>", "**")):
        key = key.replace(name, filling)
    for name in ("<skill>", "<version>", "<instance>", "<reason>", "<program>"):
        key = key.replace(name, "*")
    if "<path>" not in key:
        return [(key, False)]
    if not is_own:
        return [(key.replace("<path>", "**"), False)]
    allowed = ("**",) if party.serves_others else party.paths
    found = [(key.replace("<path>", path.strip("/")), False) for path in allowed]
    denied = party.elsewhere if party.serves_others else ()
    return found + [(key.replace("<path>", path.strip("/")), True) for path in denied]
