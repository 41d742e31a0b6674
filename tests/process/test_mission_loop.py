import asyncio

import pytest
from models import built_bundle, built_text
from places import BUNDLES
from processes import HANG_S
from scripted_missions import Clock, Robot, Surroundings, jammed, observed, run_mission, timed_out

from aos_protocol.messages import Activate, Fault, Outcome, Steer
from aos_solver.building.build import BuiltModel
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.failures import FailureRules, SkillRule

ANSWERS = {
    "navigate": "arrived",
    "pick": "pick_succeeded",
    "observe_holding": "holding",
    "observe_arm_outstretched": "not_outstretched",
    "serve": "delivered",
}


@pytest.fixture
async def finer() -> BuiltModel:
    return await built_bundle(BUNDLES / "armadillo-finer")


async def test_after_a_lost_activation_the_belief_is_that_it_ran_or_did_not(finer: BuiltModel):
    _, around = await run_mission(finer, timed_out, limits=MissionLimits(step_limit=1))
    decision, outcome = around.records
    assert decision.action == "navigate(destination=easy_table)"
    assert outcome.outcome is not None
    assert outcome.outcome.status == "timed_out"
    places = next(m.values for m in outcome.belief.marginals if m.variable == "robot_at")
    assert places["EasyTable"] == pytest.approx(0.5)
    assert not outcome.is_impossible
    assert [kind for kind, _ in around.journalled if kind in ("intended", "outcome")] == [
        "intended",
        "outcome",
    ]


async def test_a_robot_that_never_answers_ends_the_mission_with_what_to_look_at(finer: BuiltModel):
    state, _ = await run_mission(finer, timed_out)
    assert (state.phase, state.ending) == ("ended", "skills_failed")
    assert state.remark.startswith("nothing is left that is worth doing: ")
    assert (
        "navigate is set aside for 300 s after 3 failures in a row, the last timed_out, "
        "AOS503: the skill took longer than it may" in state.remark
    )


async def test_a_mission_goes_on_after_one_lost_activation(finer: BuiltModel):
    def robot(request: Activate) -> Outcome:
        return timed_out(request) if request.id.step == 1 else observed(request, ANSWERS[request.skill])

    state, around = await run_mission(finer, robot)
    assert state.ending == "goal"
    assert all(record.planner and record.why and record.threads == 1 for record in around.records)
    assert all(record.preparation_s >= 0 for record in around.records)
    assert all((record.update_s > 0) == (record.outcome is not None) for record in around.records)
    efforts = [record.update_effort for record in around.records if record.outcome]
    assert all("steps of the model" in effort for effort in efforts[1:])
    statuses = [record.outcome.status for record in around.records if record.outcome]
    assert statuses[0] == "timed_out"
    assert set(statuses[1:]) == {"observed"}


async def test_an_update_that_takes_longer_than_a_decision_tells_why(finer: BuiltModel):
    search = Search(simulations=1, seed=1, time_s=1e-9)
    _, around = await run_mission(finer, good, search=search, limits=MissionLimits(step_limit=1))
    over, _, counts = around.records[-1].remark.partition(", more than a decision's 1e-09 s: ")
    assert over.startswith("the update took ")
    assert counts.endswith(" steps of the model")


def good(request: Activate) -> Outcome:
    return observed(request, ANSWERS[request.skill])


def statuses(around: Surroundings) -> list[str]:
    return [record.outcome.status for record in around.records if record.outcome]


async def test_a_skill_that_fails_is_tried_again_as_often_as_the_deploy_file_says(finer: BuiltModel):
    def robot(request: Activate) -> Outcome:
        return jammed(request) if request.skill == "pick" and request.id.step < 4 else good(request)

    rules = FailureRules(skills={"pick": SkillRule(on_failure="retry", retries=2)})
    state, around = await run_mission(finer, robot, rules=rules)
    assert [decision.skill for decision in around.decisions[1:4]] == ["pick", "pick", "pick"]
    assert around.decisions[2].why == "it is tried again after a failure, 1 of 2"
    assert statuses(around)[1:4] == ["failed", "failed", "observed"]
    assert state.ending == "goal"


async def test_a_skill_that_may_not_fail_ends_the_mission_and_is_named(finer: BuiltModel):
    def robot(request: Activate) -> Outcome:
        return jammed(request) if request.skill == "pick" else good(request)

    state, _ = await run_mission(
        finer, robot, rules=FailureRules(skills={"pick": SkillRule(on_failure="end")})
    )
    assert state.ending == "skills_failed"
    assert state.remark.startswith(
        "the deploy file ends the mission when pick fails; pick: failed, AOS510: gr"
    )


