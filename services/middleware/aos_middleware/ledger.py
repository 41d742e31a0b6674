"""Which activations were started and how they ended, so that a repeated request moves nothing twice."""

from __future__ import annotations

from pathlib import Path
from typing import Self

import msgspec

from aos_protocol.messages import Activate, ActivationId, Fault, Outcome, Stray
from aos_runtime.journal import Journal

__all__ = ["OutcomeLedger"]

_STARTED = "started"
_ENDED = "ended"
_STRAY = "stray"


class OutcomeLedger:
    """Outcomes by activation id, on the disk before they are told."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._outcomes: dict[ActivationId, Outcome | None] = {}
        self._skills: dict[ActivationId, str] = {}
        for row in journal.rows():
            if row.kind == _STARTED:
                request = msgspec.json.decode(row.payload, type=Activate)
                self._outcomes.setdefault(request.id, None)
                self._skills[request.id] = request.skill
            elif row.kind == _ENDED:
                outcome = msgspec.json.decode(row.payload, type=Outcome)
                self._outcomes[outcome.id] = outcome

    @classmethod
    def open(cls, path: Path) -> Self:
        """The ledger in a file, created if it is not there; StorageError if it cannot be read."""
        # After a loss of power no mission goes on, and its ids are never used again.
        return cls(Journal.open(path, survives_power_loss=False))

    def close(self) -> None:
        self._journal.close()

    def start(self, request: Activate) -> None:
        """Notes that an activation begins."""
        self._journal.append(_STARTED, request)
        self._outcomes[request.id] = None
        self._skills[request.id] = request.skill

    def end(self, outcome: Outcome) -> None:
        """Notes how an activation ended."""
        self._journal.append(_ENDED, outcome)
        self._outcomes[outcome.id] = outcome

    def note(self, stray: Stray) -> None:
        """Keeps a reply that was not used."""
        self._journal.append(_STRAY, stray)

    def outcomes(self) -> list[Outcome]:
        """How the activations ended that did, in the order in which they were started."""
        return [outcome for outcome in self._outcomes.values() if outcome is not None]

    def outcome(self, activation: ActivationId) -> Outcome | None:
        """The outcome of an activation that was started before, None for a new one.

        `unknown` if it was started and never ended: the service went down in between.
        """
        if activation not in self._outcomes:
            return None
        ended = self._outcomes[activation]
        if ended is not None:
            return ended
        fault = Fault(
            "AOS504",
            f"activation {activation} was running when the middleware went down",
            "Whether the skill did its work is not known; it is not run a second time",
        )
        return Outcome(activation, self._skills[activation], "unknown", fault=fault)
