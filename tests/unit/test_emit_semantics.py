import pytest
from projects import text_project
from scripted_models import ScriptedModel, json_text, scripted

SWITCH = {
    "home.ef": """project: test
horizon: 7
discount: 0.95
state_variable: int seen
code:
state.seen = 10;
state_variable: int shown
code:
state.shown = 0;
state_variable: int level
code:
state.level = 1;
state_variable: int limit
code:
state.limit = 5;
initial_belief:
state.level = AOS.Bernoulli(0.5) ? 1 : 3;
extrinsic_code:
state_.seen = state.level * 10;
__reward = 0.5;
if (raise != NULL && raise->by == 2) __reward += 100;
reward_code:
if (state.level > 3) {
    __reward = 7;
    __stopEvaluatingState = true;
}
reward_code:
if (state.level >= state.limit) {
    __reward = 30;
    __isGoalState = true;
}
reward_code:
if (state.level < 0) __isGoalState = true;
heuristic_code:
__heuristicValue = state.level * 2 - 0.5;
""",
    "raise.sd": """project: test
parameter: int by
available_parameters_code:
for (int by = -2; by < 3; by++) if (by != 0) __possibleParameters.push_back(std::make_tuple(by));
precondition:
__meetPrecondition = state.level + by > 0;
violate_penalty: -4
rollout_policy:
__heuristicValue = by * 1.5;
dynamic_model:
state__.level = state.level + by;
state__.shown = state.level + 1000 * state_.seen + 100000 * (state__.seen == state_.seen);
__reward = __meetPrecondition ? -1 : -2;
__moduleResponse = AOS.Bernoulli(0.9) ? raised : stuck;
""",
    "wait.sd": "project: test\ndynamic_model:\n",
}


@pytest.fixture(scope="module")
def switch() -> ScriptedModel:
    return scripted(text_project(SWITCH))


def test_actions_are_grounded_by_the_skills_own_code(switch: ScriptedModel):
    assert switch.describe() == {
        "raise(by=-2)": {"by": -2},
        "raise(by=-1)": {"by": -1},
        "raise(by=1)": {"by": 1},
        "raise(by=2)": {"by": 2},
        "wait": {},
    }


def test_the_initial_belief_draws_after_the_defaults(switch: ScriptedModel):
    assert switch.play(initial="1").values("level") == ["1"]
    assert switch.play(initial="0").values("level") == ["3"]


def test_the_three_states_are_true_copies(switch: ScriptedModel):
    played = switch.play("raise(by=1)", initial="1")
    # `state.level` is still 1 after `state__.level` became 2; the extrinsic changes made `seen` 10.
    assert played.values("shown") == ["0", str(1 + 1000 * 10 + 100000)]
    assert played.values("level") == ["1", "2"]


def test_a_violated_precondition_costs_its_penalty_and_the_skill_still_runs(switch: ScriptedModel):
    played = switch.play("raise(by=-1)", initial="1")
    assert played.steps[0]["meets_precondition"] is False
    assert played.values("level") == ["1", "0"]
    assert played.rewards == [-4 - 2 + 0.5]


def test_rewards_of_all_phases_add_up(switch: ScriptedModel):
    # extrinsic 0.5 and 100 for the action it watches, the skill -1, both special states 7 and 30
    assert switch.play("raise(by=2)", initial="0").rewards == [0.5 + 100 - 1 + 7 + 30]


def test_a_special_state_that_stops_counts_once(switch: ScriptedModel):
    played = switch.play("raise(by=1)", "wait", initial="0")
    assert played.rewards == [0.5 - 1 + 7, 0.5]


def test_endings_absorb(switch: ScriptedModel):
    reached = switch.play("raise(by=2)", "raise(by=1)|0", initial="0")
    assert [step["ending"] for step in reached.steps] == [1, 1]
    assert reached.rewards[1] == 0
    assert reached.values("level") == ["3", "5", "5"]
    assert reached.observations == ["raised", "stuck"]
    assert switch.play("raise(by=-2)", initial="1").steps[0]["ending"] == 3


def test_without_a_response_the_observation_is_the_default(switch: ScriptedModel):
    assert switch.play("wait", "raise(by=1)|0").observations == ["DefaultObservation", "stuck"]


def test_rollout_weights_are_never_negative(switch: ScriptedModel):
    played = switch.play("raise(by=2)", "raise(by=-1)", "wait")
    assert [step["rollout_weight"] for step in played.steps] == [3.0, 0, 0]


def test_a_state_heuristic_values_a_state(switch: ScriptedModel):
    played = switch.play("raise(by=1)", "wait", initial="0")
    assert [step["state_value"] for step in played.steps] == [5.5, 7.5]


def test_only_what_code_changes_is_in_the_particle(switch: ScriptedModel):
    assert set(switch.play().initial["state"]) == {"seen", "shown", "level"}
    assert "inline static const int& limit = constants.limit;" in switch.emitted.cpp


def test_a_saved_state_is_read_back_equal(switch: ScriptedModel):
    played = switch.play("raise(by=1)", "raise(by=2)", "wait")
    assert all(step["is_saved"] for step in played.steps)


ENDED_AT_THE_START = {
    "home.json": json_text(
        {
            "EnvironmentGeneral": {"Horizon": 3, "Discount": 0.9, "OneStateModel": True},
            "GlobalVariableTypes": [],
            "GlobalVariablesDeclaration": [
                {"Name": "n", "Type": "int", "Default": "2"},
                {"Name": "copy", "Type": "int"},
            ],
            "InitialBeliefStateAssignments": [],
            "SpecialStates": [
                {"StateConditionCode": "state.n == 2", "Reward": 5.0, "IsOneTimeReward": True},
                {"StateConditionCode": "state.n == 4", "Reward": -10.0, "IsGoalState": True},
            ],
            "ExtrinsicChangesDynamicModel": [{"AssignmentCode": "state_.n += 1;"}],
        },
        "Environment",
        "environment",
    ),
    "step.json": json_text(
        {
            "Preconditions": {"ViolatingPreconditionPenalty": -1.5, "GlobalVariablePreconditionAssignments": [
                {"AssignmentCode": "__meetPrecondition = state.n > 2"}
            ]},
            "ModuleExecutionTimeDynamicModel": [{"AssignmentCode": "__moduleExecutionTime = state.n * 7;"}],
            "DynamicModel": {"NextStateAssignments": [
                {"AssignmentCode": "if (state.n > 9) return;"},
                {"AssignmentCode": "// Apart.\nelse state__.copy = state.n * 100 + __moduleExecutionTime;"}
            ]},
        },
        "PLP",
        "step",
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def one_state() -> ScriptedModel:
    return scripted(text_project(ENDED_AT_THE_START))


def test_a_one_time_reward_that_holds_at_the_start_is_used_up(one_state: ScriptedModel):
    assert one_state.play("step").rewards == [-1.5]


def test_in_a_one_state_model_all_names_are_one_object(one_state: ScriptedModel):
    # The extrinsic change is seen through `state`; the execution time was taken before it.
    assert one_state.play("step").values("copy") == ["0", str(3 * 100 + 2 * 7)]


def test_an_ending_with_a_negative_reward_is_a_failure(one_state: ScriptedModel):
    played = one_state.play("step", "step")
    assert [step["ending"] for step in played.steps] == [0, 2]
    assert played.rewards == [-1.5, -10]