async def test_a_mission_holds_until_somebody_lets_it_go_on(finer: BuiltModel):
    def robot(request: Activate) -> Outcome:
        return jammed(request) if request.id.step == 2 else good(request)

    around = Surroundings(robot)
    around.on_hold = lambda: around.mission.steer(Steer("resume", by="ana"))
    rules = FailureRules(skills={"pick": SkillRule(on_failure="hold")})
    state, _ = await run_mission(finer, robot, rules=rules, around=around)
    held, _ = [state for state in around.states if state.phase == "holding"]
    assert held.remark == "the mission holds: pick: failed, AOS510: gripper jammed"
    assert state.ending == "goal"


async def test_a_refused_activation_changes_nothing_in_the_belief(finer: BuiltModel):
    def robot(request: Activate) -> Outcome:
        fault = Fault("AOS505", "nobody is there")
        return Outcome(request.id, request.skill, "refused", fault=fault)

    _, around = await run_mission(finer, robot, limits=MissionLimits(step_limit=1))
    decision, outcome = around.records
    assert outcome.belief.marginals == decision.belief.marginals


async def test_what_nobody_can_run_is_not_decided_until_somebody_can(finer: BuiltModel):
    around = Surroundings(good)
    around.unavailable = {"navigate": LEFT}
    await run_mission(finer, good, limits=MissionLimits(step_limit=2), around=around)
    assert {record.skill for record in around.records} <= ANSWERS.keys() - {"navigate"}
    # All actions are valued all the same: the belief and the model have not changed.
    assert "navigate(destination=easy_table)" in {action.action for action in around.records[0].actions}
    why = "navigate(destination=easy_table) cannot be chosen now: its adapter has left"
    assert why in around.records[0].why

    def come_back():
        around.unavailable = {}

    around = Surroundings(good)
    around.unavailable = dict.fromkeys(ANSWERS, LEFT)
    around.on_hold = come_back
    state, _ = await run_mission(finer, good, around=around)
    assert [state.remark for state in around.states if state.phase == "holding"] == [
        "the mission holds, for no skill can be run: its adapter has left"
    ]
    assert state.ending == "goal"


LEFT = "its adapter has left"

FIELD = """project: field
horizon: 8
discount: 0.95

state_variable: bool is_north

state_variable: bool is_flooded

state_variable: bool is_watered

reward_code:
if (state.is_watered) {
    __reward = 3;
    __isGoalState = true;
}
"""

FIELD_SKILLS = {
    "drive": "state__.is_north = !state.is_north; __reward = -1;",
    "flood": "__reward = state.is_north && !state.is_flooded ? 20 : -5; state__.is_flooded = state.is_north;",
    "water": "__reward = state.is_north ? -5 : 0; state__.is_watered = !state.is_north;",
}


@pytest.fixture
async def field() -> BuiltModel:
    """A field that is first flooded in the north, and then watered in the south."""
    return await built_text(documents(FIELD, FIELD_SKILLS))


def documents(environment: str, skills: dict[str, str]) -> dict[str, str]:
    files = {"field.ef": environment}
    for skill, code in skills.items():
        files[f"{skill}.sd"] = f"project: field\n\ndynamic_model:\n{code}\n__moduleResponse = done;\n"
    return files


def done(request: Activate) -> Outcome:
    return observed(request, "done")


def without_flood(robot: Robot = done) -> Surroundings:
    around = Surroundings(robot)
    around.announced = dict.fromkeys(FIELD_SKILLS, 1)
    around.unavailable = {"flood": LEFT}
    return around


async def test_a_robot_waits_at_most_three_decisions_for_a_skill_that_nobody_can_run(field: BuiltModel):
    around = Surroundings(done)
    around.unavailable = {"flood": LEFT}
    state, _ = await run_mission(field, done, limits=MissionLimits(step_limit=20), around=around)
    assert [decision.skill for decision in around.decisions] == ["drive", *["water"] * 3, "drive", "water"]
    assert f"flood is left out after 3 decisions for want of it: {LEFT}" in around.decisions[-1].why
    assert state.ending == "goal"


