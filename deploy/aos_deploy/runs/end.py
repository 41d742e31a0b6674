"""The end of a run: what stopped it goes into the journal, and the verdict comes out of that alone.

Exit code, summary and last line are made from the verdict. A run that ended otherwise than by its mission has
the end that `aos-up` has seen as the last row of its journal.
"""

from pathlib import Path

from msgspec.structs import replace

from aos_deploy.exit_codes import ExitCode, exit_code_of_mission
from aos_deploy.runs.record import RunEnd
from aos_protocol.errors import AosError, StorageError
from aos_protocol.messages import BeliefSummary, DecisionRecord, MissionBegun, MissionState
from aos_protocol.mission_rows import BEGUN, DECISION, STATE
from aos_runtime.disk.journal import Journal, JournalRow, rows_of
from aos_runtime.disk.mission_folders import JOURNAL, journals


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


def account_of(run: Path) -> Account:
    """The account in a run's journal, an empty one if it has none; StorageError AOS702 if it is damaged."""
    account = Account()
    if (run / JOURNAL).exists():
        for row in rows_of(run / JOURNAL):
            message = message_of_row(row)
            if message is not None:
                account.take(message)
    return account


def beginning_of(run: Path) -> MissionBegun | None:
    """The first `begun` row of a mission's folder; None where there is none, or it cannot be read."""
    path = run / JOURNAL
    if not path.is_file():
        return None
    try:
        with Journal.read(path) as journal:
            row = next(journal.walk(BEGUN), None)
            return None if row is None else row.read_as(MissionBegun)
    except StorageError:
        return None


def ending_without_summary(folder: Path) -> str:
    """The ending of a run, or of one of its missions, that is over and has no summary.

    Where the journal has none either, it is `killed`, or `not_started` where no mission had begun. Its aos-up
    was killed then, or had no space on the disk.
    """
    # A solver on a full disk has made a file, and written nothing to it.
    written = [path for path in journals(folder).values() if path.exists() and path.stat().st_size]
    if not written:
        return "not_started"
    try:
        ending = account_of(folder).verdict().ending
    except AosError:
        return "killed"
    has_begun = any(beginning_of(path.parent) is not None for path in written)
    return ending or ("killed" if has_begun else "not_started")


def settled(
    run: Path, heard: Account, *, stopped_by: AosError | None, was_interrupted: bool, mission: str = ""
) -> tuple[Verdict, StorageError | None]:
    """The verdict on a run whose processes are gone, and why the journal has not all of it, if it has not.

    `run` is the folder of the mission, which has the `mission`'s name where that is not the folder's.
    Where the journal cannot be read the verdict is on `heard` from the bus. Where it cannot be written,
    as on a full disk, the end is not in it, but the verdict is the same.
    """
    lacking: StorageError | None = None
    try:
        account = account_of(run)
        if heard.has_ended and not (run / JOURNAL).exists():
            raise StorageError(f"the journal {run / JOURNAL} was removed while it was written", code="AOS702")
    except StorageError as error:
        account, lacking = heard, error
    stopped = None
    if was_interrupted or stopped_by is not None:
        stopped = account.stopped(mission or run.name, stopped_by)
    if stopped is not None:
        account.take(stopped)
        try:
            with Journal.open(run / JOURNAL) as journal:
                journal.append(STATE, stopped)
        except StorageError as error:
            lacking = lacking or error
    return account.verdict(), lacking
