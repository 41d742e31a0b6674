"""The past of a mission: the fold of its journal.

An empty journal folds to the start of a mission, so that starting and taking up are one path.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import msgspec

from aos_protocol.errors import StorageError
from aos_protocol.messages import Activate, DecisionRecord, MissionBegun, MissionState, Outcome
from aos_runtime.journal import JournalRow

__all__ = ["BEGUN", "MissionMemory", "PastStep", "Pending", "folded"]

BEGUN = "begun"
"""The kind of the row with which each solver begins, or takes up, a mission."""

_KINDS: dict[str, type[Any]] = {
    BEGUN: MissionBegun,
    "decision": DecisionRecord,
    "intended": Activate,
    "outcome": Outcome,
    "mission": MissionState,
}


class PastStep(NamedTuple):
    """A step that is over: the record of its decision, and that of its outcome."""

    decision: DecisionRecord
    observed: DecisionRecord


class Pending(NamedTuple):
    """A step that is not over. Without an `intention` nothing was asked; with an `outcome` all was."""

    decision: DecisionRecord
    intention: Activate | None = None
    outcome: Outcome | None = None


class MissionMemory(msgspec.Struct, frozen=True):
    """The epoch of the newest solver, the steps in order, the step that is not over, the newest state."""

    epoch: int = 0
    steps: tuple[PastStep, ...] = ()
    pending: Pending | None = None
    state: MissionState | None = None

    @property
    def has_ended(self) -> bool:
        return self.state is not None and self.state.phase == "ended"

    @property
    def is_held(self) -> bool:
        """True where the mission held when its journal broke off."""
        return self.state is not None and self.state.phase == "holding"

    @property
    def records(self) -> list[DecisionRecord]:
        """The records in the order of their sequence numbers."""
        decided = [record for step in self.steps for record in step]
        return decided if self.pending is None else [*decided, self.pending.decision]


def folded(rows: Iterable[JournalRow]) -> MissionMemory:
    """The memory that a mission's journal holds; StorageError AOS702 for a row that is damaged."""
    epoch, pending, state = 0, None, None
    steps: list[PastStep] = []
    for row in rows:
        if row.kind not in _KINDS:
            continue
        said = _decoded(row)
        match said:
            case MissionBegun():
                epoch = said.epoch
            case MissionState():
                state = said
            case DecisionRecord(outcome=None):
                pending = Pending(said)
            case DecisionRecord():
                steps.append(PastStep(_of(pending, row).decision, said))
                pending = None
            case Activate():
                pending = _of(pending, row)._replace(intention=said)
            case Outcome():
                pending = _of(pending, row)._replace(outcome=said)
    return MissionMemory(epoch, tuple(steps), pending, state)


def _decoded(row: JournalRow) -> Any:
    try:
        return msgspec.json.decode(row.payload, type=_KINDS[row.kind])
    except msgspec.MsgspecError as error:
        raise StorageError(f"row {row.seq} of the journal is damaged: {error}", code="AOS702") from error


def _of(pending: Pending | None, row: JournalRow) -> Pending:
    if pending is None:
        raise StorageError(f"row {row.seq} of the journal, {row.kind}, follows no decision", code="AOS702")
    return pending
