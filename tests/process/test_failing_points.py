"""Missions that fail at a failpoint are completed: a share of `make chaos`."""

import sys

from places import ROOT
from processes import finished

RUNS = ("failpoint:journal.intended.after:1", "readonly:middleware.started.before:1")


def test_missions_keep_what_is_promised():
    ran = finished(sys.executable, "-m", "tests.chaos", "--again", *RUNS, cwd=ROOT)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert f"{len(RUNS)} of {len(RUNS)} runs kept what is promised" in ran.stdout
