import asyncio
import math
from collections.abc import AsyncIterator
from contextlib import suppress
from typing import Any

import pytest
import pytest_asyncio
from models import built_text, engine_of
from processes import HANG_S
from projects import text_project
from starting import until_present

from aos_middleware.service import serve
from aos_middleware.settings import Settings
from aos_protocol.documents import Project
from aos_protocol.keys import Keys, Serving
from aos_protocol.messages import (
    Activate,
    BeliefSummary,
    DecisionRecord,
    MappingQuery,
    MappingState,
    Message,
    MissionState,
    Outcome,
    ProjectQuery,
    ProjectRevision,
    SkillCall,
    SkillResult,
)
from aos_runtime.bus.bus import Bus
from aos_runtime.parties.reported_state import state_when
from aos_runtime.processes.lifecycle import serve_on_bus
from aos_solver.building.build import BuiltModel
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.terms import Terms

STOCK = {
    "stock.ef": """project: stock
horizon: 3
discount: 0.95

define_type: Shelf
variable: anyValue place of Pose

action_parameter: Shelf left
code:
state.left.place = ___left;

state_variable: int items

state_variable: bool is_tidy

state_variable: bool is_damp

initial_belief:
state.is_damp = AOS.Bernoulli(0.5);

reward_code:
if (state.items > 3 && state.is_tidy) {
    __reward = 10;
    __isGoalState = true;
}
""",
    "stock.lf": """project: stock

define_type: Pose
variable: float x

constant: Pose ___left
code:
___left.x = 1.0
""",
    "count.sd": """project: stock
parameter: Shelf shelf

dynamic_model:
state__.items = state.items + (AOS.Bernoulli(0.5) ? 4 : 1);
__moduleResponse = counted;
__observed.weight_kg = AOS.SampleNormal(state.is_damp ? 2 : 1, 0.5);
__reward = -1;
state_given_observation:
state___.is_tidy = state__.is_tidy || order > 0.5;
""",
    "count.am": """project: stock

response: counted
response_rule: True
assign_variable: shelf.place
value: Pose(x=seen_x)

module_activation: skill
path: /count
parameter: x
code:
place.x

local_variable: place
action_parameter: shelf.place

local_variable: items
type: int
from_ros_service_response: true
code:
items = __input.items

local_variable: order
type: float
from_ros_service_response: true
code:
order = __input.order

local_variable: weight_kg
type: float
from_ros_service_response: true
code:
weight_kg = __input.weight

local_variable: seen_x
from_ros_service_response: true
code:
seen_x = __input.x
""",
}

RUNS: tuple[dict[str, Any], ...] = (
    {"items": 2, "order": 0.1, "x": 1.25, "weight": 1.9},
    {"items": 2, "order": None, "x": 1.5, "weight": "?"},
    {"items": 7, "order": 0.9, "x": 1.75, "weight": 1.6},
)
"""The findings of the robot, run by run; the second time it cannot tell the order, nor the weight."""


class Robot(QuietPorts):
    """A middleware, and an adapter that answers from `RUNS`; the ports of a mission."""

    def __init__(self, bus: Bus, keys: Keys):
        self._bus = bus
        self._keys = keys
        self.calls: list[dict[str, Any]] = []
        self.outcomes: list[Outcome] = []
        self.records: list[DecisionRecord] = []

    async def run_skill(self, call: SkillCall, _: str) -> SkillResult:
        self.calls.append(call.fields)
        return SkillResult(call.id, RUNS[len(self.calls) - 1])

    def journal(self, kind: str, payload: Message):
        if isinstance(payload, Outcome):
            self.outcomes.append(payload)

    def publish_record(self, record: DecisionRecord):
        if record.outcome is not None:
            self.records.append(record)

    async def activate(self, request: Activate, action: str) -> Outcome:
        key = self._keys.activate(request.skill)
        return await self._bus.ask(key, request, Outcome, timeout_s=HANG_S)

    async def await_mappings(self):
        await state_when(
            self._bus,
            self._keys.mapping_state,
            MappingQuery(),
            MappingState,
            lambda state: bool(state.skills),
            timeout_s=HANG_S,
        )


