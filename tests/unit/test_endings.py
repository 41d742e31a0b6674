import msgspec
import pytest
from dialects import say_the_same
from projects import text_project
from scripted_models import ScriptedModel, scripted
from texts import encoded

from aos_language.load import load_files
from aos_protocol.messages import ActionValue, BeliefSummary, EndingOdds
from aos_solver.mission.rules.endings import (
    Ending,
    MissionLimits,
    believed_ending,
    ending_after_planning,
    is_held_back,
    remark_of,
)

RUNNING, GOAL, FAILURE, OVER = range(4)

ROOM = """project: test
horizon: 3
discount: 0.9
state_variable: int n
code:
state.n = 0;
reward_code:
if (state.n == 1) { __reward = 0; __isGoalState = true; __isFailureState = false; }
reward_code:
if (state.n == 2) { __reward = 5; __isFailureState = true; }
reward_code:
if (state.n == 3) { __reward = -5; __isGoalState = true; }
reward_code:
if (state.n == 4) __isGoalState = true;
reward_code:
if (state.n == 5) { __reward = 2; __isGoalState = true; }
special_state:
state_condition: state.n == 6
reward: -2
is_goal_state: true
is_failure_state: false
special_state:
state_condition: state.n == 7
reward: 3
is_failure_state: true
special_state:
state_condition: state.n == 8
reward: 0
is_goal_state: true
special_state:
state_condition: state.n == 9
reward: -1
is_goal_state: true
special_state:
state_condition: state.n == 10
reward: 0
is_goal_state: true
is_failure_state: true
"""
GO = """project: test
parameter: int to
available_parameters_code:
for (int to = 0; to < 12; to++) __possibleParameters.push_back(std::make_tuple(to));
dynamic_model:
state__.n = to;
"""
BUNDLE = {"room.ef": ROOM, "go.sd": GO}


@pytest.fixture(scope="module")
def room() -> ScriptedModel:
    return scripted(text_project(BUNDLE))


def ending_at(room: ScriptedModel, place: int) -> int:
    ending = room.play(f"go(to={place})").steps[0]["ending"]
    assert isinstance(ending, int)
    return ending


@pytest.mark.parametrize(
    ("place", "ending"), [(1, GOAL), (2, FAILURE), (6, GOAL), (7, FAILURE), (10, FAILURE)]
)
def test_what_is_said_of_failure_counts_whatever_the_reward(room: ScriptedModel, place, ending):
    assert ending_at(room, place) == ending


@pytest.mark.parametrize(("place", "ending"), [(3, FAILURE), (4, OVER), (5, GOAL), (8, OVER), (9, FAILURE)])
def test_where_nothing_is_said_of_failure_the_rewards_sign_says_it(room: ScriptedModel, place, ending):
    assert ending_at(room, place) == ending


def test_other_states_go_on(room: ScriptedModel):
    assert [ending_at(room, place) for place in (0, 11)] == [RUNNING, RUNNING]


def test_endings_that_their_reward_decides_are_told(room: ScriptedModel):
    found = load_files(encoded(BUNDLE)).diagnostics
    messages = {finding.span.line: finding.message for finding in found if finding.code == "AOS137"}
    lines = ROOM.splitlines()
    assert [lines[line] for line in sorted(messages)] == [
        "if (state.n == 3) { __reward = -5; __isGoalState = true; }",
        "if (state.n == 4) __isGoalState = true;",
        "state_condition: state.n == 8",
        "state_condition: state.n == 9",
    ]
    assert "failure" in messages[11]
    assert "neither" in messages[13]


def test_both_dialects_say_the_same_of_failure():
    as_json, _ = say_the_same(encoded(BUNDLE))
    assert as_json["environment.ef.json"].count(b'"IsFailureState": false') == 1
    assert as_json["environment.ef.json"].count(b'"IsFailureState": true') == 2


def belief(goal: float, over: float, failure: float) -> BeliefSummary:
    return BeliefSummary((), 0.0, goal, failure, 3, True, over_probability=over)


