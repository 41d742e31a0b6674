"""The look at the table before anything is sent: the router denies in silence, and our own mistakes are to be
told."""

from __future__ import annotations

from aos_protocol.access import Act, Party, may
from aos_protocol.errors import BusError

_WORDS: dict[Act, str] = {
    "asks": "ask",
    "answers": "answer",
    "tells": "tell anything on",
    "hears": "listen on",
    "announces": "announce",
    "watches": "watch",
}


class Access:
    """Knows what one party may do on the bus of one robot."""

    def __init__(self, robot: str, party: Party) -> None:
        self._robot = robot
        self._party = party
        self._known: dict[tuple[Act, str], bool] = {}

    def allows(self, act: Act, key: str) -> bool:
        """Says whether the router lets it through."""
        is_allowed = self._known.get((act, key))
        if is_allowed is None:
            is_allowed = may(self._robot, self._party, act, key)
            if is_allowed:
                self._known[act, key] = True
        return is_allowed

    def check(self, act: Act, key: str) -> None:
        """Raises BusError AOS608 where the router would say nothing and deny it."""
        if not self.allows(act, key):
            raise BusError(
                f"{self._party.name} may not {_WORDS[act]} {key}", code="AOS608", hint=_hint(self._party, act)
            )


def _hint(party: Party, act: Act) -> str:
    if party.role == "adapter" and act in ("answers", "announces"):
        return f"Give the path to {party.name} under `bind:` in the deploy file"
    return "docs/protocol.md has the table of who may do what"
