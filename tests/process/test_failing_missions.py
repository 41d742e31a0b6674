"""The claims of a mission where skills fail, and with what it goes on: docs/when-a-skill-fails.md."""

from collections.abc import Callable

import pytest
from models import built_text, engine_of_text
from scripted_missions import Clock, Surroundings, jammed, observed, run_mission, timed_out

from aos_protocol.messages import Activate, EndingOdds, Fault, Outcome
from aos_solver.building.build import BuiltModel
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.failures import FailureRules, SkillRule

LIMITS = MissionLimits(goal_probability=0.9, step_limit=40)

SHELF = """project: fetch
horizon: 8
discount: 0.95
define_type: Side
enum_members: Left, Right
state_variable: Side thing_at
code:
state.thing_at = Left;
state_variable: bool is_taken
code:
state.is_taken = false;
action_parameter: Side left_side
code:
state.left_side = Left;
action_parameter: Side right_side
code:
state.right_side = Right;
initial_belief:
state.thing_at = AOS.Bernoulli(0.5) ? Left : Right;
reward_code:
if (state.is_taken) { __reward = 20; __isGoalState = true; }
"""
LOOK = """project: fetch
dynamic_model:
bool seems_left = AOS.Bernoulli(0.85) == (state.thing_at == Left);
__moduleResponse = seems_left ? seen_left : seen_right;
__reward = -0.3;
"""
GOOD_LOOK = LOOK.replace("0.85", "0.98")
ASK = """project: fetch
dynamic_model:
bool says_left = AOS.Bernoulli(0.99) == (state.thing_at == Left);
__moduleResponse = says_left ? said_left : said_right;
__reward = -1.5;
"""
TAKE = """project: fetch
parameter: Side side
dynamic_model:
bool is_there = state.thing_at == side;
state__.is_taken = is_there && AOS.Bernoulli(0.9);
__moduleResponse = state__.is_taken ? taken : missed;
__reward = is_there ? -2 : -20;
"""


def fetch(**skills: str) -> dict[str, str]:
    """The tutorial's documents: the thing is on one of two sides."""
    return {"fetch.ef": SHELF, **{f"{name}.sd": text for name, text in skills.items()}}


@pytest.fixture
async def tutorial() -> BuiltModel:
    return await built_text(fetch(look=LOOK, take=TAKE))


def goals(around: Surroundings) -> list[float]:
    return [record.belief.goal_probability for record in around.records]


def sees_left_and(take: Callable[[Activate], Outcome]) -> Callable[[Activate], Outcome]:
    return lambda request: take(request) if request.skill == "take" else observed(request, "seen_left")


async def test_a_jammed_arm_never_reaches_the_goal(tutorial: BuiltModel):
    state, around = await run_mission(tutorial, sees_left_and(jammed), limits=LIMITS)
    assert (state.ending, max(goals(around))) == ("skills_failed", 0.0)
    assert "take is set aside for 300 s after 3 failures in a row, the last failed, AOS510" in state.remark
    assert [record.skill for record in around.decisions].count("take") == 3


@pytest.mark.parametrize("look", [jammed, lambda request: observed(request, "fine_weather")])
async def test_beside_a_camera_that_always_fails_or_says_words_of_no_document_the_robot_asks(look):
    built = await built_text(fetch(look=GOOD_LOOK, ask=ASK, take=TAKE))
    answers = {"ask": "said_right", "take": "taken"}

    def robot(request: Activate) -> Outcome:
        return look(request) if request.skill == "look" else observed(request, answers[request.skill])

    state, around = await run_mission(built, robot, limits=LIMITS)
    skills = [record.skill for record in around.decisions]
    assert state.ending == "goal"
    assert skills[:4] == ["look", "look", "look", "ask"]
    assert around.outcomes[2].remark.startswith("look is set aside for 300 s after 3 failures in a row")
    decision = around.decisions[3]
    assert decision.set_aside.keys() == {"look"}
    assert decision.set_aside["look"] in decision.why
    assert "look" not in {value.action for value in decision.actions}


async def test_a_skill_of_which_nobody_knows_ran_always_or_never(tutorial: BuiltModel):
    state, around = await run_mission(tutorial, sees_left_and(timed_out), limits=LIMITS)
    assert state.ending == "skills_failed"
    # Coins of their own would have it at 1 - 0.55**3 = 0.83 of what a look leaves.
    assert 0.3 < max(goals(around)) < 0.6
    assert all(
        record.belief.cautious is not None and record.belief.cautious.goal_probability == 0
        for record in around.outcomes
        if record.skill == "take"
    )


SURE_TAKE = """project: fetch
parameter: Side side
dynamic_model:
state__.is_taken = !state.is_taken && state.thing_at == side;
__moduleResponse = state__.is_taken ? taken : missed;
__reward = state__.is_taken ? -2 : -20;
"""


async def test_what_follows_from_the_remedy_of_nonsense_alone_is_not_claimed():
    built = await built_text(fetch(look=LOOK, ask=ASK, take=SURE_TAKE))

    def robot(request: Activate) -> Outcome:
        answers = {"look": "seen_left", "ask": "said_left", "take": "missed"}
        return observed(request, answers[request.skill])

    state, around = await run_mission(built, robot, limits=LIMITS)
    assert any(record.is_impossible for record in around.outcomes)
    assert state.ending == "skills_failed"


