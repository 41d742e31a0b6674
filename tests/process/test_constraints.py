"""Chance constraints of a mission: the risks that the engine tells, and missions that keep within the bound.

The probabilities of the small models here are known by hand.
"""

from collections.abc import Mapping

import msgspec
import pytest
from models import built_project, engine_of, simulated
from places import BUNDLES
from projects import bundle_project, text_project
from test_mission_loop import Surroundings, observed

from aos_deploy.deployment.mission_values import constrained, constraint_of_option
from aos_deploy.exit_codes import ExitCode, exit_code_of_mission
from aos_lab.trials.intervals import interval_of_share
from aos_protocol.documents import Project
from aos_protocol.messages import Activate, Outcome
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import emitted_model
from aos_solver.child.engine import Engine, Planner
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.rules.endings import Ending
from aos_solver.mission.rules.terms import Terms
from aos_solver.mission.simulation import SimulatedRun

HOB = {
    "hob.ef": """project: test
horizon: 8
discount: 0.95

state_variable: bool is_hot

state_variable: bool is_done

initial_belief:
state.is_hot = AOS.Bernoulli(0.3);

reward_code:
if (state.is_done) {
    __reward = 10;
    __isGoalState = true;
}
""",
    "look.sd": """project: test

dynamic_model:
__moduleResponse = AOS.Bernoulli(0.85) == state.is_hot ? red : black;
__reward = -1;
""",
    "touch.sd": """project: test

dynamic_model:
state__.is_done = true;
__moduleResponse = touched;
""",
}
"""A hob is hot with probability 0.3, each look is right with 0.85, and touching a hot one costs nothing."""

AFTER_ONE_BLACK = 0.3 * 0.15 / (0.3 * 0.15 + 0.7 * 0.85)
AFTER_TWO = 0.3 * 0.15**2 / (0.3 * 0.15**2 + 0.7 * 0.85**2)
"""The probability that the hob is hot: 0.0703 and 0.0132."""

SAW = {
    "saw.ef": """project: test
horizon: 6
discount: 0.95

state_variable: bool is_hurt

state_variable: int cuts
code:
state.cuts = 0;
""",
    "cut.sd": """project: test

dynamic_model:
if (AOS.Bernoulli(0.004)) state__.is_hurt = true;
state__.cuts = state.cuts < 9 ? state.cuts + 1 : 9;
__moduleResponse = ended;
__reward = 1;
""",
    "rest.sd": "project: test\n\ndynamic_model:\n__moduleResponse = ended;\n",
}
"""Each cut hurts with probability 0.004, and nobody tells."""

GAUGE = {
    "gauge.ef": """project: test
horizon: 3
discount: 0.95

state_variable: double level

initial_belief:
state.level = AOS.SampleNormal(0, 1);
""",
    "drain.sd": """project: test

dynamic_model:
state__.level = state.level + AOS.SampleNormal(0, 1);
__moduleResponse = ended;
""",
}

TOUCHES_HOT = "touch && state.is_hot"
GETS_HURT = "!state.is_hurt && state__.is_hurt"


def with_constraints(project: Project, *constraints: str) -> Project:
    return constrained(project, [constraint_of_option(text) for text in constraints])


async def built(files: Mapping[str, str], *constraints: str) -> BuiltModel:
    project = with_constraints(text_project(files), *constraints)
    return await built_project(project)


async def risk_of(engine: Engine, action: str, constraint: int = 0) -> float:
    names = [action.name for action in engine.description.actions]
    return (await engine.risks(seed=1)).actions[names.index(action)][constraint]


async def play(
    model: BuiltModel, seeds: range, planner: Planner = "auto", steps: int = 30
) -> list[SimulatedRun]:
    async with engine_of(model) as engine:
        return [await simulated(engine, 500, seed=seed, planner=planner, step_limit=steps) for seed in seeds]


async def test_the_risk_of_an_action_is_its_probability_under_the_belief():
    model = await built(HOB, f"0.05: {TOUCHES_HOT}")
    async with engine_of(model) as engine:
        assert await risk_of(engine, "touch") == pytest.approx(0.3)
        assert await risk_of(engine, "look") == 0
        await engine.update("look", "black")
        assert await risk_of(engine, "touch") == pytest.approx(AFTER_ONE_BLACK)
        await engine.update("look", "black")
        assert await risk_of(engine, "touch") == pytest.approx(AFTER_TWO)
        assert not (await engine.risks(seed=1)).is_sampled


async def test_what_a_step_leads_to_is_enumerated():
    model = await built(SAW, f"0.01: {GETS_HURT}", "0.5: state__.cuts > 1 && cut")
    async with engine_of(model) as engine:
        assert await risk_of(engine, "cut") == pytest.approx(0.004)
        assert (await risk_of(engine, "rest"), await risk_of(engine, "cut", 1)) == (0, 0)
        await engine.update("cut", "ended")
        assert await risk_of(engine, "cut") == pytest.approx(0.996 * 0.004)
        assert await risk_of(engine, "cut", 1) == pytest.approx(1)


async def test_a_risk_that_cannot_be_enumerated_is_an_estimate_and_says_so():
    model = await built(GAUGE, "0.9: drain && state__.level > 0")
    async with engine_of(model) as engine:
        assert (await engine.risks(seed=1)).is_sampled
        assert await risk_of(engine, "drain") == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("planner", ["auto", "pomcp", "despot", "sarsop"])
