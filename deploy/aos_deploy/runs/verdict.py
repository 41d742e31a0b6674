"""The verdict on a run: a function of its journal, and of nothing else.

Exit code, summary and last line are made from it. A run that ended otherwise than by its mission has the end
that `aos-up` has seen as the last row of its journal.
"""

from msgspec.structs import replace

from aos_deploy.exit_codes import ExitCode, exit_code_of_mission
from aos_deploy.runs.summary import RunEnd
from aos_protocol.errors import AosError
from aos_protocol.messages import BeliefSummary, DecisionRecord, MissionState
from aos_protocol.mission_rows import DECISION, STATE
from aos_runtime.disk.journal import JournalRow


class Verdict(RunEnd, frozen=True, kw_only=True):
    """The end of a run; the `ending` is empty where it goes on, or where its `aos-up` was killed.

    The endings are those of a mission, and `not_started` where a fault came before the first decision.
    """

    @property
    def steps(self) -> int:
        """The number of decisions."""
        return len(self.actions)


class Account:
    """Takes a mission's rows in their order, or the same messages from the bus, and gives the verdict."""

    def __init__(self) -> None:
        self.state: MissionState | None = None
        self._actions: dict[int, str] = {}
        self._responses: dict[int, str] = {}
        self._belief: BeliefSummary | None = None

    @property
    def has_begun(self) -> bool:
        """Says whether anything was decided."""
        return bool(self._actions)

    @property
    def has_ended(self) -> bool:
        """Says whether the last state is an end."""
        return self.state is not None and self.state.phase == "ended"

    def take(self, message: DecisionRecord | MissionState) -> None:
        """One more of the mission's messages; one that was taken before changes nothing."""
        if isinstance(message, MissionState):
            self.state = message
            return
        self._actions[message.step] = message.action
        self._responses.setdefault(message.step, "")
        if message.outcome is not None:
            self._responses[message.step] = message.outcome.response
        self._belief = message.belief

    def stopped(self, mission: str, error: AosError | None) -> MissionState | None:
        """The end of a run that this error has ended, or without one an interrupt.

        None where the mission had ended before; where it ended by a fault, the error may be the cause.
        """
        state = self.state or MissionState(mission, "waiting", 0, 0.0)
        if self.has_ended and (state.ending != "fault" or error is None):
            return None
        changes = {"ending": "cancelled", "remark": "interrupted"}
        if error is not None:
            ending = "fault" if self.has_begun else "not_started"
            changes = {"ending": ending, "remark": str(error), "code": error.code}
        goal = self._belief.goal_probability if self._belief else 0.0
        return replace(state, phase="ended", goal_probability=goal, **changes)

    def verdict(self) -> Verdict:
        """The verdict on what was taken so far."""
        state = self.state if self.has_ended else None
        belief = self._belief
        cautious = None if belief is None else belief.cautious or belief
        steps = sorted(self._actions)
        return Verdict(
            ending=state.ending if state else "",
            remark=state.remark if state else "",
            exit_code=int(exit_code_of_mission(state) if state else ExitCode.FAULT),
            actions=tuple(self._actions[step] for step in steps),
            responses=tuple(self._responses[step] for step in steps),
            goal_probability=belief.goal_probability if belief else 0.0,
            cautious_goal_probability=cautious.goal_probability if cautious else 0.0,
            over_probability=belief.over_probability if belief else 0.0,
            failure_probability=belief.failure_probability if belief else 0.0,
        )


def message_of_row(row: JournalRow) -> DecisionRecord | MissionState | None:
    """The decision or state in a row, None in those of other kinds; StorageError AOS702 if it is damaged."""
    if row.kind == DECISION:
        return row.read_as(DecisionRecord)
    return row.read_as(MissionState) if row.kind == STATE else None
