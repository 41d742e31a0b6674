"""The durations of missions in a system that stays."""

from pathlib import Path

from decision_records import decision_record

from aos_deploy.deployment.reading import read_deploy_file
from aos_deploy.missions.system_run import SystemRun, _durations
from aos_protocol.messages import MissionEntry, MissionState
from aos_runtime.clock import SystemClock
from aos_runtime.disk.journal import Journal

ENTRY = MissionEntry("r-2", 2, 1, begun_ns=90 * 10**9)


class Clock(SystemClock):
    """Both clocks as the test sets them."""

    wall_s = monotonic_at_s = 100

    def now_ns(self) -> int:
        return self.wall_s * 10**9

    def monotonic_s(self) -> float:
        return float(self.monotonic_at_s)


def test_a_mission_lasts_as_long_as_the_monotonic_clock_says(root: Path):
    clock = Clock()
    run = SystemRun(read_deploy_file(root / "deploy/errand.yaml"), lambda _: None, clock)
    decided = decision_record(0, "r-2")
    for event in (MissionState("r-1", "planning", 0, 0.0, epoch=1), decision_record(0, "r-1")):
        run._take(event)
    for event in (MissionState("r-2", "planning", 0, 0.0, epoch=1), decided, decision_record(2, "r-2")):
        clock.monotonic_at_s += 3
        run._take(event)
    assert run._measured(ENTRY) == {"first_decision_s": 3.0, "duration_s": 6.0}
    assert run._measured(MissionEntry("r-1", 1, 1, begun_ns=0)) is None


def test_a_mission_that_nobody_heard_begin_lasts_as_long_as_its_journal_and_never_less_than_nothing(
    tmp_path: Path,
):
    clock = Clock()
    with Journal.open(tmp_path / "journal.db", clock=clock) as journal:
        journal.append("decision", decision_record(0))
        clock.wall_s = 120
        journal.append("decision", decision_record(1))
    found = _durations(tmp_path / "journal.db", ENTRY.begun_ns)
    assert found == {"first_decision_s": 10.0, "duration_s": 30.0}
    assert set(_durations(tmp_path / "journal.db", 10**12).values()) == {0.0}
