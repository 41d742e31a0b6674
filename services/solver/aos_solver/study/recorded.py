"""The journal of a mission as what a replay needs: what began, what was decided, what came of it."""

from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

import msgspec

from aos_protocol.errors import SkillError
from aos_protocol.messages import BeliefRow, DecisionRecord, MissionBegun, ModelAdopted
from aos_protocol.mission_rows import ADOPTED, BEGUN, DECISION
from aos_runtime.disk.journal import JournalRow
from aos_solver.mission.records.belief_rows import BELIEF

Event = MissionBegun | ModelAdopted | DecisionRecord | BeliefRow

M = TypeVar("M", MissionBegun, ModelAdopted, DecisionRecord, BeliefRow)

_KINDS: dict[str, type[Any]] = {
    BEGUN: MissionBegun,
    ADOPTED: ModelAdopted,
    DECISION: DecisionRecord,
    BELIEF: BeliefRow,
}


class RecordedEvent(msgspec.Struct, frozen=True):
    """A row of the journal with its number."""

    row: int
    said: Event


class RecordedMission(msgspec.Struct, frozen=True):
    """The rows in their order."""

    events: tuple[RecordedEvent, ...]

    @property
    def begun(self) -> MissionBegun | None:
        """The row with which the first solver began the mission; None where none has."""
        return next(self.of_kind(MissionBegun), None)

    @property
    def decisions(self) -> tuple[DecisionRecord, ...]:
        """The decisions; of a step that was decided twice the later one."""
        made = {said.step: said for said in self.of_kind(DecisionRecord) if said.outcome is None}
        return tuple(made[step] for step in sorted(made))

    def of_kind(self, kind: type[M]) -> Iterator[M]:
        return (event.said for event in self.events if isinstance(event.said, kind))

    def decision(self, step: int) -> DecisionRecord:
        """The decision of a step, or for step 0 the newest; SkillError AOS501 if there was none."""
        last = self.decisions[-1].step if self.decisions else 0
        found = next((made for made in self.decisions if made.step == (step or last)), None)
        if found is None:
            hint = f"Name a step from 1 to {last}" if last else "It has none yet, or ended before the first"
            raise SkillError(
                f"the mission has no decision{f' of step {step}' if step else ''}", code="AOS501", hint=hint
            )
        return found

    def outcome(self, step: int) -> DecisionRecord | None:
        """The record of what came of a step; None where that is not known yet."""
        records = self.of_kind(DecisionRecord)
        return next((said for said in records if said.step == step and said.outcome is not None), None)


def recorded(rows: Iterable[JournalRow]) -> RecordedMission:
    """The mission that a journal holds; StorageError AOS702 for a row that cannot be read."""
    return RecordedMission(tuple(_events(rows)))


def _events(rows: Iterable[JournalRow]) -> Iterator[RecordedEvent]:
    for row in rows:
        if row.kind in _KINDS:
            yield RecordedEvent(row.seq, row.read_as(_KINDS[row.kind]))