@pytest_asyncio.fixture
async def robot(bus: Bus, other: Bus, keys: Keys, endpoint: str, tmp_path) -> AsyncIterator[Robot]:
    project: Project = text_project(STOCK)

    async def answer(_: ProjectQuery, __: str) -> ProjectRevision:
        return ProjectRevision(1, "digest", project)

    robot = Robot(bus, keys)
    await other.answer(keys.project, ProjectQuery, answer)
    await other.answer(keys.call("/count"), SkillCall, robot.run_skill)
    await other.announce(keys.serve(Serving("counter", "1", other.instance, "/count")))
    settings = Settings(
        robot=keys.robot, service="middleware", endpoint=endpoint, run_dir=str(tmp_path), project="stock"
    )
    async with until_present(bus, keys.live("middleware")):
        middleware = asyncio.create_task(serve_on_bus(settings, serve))
    try:
        await robot.await_mappings()
        yield robot
    finally:
        middleware.cancel()
        with suppress(asyncio.CancelledError):
            await middleware


@pytest_asyncio.fixture
async def stock() -> BuiltModel:
    return await built_text(STOCK)


async def mission(built: BuiltModel, robot: Robot) -> MissionState:
    limits = MissionLimits(step_limit=len(RUNS))
    terms = Terms(name="m", limits=limits, search=Search(simulations=200, seed=1), activation_timeout_s=10.0)
    async with engine_of(built) as engine:
        return await Mission(terms, RunningModel(1, engine), robot).run()


def values(belief: BeliefSummary, variable: str) -> dict[str, float]:
    return next(marginal.values for marginal in belief.marginals if marginal.variable == variable)


async def test_the_belief_follows_what_the_robot_finds_until_the_goal(robot: Robot, stock: BuiltModel):
    state = await mission(stock, robot)
    assert (state.ending, state.step) == ("goal", 3)
    first, second, third = robot.records
    assert values(first.belief, "items") == {"2": 1.0}, "the model alone holds 1 and 4 possible"
    assert values(first.belief, "is_tidy") == {"false": 1.0}
    assert values(second.belief, "items") == {"6": 0.5, "3": 0.5}
    assert second.remark.endswith("do not correct the belief: order has no value")
    assert (first.remark, third.remark) == ("", "")
    assert third.belief.goal_probability == pytest.approx(1.0)
    # A low-level value that came with a response is given to the next call.
    assert robot.calls == [{"x": 1.0}, {"x": 1.25}, {"x": 1.5}]

    # The journal holds what corrected the belief.
    told = robot.outcomes[0]
    assert (told.local_variables["items"], told.local_variables["order"]) == ("2", "0.1")
    assert told.assigned == {"left.place": {"x": 1.25}}
    # A number beside the response weighs the belief.
    assert [outcome.numbers for outcome in robot.outcomes] == [{"weight_kg": 1.9}, {}, {"weight_kg": 1.6}]
    damp = [values(record.belief, "is_damp").get("true", 0.0) for record in robot.records]
    odds = math.exp((0.9**2 - 0.1**2) / (2 * 0.25))
    assert damp[0] == damp[1] == pytest.approx(odds / (1 + odds))
    odds *= math.exp((0.6**2 - 0.4**2) / (2 * 0.25))
    assert damp[2] == pytest.approx(odds / (1 + odds))
    assert robot.records[1].remark.startswith(
        'the numbers of count(shelf=left) do not count (weight_kg = "?"): '
        "the model reports others with the response counted"
    )
    density = (math.exp(-2 * 0.9**2) + math.exp(-2 * 0.1**2)) / 2 / (0.5 * math.sqrt(2 * math.pi))
    assert robot.records[0].surprise == pytest.approx(-math.log(density))