async def test_whichever_planner_decides_it_looks_until_the_risk_is_allowed(planner: Planner):
    for run in await play(await built(HOB, f"0.05: {TOUCHES_HOT}"), range(1, 11), planner):
        blacks = run.observations.count("black") - run.observations.count("red")
        assert (run.actions[-1] == "touch") == (blacks == 2)
        assert run.risked[TOUCHES_HOT] == pytest.approx(AFTER_TWO if blacks == 2 else 0)
    for run in await play(await built(HOB), range(1, 4), planner):
        assert run.actions == ("touch",)


async def test_missions_violate_a_constraint_less_often_than_it_allows():
    runs = await play(await built(HOB, f"0.05: {TOUCHES_HOT}"), range(1, 301))
    violations = sum(run.violated == (TOUCHES_HOT,) for run in runs)
    assert interval_of_share(violations, len(runs)).high < 0.05
    # Every touch risks the same, which is known by hand.
    touches = sum("touch" in run.actions for run in runs)
    share = interval_of_share(violations, touches)
    assert share.low < AFTER_TWO < share.high
    free = await play(await built(HOB, f"0.999: {TOUCHES_HOT}"), range(1, 101))
    touched_hot = interval_of_share(sum(bool(run.violated) for run in free), len(free))
    assert 0.05 < touched_hot.low < 0.3 < touched_hot.high


async def test_what_many_steps_risk_adds_up():
    model = await built(SAW, f"0.01: {GETS_HURT}")
    for run in await play(model, range(1, 6), steps=8):
        assert run.actions.count("cut") == 2
        assert run.risked[GETS_HURT] == pytest.approx(0.004 + 0.996 * 0.004)


async def test_an_event_may_be_forbidden_altogether():
    for run in await play(await built(SAW, f"0: {GETS_HURT}"), range(1, 3), steps=4):
        assert run.actions == ("rest",) * 4


async def test_a_mission_ends_where_every_action_is_too_risky():
    (run,) = await play(await built(GAUGE, "0.1: drain && state__.level > 0"), range(1, 2))
    assert (run.ending, run.actions) == (Ending.TOO_RISKY, ())


async def test_a_cost_is_what_searches_count_for_a_violation():
    project = with_constraints(text_project(HOB), f"0.9: {TOUCHES_HOT}")
    costly = msgspec.structs.replace(project.constraints[0], cost=100.0)
    costly_project = msgspec.structs.replace(project, constraints=(costly,))
    free, costs = [await built_project(documents) for documents in (project, costly_project)]
    values = []
    for model in (free, costs):
        async with engine_of(model) as engine:
            values.append({action.action: action.q for action in (await engine.exact_values(1)).actions})
    assert values[0]["touch"] == pytest.approx(10)
    assert values[1]["touch"] == pytest.approx(10 - 0.3 * 100)


def test_constraints_without_a_cost_leave_the_model_what_it_is():
    project = bundle_project(BUNDLES / "armadillo-finer")
    bounded = with_constraints(project, "0.01: serve && state.arm_outstretched")
    assert emitted_model(bounded).digest == emitted_model(project).digest
    assert emitted_model(bounded).cpp != emitted_model(project).cpp


async def test_a_decision_record_tells_what_every_action_risks():
    looks = iter(["black", "black"])

    def robot(request: Activate) -> Outcome:
        return observed(request, "touched" if request.skill == "touch" else next(looks))

    model = await built(HOB, f"0.05: {TOUCHES_HOT}")
    around = Surroundings(robot)
    terms = Terms(name="m", search=Search(simulations=500, seed=1))
    async with engine_of(model) as engine:
        state = await Mission(terms, RunningModel(1, engine), around).run()
    assert state.ending == "goal"
    constraints = [record.constraints[0] for record in around.records[::2]]
    assert [record.action for record in around.records[::2]] == ["look", "look", "touch"]
    assert [constraint.risk for constraint in constraints] == pytest.approx([0, 0, AFTER_TWO])
    assert [constraint.risks for constraint in constraints] == [
        pytest.approx((0, p)) for p in (0.3, AFTER_ONE_BLACK, AFTER_TWO)
    ]
    assert {(constraint.never, constraint.probability, constraint.left) for constraint in constraints} == {
        (TOUCHES_HOT, 0.05, 0.05)
    }


async def test_a_mission_that_may_do_nothing_any_more_says_what_is_left():
    files = {name: text for name, text in HOB.items() if not name.startswith("look")}
    model = await built(files, f"0.05: {TOUCHES_HOT}")
    around = Surroundings(lambda request: observed(request, "touched"))
    terms = Terms(name="m", search=Search(simulations=500, seed=1))
    async with engine_of(model) as engine:
        state = await Mission(terms, RunningModel(1, engine), around).run()
    assert (state.ending, exit_code_of_mission(state)) == ("too_risky", ExitCode.TOO_RISKY)
    numbers = "0.05 is left of 0.05, and the least risk is 0.3"
    assert state.remark == f"every action risks more than is allowed (never {TOUCHES_HOT}: {numbers})"
    assert not any(kind == "intended" for kind, _ in around.journalled)
