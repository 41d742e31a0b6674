"""The end of a run: what stopped it goes into the journal, and the verdict comes out of that."""

from pathlib import Path

from aos_deploy.runs.verdict import Account, Verdict, message_of_row
from aos_protocol.errors import AosError, StorageError
from aos_protocol.messages import MissionBegun
from aos_protocol.mission_rows import BEGUN, STATE
from aos_runtime.disk.journal import Journal, rows_of
from aos_runtime.disk.mission_folders import JOURNAL, journals


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
