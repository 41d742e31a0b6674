"""The activations that were started and how they ended, so that a repeated request moves nothing twice."""

from pathlib import Path

from aos_protocol.messages import Activate, ActivationId, Outcome, Stray
from aos_runtime.disk.ledger import Ledger


class OutcomeLedger(Ledger[Activate, Outcome]):
    """Outcomes by activation id. Those that assigned low-level values outlive their missions, as the values
    do."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, Activate, {"ended": Outcome})

    def note(self, stray: Stray) -> None:
        """Keeps a reply that was not used."""
        self._journal.append("stray", stray)

    def outcomes(self) -> list[Outcome]:
        """Returns the outcomes of the activations that ended, in the order in which they were started."""
        return [self._ended[id] for id in self._started if id in self._ended]

    def outcome(self, activation: ActivationId) -> Outcome | None:
        """The outcome of an activation that has ended; None for every other one."""
        return self._ended.get(activation)

    def outlives(self, end: Outcome) -> bool:
        return bool(end.assigned)
