import signal
import subprocess
import sys

import msgspec

from aos_protocol.messages import Cancel
from aos_runtime.disk.journal import Journal

WRITE_FOR_EVER = """
import sys
from aos_protocol.messages import Cancel
from aos_runtime.disk.journal import Journal
journal = Journal.open(sys.argv[1])
while True:
    number = len(journal.rows()) + 1
    journal.append("number", Cancel(str(number)))
    print(number, flush=True)
"""


def test_every_row_that_was_acknowledged_survives_sigkill(tmp_path):
    path = tmp_path / "journal.db"
    acknowledged = 0
    for kill_after in (1, 7, 30):
        with subprocess.Popen(
            [sys.executable, "-c", WRITE_FOR_EVER, str(path)], stdout=subprocess.PIPE
        ) as writer:
            assert writer.stdout is not None
            for _ in range(kill_after):
                acknowledged = int(writer.stdout.readline())
            writer.send_signal(signal.SIGKILL)
            acknowledged = max([acknowledged, *(int(line) for line in writer.stdout)])

        with Journal.read(path) as journal:
            numbers = [int(msgspec.json.decode(row.payload, type=Cancel).reason) for row in journal.rows()]
        assert numbers == list(range(1, len(numbers) + 1))
        assert len(numbers) >= acknowledged