async def test_an_adapter_that_has_just_left_is_waited_for_before_another_skill_is_chosen(field: BuiltModel):
    def robot(request: Activate) -> Outcome:
        if len(waits) == 0 and request.skill == "drive":
            around.unavailable = {"flood": LEFT}
        return done(request)

    def come_back():
        waits.append(len(around.decisions))
        if len(waits) == 3:
            around.unavailable = {}

    waits: list[int] = []
    around = without_flood(robot)
    around.unavailable = {}
    around.on_hold = come_back
    await run_mission(field, robot, limits=MissionLimits(step_limit=2), around=around)
    assert [record.skill for record in around.decisions] == ["drive", "flood"]
    assert waits == [1, 1, 1]
    # The search that found it worth waiting for is told, so that the decision can be replayed.
    assert [made.is_dropped for made in around.decisions[1].searches] == [True, False]


@pytest.mark.parametrize("changes_every_s", [0.125, 0.5])
async def test_an_adapter_that_stays_away_is_waited_for_once_and_not_planned_for_any_more(
    field: BuiltModel, changes_every_s
):
    def wait():
        waits.append(len(around.decisions))
        clock.now_s += changes_every_s  # Something else comes or goes, such as another adapter's skill.

    around = without_flood()
    around.clock = clock = Clock()
    around.on_hold = wait
    waits: list[int] = []
    state, _ = await run_mission(field, done, around=around)
    assert [record.skill for record in around.decisions] == ["drive", "drive", "water"]
    assert set(waits) == {1}
    assert clock.now_s == 5
    assert "flood is left out, as it was waited for" in around.decisions[1].why
    assert state.ending == "goal"


async def test_a_mission_that_ends_since_a_skill_has_left_names_it(field: BuiltModel):
    around = without_flood()
    state, _ = await run_mission(field, done, limits=MissionLimits(stop_below_value=1.9), around=around)
    assert state.ending == "nothing_worthwhile"
    assert "to return more than 1.9: flood is left out, as it was waited for" in state.remark


async def test_an_adapter_that_is_started_again_is_waited_for_as_long_as_that_takes(field: BuiltModel):
    def come_back():
        waits.append(len(around.decisions))
        if len(waits) == 25:
            around.unavailable = {}

    waits: list[int] = []
    around = without_flood()
    around.returning = ["flood"]
    around.on_hold = come_back
    await run_mission(field, done, limits=MissionLimits(step_limit=2), around=around)
    assert [record.skill for record in around.decisions] == ["drive", "flood"]
    assert waits == [1] * 25


async def test_an_adapter_that_is_expected_back_is_not_waited_for_for_ever(field: BuiltModel):
    def wait():
        clock.now_s += 30

    around = without_flood()
    around.clock = clock = Clock()
    around.returning = ["flood"]
    around.on_hold = wait
    state, _ = await run_mission(field, done, around=around)
    assert (state.ending, clock.now_s) == ("goal", 900.0)


async def test_a_mission_that_waits_for_an_adapter_is_stopped_at_once(field: BuiltModel, monkeypatch):
    async def until_changed(timeout_s: float):
        around.mission.steer(Steer("stop", by="ana"))
        await asyncio.Event().wait()  # Only a stop ends it.

    around = without_flood()
    monkeypatch.setattr(around, "until_changed", until_changed)
    async with asyncio.timeout(HANG_S):
        state, _ = await run_mission(field, done, around=around)
    assert state.ending == "cancelled"


async def test_a_skill_that_stays_away_and_is_worth_as_much_as_others_is_passed_over():
    skills = {"inspect": "__reward = 0;", "flood": "state__.is_watered = true;"}
    built = await built_text(documents(FIELD.replace("0.95", "1.0"), skills))
    around = without_flood()
    state, _ = await run_mission(built, done, around=around)
    assert [record.skill for record in around.decisions] == ["inspect"] * 3
    assert state.ending == "skills_failed"
    assert "flood is left out, as it was waited for" in state.remark


async def test_where_nothing_else_is_worth_doing_the_adapter_is_waited_for_and_no_step_is_spent(
    field: BuiltModel,
):
    def come_back():
        around.unavailable = {}

    around = Surroundings(done)
    around.unavailable = dict.fromkeys(("flood", "water"), LEFT)
    around.on_hold = come_back
    limits = MissionLimits(step_limit=20, stop_below_value=0.0)
    await run_mission(field, done, limits=limits, around=around)
    skills = [record.skill for record in around.decisions]
    # Each second one is for want of what is away; without it nothing is worth a step.
    assert skills[:8] == [*["drive"] * 7, "flood"]


async def test_a_mission_does_not_hold_for_ever(finer: BuiltModel):
    around = Surroundings(good)
    around.unavailable = dict.fromkeys(ANSWERS, LEFT)
    state, _ = await run_mission(finer, good, around=around, hold_s=0.01)
    assert state.ending == "fault"
    assert "AOS513" in state.remark
    assert LEFT in state.remark
