from decision_records import decision_record
from places import DEPLOY

from aos_deploy.deployment.reading import read_deploy_file
from aos_deploy.missions.system_run import SystemRun
from aos_protocol.messages import MissionEntry, MissionState
from aos_runtime.clock import SystemClock

ENTRY = MissionEntry("r-2", 2, 1, begun_ns=90 * 10**9)


class Clock(SystemClock):
    """Goes on as the test says; the wall clock does not."""

    now_s = 100.0

    def monotonic_s(self) -> float:
        return self.now_s


def test_a_mission_lasts_as_long_as_the_monotonic_clock_says():
    clock = Clock()
    run = SystemRun(read_deploy_file(DEPLOY / "errand.yaml"), lambda _: None, clock)
    decided = decision_record(0, "r-2")
    for event in (MissionState("r-1", "planning", 0, 0.0, epoch=1), decision_record(0, "r-1")):
        run._take(event)
    for event in (MissionState("r-2", "planning", 0, 0.0, epoch=1), decided, decision_record(2, "r-2")):
        clock.now_s += 3
        run._take(event)
    assert run._measured(ENTRY) == {"first_decision_s": 3.0, "duration_s": 6.0}
    assert run._measured(MissionEntry("r-1", 1, 1, begun_ns=0)) is None
