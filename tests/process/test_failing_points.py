"""Missions that fail at a failpoint are completed: a share of `make chaos`."""

import subprocess
import sys
from pathlib import Path

from processes import COMMAND_S

RUNS = ("failpoint:journal.intended.after:1", "readonly:middleware.started.before:1")


def test_missions_keep_what_is_promised(root: Path):
    ran = subprocess.run(
        [sys.executable, "-m", "tests.chaos", "--again", *RUNS],
        cwd=root,
        capture_output=True,
        text=True,
        timeout=COMMAND_S,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert f"{len(RUNS)} of {len(RUNS)} runs kept what is promised" in ran.stdout