async def test_where_the_mission_would_be_over_it_is_decided_as_if_nothing_had_run(tutorial: BuiltModel):
    rules = FailureRules(skills={"take": SkillRule(ran_probability=0.99)})
    limits = MissionLimits(goal_probability=0.8, step_limit=40)
    state, around = await run_mission(tutorial, sees_left_and(timed_out), limits=limits, rules=rules)
    assert max(goals(around)) > 0.8
    assert state.ending == "skills_failed"
    cautious = [record for record in around.decisions if record.is_cautious]
    assert cautious
    for record in cautious:
        assert record.skill == "take"
        assert record.why.endswith("it is decided as if nothing had run that was not observed")


FEEL = """project: fetch
dynamic_model:
__moduleResponse = AOS.Bernoulli(0.95) == state.is_taken ? full : empty;
__reward = -0.5;
"""


async def test_observations_can_refute_that_nothing_ran():
    async with engine_of_text(fetch(take=TAKE, feel=FEEL)) as engine:
        ran = await engine.update_without_observation("take(side=left_side)", ran_probability=0.5)
        assert ran.summary.goal_probability == pytest.approx(0.5 * 0.5 * 0.9)
        assert ran.summary.cautious == EndingOdds(0.0, 0.0, 0.0)
        odds = 0.225 / 0.775
        for count in (1, 2, 3):
            summary = (await engine.update("feel", "full", refuted_below=0.01)).summary
            odds *= 19
            assert summary.goal_probability == pytest.approx(odds / (1 + odds))
            # P(full, full | nothing ran) is 0.0025, and 0.205 in the belief; a third makes it 1 in 1550.
            assert (summary.cautious is None) == (count == 3)


GRAB = """project: fetch
dynamic_model:
state__.is_taken = state.is_taken || AOS.Bernoulli(0.9);
__moduleResponse = state__.is_taken ? grabbed : missed;
__reward = -6;
"""


async def test_where_steps_only_cost_a_skill_that_leads_to_the_goal_is_still_taken():
    only_costs = fetch(look=LOOK.replace("-0.3", "-2"), take=TAKE.replace("-20", "-2"), grab=GRAB)
    only_costs["fetch.ef"] = SHELF.replace("__reward = 20", "__isFailureState = false")
    built = await built_text(only_costs)

    def robot(request: Activate) -> Outcome:
        answers = {"look": "seen_left", "grab": "grabbed"}
        return jammed(request) if request.skill == "take" else observed(request, answers[request.skill])

    state, around = await run_mission(built, robot, limits=LIMITS)
    skills = [record.skill for record in around.decisions]
    assert (state.ending, skills[-1]) == ("goal", "grab")
    assert skills.count("take") == 3


async def test_where_what_is_left_is_too_poor_the_skill_that_is_set_aside_is_the_reason():
    dear = fetch(look=LOOK, take=TAKE, grab=GRAB.replace("-6", "-30"))
    built = await built_text(dear)

    limits = MissionLimits(goal_probability=0.9, step_limit=40, stop_below_value=0.0)
    state, around = await run_mission(built, sees_left_and(jammed), limits=limits)
    assert state.ending == "skills_failed"
    assert "take is set aside" in state.remark
    assert "grab" not in [record.skill for record in around.decisions]


async def test_a_skill_comes_back_after_its_pause_and_goes_with_one_more_failure():
    built = await built_text(fetch(look=GOOD_LOOK, ask=ASK, take=TAKE))
    around = Surroundings(jammed)
    around.clock = clock = Clock()

    def robot(request: Activate) -> Outcome:
        clock.now_s += 10.0
        answers = {"ask": "said_right" if request.id.step % 2 else "said_left", "take": "missed"}
        return jammed(request) if request.skill == "look" else observed(request, answers[request.skill])

    around._robot = robot
    rules = FailureRules(set_aside_s=50.0)
    await run_mission(built, robot, limits=MissionLimits(step_limit=14), around=around, rules=rules)
    looks = [record.step for record in around.decisions if record.skill == "look"]
    # The third failure was at 30 s, and the one after the pause at 90 s.
    assert looks == [1, 2, 3, 9]


def told_failure(request: Activate, response: str) -> Outcome:
    fault = Fault("AOS510", "no picture")
    return Outcome(request.id, request.skill, "observed", response, fault=fault)


async def test_failures_that_a_rule_tells_count_by_how_improbable_they_are():
    look = """project: fetch
dynamic_model:
bool seems_left = AOS.Bernoulli(0.97) == (state.thing_at == Left);
bool works = AOS.Bernoulli(0.5);
__moduleResponse = works ? (seems_left ? seen_left : seen_right) : no_picture;
__reward = -0.1;
"""
    built = await built_text(fetch(ask=ASK, take=TAKE, look=look))

    def robot(request: Activate) -> Outcome:
        answers = {"ask": "said_right", "take": "taken"}
        if request.skill == "look":
            return told_failure(request, "no_picture")
        return observed(request, answers[request.skill])

    state, around = await run_mission(built, robot, limits=LIMITS)
    assert state.ending == "goal"
    assert [record.skill for record in around.decisions].count("look") == 10
