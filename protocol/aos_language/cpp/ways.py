"""The local variables that have no value yet, along the ways that lead to a place in C++ statements."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec


class Ways(msgspec.Struct, frozen=True):
    """The ways on which a variable is without a value: all of them (`never` set), or some.

    `under` are the names in the conditions under which it was set on the others.
    """

    never: bool = True
    under: frozenset[str] = frozenset()


class State(msgspec.Struct):
    """The variables without a value on some way to a place. `ended`: no way goes on from here."""

    unset: dict[str, Ways] = {}
    ended: bool = False

    def copy(self) -> State:
        return State(dict(self.unset), self.ended)

    def set(self, name: str) -> None:
        """Notes that the name has a value from here on."""
        self.unset.pop(name, None)


def merged(states: Iterable[State], under: frozenset[str] = frozenset()) -> State:
    """The state where ways meet; `under` is what the condition names that parted them."""
    going = [state for state in states if not state.ended]
    if not going:
        return State(ended=True)
    unset = {}
    for name in {name for state in going for name in state.unset}:
        ways = [state.unset[name] for state in going if name in state.unset]
        names = frozenset[str]().union(*(way.under for way in ways))
        is_set = len(ways) < len(going)
        unset[name] = Ways(not is_set and all(way.never for way in ways), names | under if is_set else names)
    return State(unset)