@pytest.mark.parametrize(
    ("goal", "over", "failure", "ending"),
    [
        (0.95, 0.0, 0.05, Ending.GOAL),
        (0.5, 0.45, 0.05, Ending.OVER),
        (0.0, 0.95, 0.0, Ending.OVER),
        (0.5, 0.0, 0.45, Ending.FAILURE),
        (0.0, 0.5, 0.45, Ending.FAILURE),
        (0.4, 0.2, 0.2, None),
        (0.899, 0.0, 0.001, None),
        (0.86, 0.05, 0.0, None),
        (0.5, 0.35, 0.06, None),
    ],
)
def test_a_mission_that_is_surely_over_counts_as_what_it_is_at_least(goal, over, failure, ending):
    assert believed_ending(belief(goal, over, failure), MissionLimits(goal_probability=0.9)) is ending


def test_a_mission_that_cannot_go_on_ends_whatever_the_rounding():
    odds = [(goal / 100, over / 100) for goal in range(101) for over in range(101 - goal)]
    beliefs = [belief(goal, over, 1 - goal - over) for goal, over in odds]
    assert all(believed_ending(each, MissionLimits(goal_probability=0.9)) for each in beliefs)


@pytest.mark.parametrize(
    ("cautious", "ending", "is_kept"),
    [
        ((0.95, 0.0, 0.0), Ending.GOAL, False),
        ((0.85, 0.0, 0.0), None, True),
        ((0.0, 0.0, 0.95), Ending.FAILURE, False),
        ((0.5, 0.45, 0.0), Ending.OVER, False),
    ],
)
def test_an_ending_is_no_better_than_where_nothing_ran_that_was_not_observed(cautious, ending, is_kept):
    goal, over, failure = cautious
    state = msgspec.structs.replace(belief(0.95, 0.0, 0.0), cautious=EndingOdds(goal, failure, over))
    limits = MissionLimits(goal_probability=0.9)
    assert believed_ending(state, limits) is ending
    assert is_held_back(state, limits) is is_kept


@pytest.mark.parametrize(
    ("goal", "over", "failure", "said"),
    [
        (0.05, 0.0, 0.95, "the mission is over without its goal"),
        (0.78, 0.0, 0.17, "the mission is over, nobody can tell how, and it counts as failure: goal 0.780"),
        (0.0, 0.95, 0.0, "the mission is over without its goal or a failure"),
        (0.5, 0.45, 0.05, "the mission is over, nobody can tell how, and it counts as over: "),
    ],
)
def test_a_mission_whose_end_is_not_known_is_not_said_to_be_without_its_goal(goal, over, failure, said):
    limits, state = MissionLimits(goal_probability=0.9), belief(goal, over, failure)
    ending = believed_ending(state, limits)
    assert ending is not None
    assert remark_of(ending, state, limits).startswith(said)


GIVES_UP, GOES_ON = Ending.NOTHING_WORTHWHILE, None


@pytest.mark.parametrize(
    ("value", "error", "at_most", "ending"),
    [
        (-12.9, 0.0, 19.7, GOES_ON),  # what is known is bad, and nobody knows the rest
        (-12.9, 9.0, None, GOES_ON),  # the error has the benefit of the doubt
        (-12.9, 1.0, None, GIVES_UP),
        (-12.9, 1.0, -10.0, GIVES_UP),
        (-0.1, 9.0, -0.05, GIVES_UP),  # the error is large, but what is proven is not
        (1.0, 0.0, 1.0, GOES_ON),
    ],
)
def test_a_mission_gives_up_where_the_estimate_is_bad_and_nothing_promises_more(
    value, error, at_most, ending
):
    best = ActionValue("look", value, 10, error, at_most=at_most)
    assert ending_after_planning(best, (best,), MissionLimits(stop_below_value=0.0)) is ending


def test_a_mission_does_not_give_up_while_another_action_may_return_enough():
    best, other = (
        ActionValue("look", -2.0, 10, 0.0, at_most=-1.0),
        ActionValue("ask", -9.0, 1, 0.0, at_most=30.0),
    )
    barred = ActionValue("ask", -9.0, 1, 0.0)
    limits = MissionLimits(stop_below_value=0.0)
    assert ending_after_planning(best, (best, other), limits) is GOES_ON
    assert ending_after_planning(best, (best, barred), limits) is GIVES_UP
    assert ending_after_planning(best, (best, other), MissionLimits()) is GOES_ON
