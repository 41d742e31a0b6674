import signal
import sys
from pathlib import Path

import pytest
from processes import finished

from aos_runtime.disk.journal import Journal
from aos_runtime.failpoints import EXIT_STATUS

APPENDS = """
import sys
from pathlib import Path
from aos_protocol.errors import StorageError
from aos_protocol.messages import Cancel
from aos_runtime.disk.journal import Journal
with Journal.open(Path("journal.db")) as journal:
    for number in range(3):
        try:
            journal.append("decision", Cancel(str(number)))
        except StorageError as error:
            print(error.code)
print("went on")
"""


def appended(folder: Path, armed: str) -> tuple[int, str, int]:
    """The exit status, the output and the rows of a process that appends three times."""
    environment = {"AOS_FAILPOINT": armed, "AOS_FAILPOINT_DONE": str(folder / "done")}
    ran = finished(sys.executable, "-c", APPENDS, cwd=folder, env=environment)
    with Journal.read(folder / "journal.db") as journal:
        return ran.returncode, ran.stdout, journal.last


@pytest.mark.parametrize(
    ("armed", "status", "rows"),
    [
        ("journal.decision.before:kill", -signal.SIGKILL, 0),
        ("journal.decision.after:kill", -signal.SIGKILL, 1),
        ("journal.decision.before:exit:3", EXIT_STATUS, 2),
        ("journal.outcome.before:kill", 0, 3),
        ("", 0, 3),
    ],
)
def test_a_process_fails_where_it_should_and_its_rows_stay(armed, status, rows, tmp_path):
    assert appended(tmp_path, armed)[::2] == (status, rows)


def test_a_process_that_is_started_again_goes_on(tmp_path):
    assert appended(tmp_path, "journal.decision.after:kill")[0] == -signal.SIGKILL
    assert appended(tmp_path, "journal.decision.after:kill") == (0, "went on\n", 4)


def test_a_disk_that_is_full_stays_so(tmp_path):
    assert appended(tmp_path, "journal.decision.before:full:2") == (0, "AOS701\nAOS701\nwent on\n", 1)
