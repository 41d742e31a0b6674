from collections.abc import Callable, Sequence

from models import engine_of

from aos_protocol.messages import Activate, DecisionRecord, Fault, Message, MissionState, Outcome
from aos_runtime.clock import SystemClock
from aos_solver.building.build import BuiltModel
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.failures import FailureRules
from aos_solver.mission.rules.terms import Terms

Robot = Callable[[Activate], Outcome]


class Clock(SystemClock):
    def __init__(self) -> None:
        super().__init__()
        self.now_s = 0.0

    def monotonic_s(self) -> float:
        return self.now_s


class Surroundings(QuietPorts):
    """The surroundings of the loop: a journal that the test can read, and a robot."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.unavailable = {}
        self.announced = {}
        self.states: list[MissionState] = []
        self.on_hold: Callable[[], None] = lambda: None
        self.journalled: list[tuple[str, Message]] = []
        self.records: list[DecisionRecord] = []

    mission: Mission

    @property
    def decisions(self) -> Sequence[DecisionRecord]:
        return [record for record in self.records if record.outcome is None]

    @property
    def outcomes(self) -> Sequence[DecisionRecord]:
        return [record for record in self.records if record.outcome is not None]

    def journal(self, kind: str, payload: Message) -> None:
        self.journalled.append((kind, payload))

    def publish_record(self, record: DecisionRecord) -> None:
        self.records.append(record)

    def publish_state(self, state: MissionState) -> None:
        self.states.append(state)

    async def until_changed(self, timeout_s: float) -> None:
        self.on_hold()

    async def activate(self, request: Activate, action: str) -> Outcome:
        assert self.journalled[-1] == ("intended", request)
        return self._robot(request)


def observed(request: Activate, response: str) -> Outcome:
    return Outcome(request.id, request.skill, "observed", response)


def timed_out(request: Activate) -> Outcome:
    return Outcome(
        request.id, request.skill, "timed_out", fault=Fault("AOS503", "the skill took longer than it may")
    )


def jammed(request: Activate) -> Outcome:
    return Outcome(request.id, request.skill, "failed", fault=Fault("AOS510", "gripper jammed"))


def hears_left(request: Activate) -> Outcome:
    return observed(request, "tiger_left" if request.skill == "listen" else "opened")


def breaking(*, jams: int, is_late: int) -> Robot:
    ways = {jams: jammed, is_late: timed_out}
    return lambda request: ways.get(request.id.step, hears_left)(request)


_SEARCH = Search(simulations=100_000, seed=1)


async def run_mission(
    built: BuiltModel,
    robot: Robot,
    *,
    limits: MissionLimits | None = None,
    rules: FailureRules | None = None,
    around: Surroundings | None = None,
    hold_s: float = 600.0,
    search: Search = _SEARCH,
) -> tuple[MissionState, Surroundings]:
    """A whole mission; its end, and all that was told of it."""
    around = around or Surroundings(robot)
    terms = Terms(
        name="m",
        limits=limits or MissionLimits(),
        search=search,
        activation_timeout_s=1.0,
        failures=rules or FailureRules(),
        hold_s=hold_s,
    )
    async with engine_of(built) as engine:
        around.mission = Mission(terms, RunningModel(1, engine), around)
        return await around.mission.run(), around
