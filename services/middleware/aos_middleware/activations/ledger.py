"""The activations that were started and how they ended, so that a repeated request moves nothing twice."""

from pathlib import Path
from typing import Self

from aos_protocol.messages import Activate, ActivationId, Outcome, Stray
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import is_before

_STARTED = "started"
_ENDED = "ended"
_STRAY = "stray"


class OutcomeLedger:
    """Outcomes by activation id, on the disk before they are told."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._requests: dict[ActivationId, Activate] = {}
        self._outcomes: dict[ActivationId, Outcome] = {}
        self._mission = ""
        for row in journal.rows():
            if row.kind == _STARTED:
                self._take(row.read_as(Activate))
            elif row.kind == _ENDED:
                outcome = row.read_as(Outcome)
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
        self._take(request)

    def end(self, outcome: Outcome) -> None:
        """Notes how an activation ended."""
        self._journal.append(_ENDED, outcome)
        self._outcomes[outcome.id] = outcome

    def note(self, stray: Stray) -> None:
        """Keeps a reply that was not used."""
        self._journal.append(_STRAY, stray)

    def requests(self) -> tuple[Activate, ...]:
        """Every activation that was started, in order."""
        return tuple(self._requests.values())

    def outcomes(self) -> list[Outcome]:
        """Returns the outcomes of the activations that ended, in the order in which they were started."""
        return [self._outcomes[id] for id in self._requests if id in self._outcomes]

    def outcome(self, activation: ActivationId) -> Outcome | None:
        """The outcome of an activation that has ended; None for every other one."""
        return self._outcomes.get(activation)

    def was_started(self, activation: ActivationId) -> bool:
        """Says whether an activation was begun, by this process or by an earlier one."""
        return activation in self._requests

    def _take(self, request: Activate) -> None:
        """Those of missions before it in the same system are on the disk, and nobody asks for them.

        Outcomes that assigned low-level values are kept: the values outlive the mission.
        """
        mission = request.id.mission
        if mission != self._mission:
            self._mission = mission
            self._outcomes = {
                id: outcome
                for id, outcome in self._outcomes.items()
                if outcome.assigned or not is_before(id.mission, mission)
            }
            self._requests = {
                id: earlier
                for id, earlier in self._requests.items()
                if id in self._outcomes or not is_before(id.mission, mission)
            }
        self._requests[request.id] = request
