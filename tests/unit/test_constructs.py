"""Each construct of the languages used wrongly: refused, or warned of, where the mistake is."""

from itertools import chain

import pytest
from places import ROOT
from test_reading_rules import Rule, bundle_of

from aos_language.load import load_files
from aos_solver.emission.lowering.lower import lower

MISUSES = {
    "v1.x JSON": Rule("go.json", '"§«PlpMain→PlpMian»"', "AOS102"),
    "paper GSDL JSON": Rule(
        "go.json",
        '"«PlpMain→GsdlMain»": {"Project": "two rooms", "Name": "go", "Type": "§«PLP→GDSL»"',
        "AOS106",
    ),
    "SDL 2.0": Rule("room.ef", "§«horizon→horizont»: 5", "AOS102"),
    "enum": Rule(
        "room.json", '{"TypeName": "§tRoom", "Type": "enum", "EnumValues": [«"eHall", "eLab"→»]}', "AOS105"
    ),
    "compound type": Rule("room.json", '"Name": "room", "Type": "§«tRoom→tRom»"', "AOS110"),
    "mission parameter": Rule(
        "room.ef",
        "horizon: 5«→\nmission_parameter: int count\nextrinsic_code:\n§state_.count = 2;»",
        "AOS128",
    ),
    "array": Rule("room.ef", "int steps §[«→2»]", "AOS104"),
    "array over an enum": Rule("room.ef", "int steps [§«→tRom»]", "AOS110"),
    "vector<...>": Rule("room.ef", "§«int steps []→vector<Roof> steps»", "AOS110"),
    "map variable": Rule("room.json", '"«IsArray": true→Parameters": ["§(0,3)"]»,', "AOS106"),
    "anyValue": Rule(
        "room.json",
        '{"Name": "pose", "Type": "anyValue", "UnderlineLocalVariableType": "§«Pose→Pos»"}',
        "AOS110",
    ),
    "EnvironmentGlue constant": Rule(
        "low.json", '"Constants": [«→{"Name": "___p", "Type": "Pose", "InitCode": "___p.x = §(1"}»]', "AOS121"
    ),
    "temporary variable": Rule(
        "go.json", '{"«IterateNextStateVars": []→TempVar": {"VarName": "§n", "Type": "it"}»}', "AOS110"
    ),
    "temporary enum": Rule(
        "go.json",
        '§{"VarName": "end", "Type": "enum", "EnumName": "tEnd", "EnumValues": [«"eWell", "eBadly"→»]}',
        "AOS105",
    ),
    "IteratePreviousStateVars": Rule(
        "go.json",
        '{"«IterateNextStateVars": [→IteratePreviousStateVars": [{"Type": "§tDor", "ItemName": "d"}»]}',
        "AOS110",
    ),
    "IterateNextStateVars": Rule(
        "room.json",
        '"«AssignmentName": "start"→IterateNextStateVars": [{"Type": "§tDoor", "ItemName": "d"}]»,',
        "AOS123",
    ),
    "xObjects": Rule("go.json", "if («end == eWell→state.§tDorObjects.empty()»)", "AOS110"),
    "xObjectsForActions": Rule(
        "go.json", "if («end == eWell→state.§tDorObjectsForActions.empty()»)", "AOS110"
    ),
    "declared action values": Rule("go.sd", "parameter: «Door→float» §door", "AOS119"),
    "__possibleParameters": Rule(
        "go.sd", "«→available_parameters_code:\n§__posibleParameters.push_back({});\n»precondition:", "AOS110"
    ),
    "precondition": Rule("go.json", "!§«state→state__».closed", "AOS123"),
    "penalty": Rule("go.json", '§«-2→"-2"»\n', "AOS106"),
    "rollout policy": Rule("go.sd", "«→rollout_policy:\n§state.at = Hall;\n»violate_penalty", "AOS123"),
    "state heuristic": Rule("room.ef", "«→heuristic_code:\n§state.at = Lab;\n»initial_belief:", "AOS123"),
    "module execution time": Rule(
        "go.json",
        '"«→ModuleExecutionTimeDynamicModel": [{"AssignmentCode": "§state.at = eLab;"}], "»DynamicModel"',
        "AOS123",
    ),
    "special state, condition": Rule("room.json", "§«state→state_».at == eLab", "AOS123"),
    "special state, code": Rule("room.ef", "if (§«state→state__».at == Lab)", "AOS123"),
    "one-time reward": Rule("room.json", '"IsGoalState": true«→, "IsOneTimeReward": §3»', "AOS106"),
    "goal": Rule("room.ef", "§«__isGoalState→__isGoal»", "AOS110"),
    "failure": Rule("room.ef", "§«__isGoalState→__isFailState»", "AOS110"),
    "extrinsic changes": Rule(
        "room.json",
        '"ExtrinsicChangesDynamicModel": [«→{"AssignmentCode": "§state__.at = eLab;"}»]',
        "AOS123",
    ),
    "chosen action": Rule(
        "room.json",
        '"ExtrinsicChangesDynamicModel": [«→{"AssignmentCode": "if (go->§oDor.room) return;"}»]',
        "AOS110",
    ),
    "string observation": Rule(
        "go glue.json", '{"«→FromStringLocalVariable": "§txt", "»ResponseRules"', "AOS110"
    ),
    "__observed": Rule("go.sd", "«__reward = -1→__observed.steps = §1 + AOS.SampleNormal(0, 1)»;", "AOS138"),
    "state given observation": Rule(
        "go.json",
        '"«→StateGivenObservationModel": '
        '{"Assignments": [{"AssignmentCode": "§state__.at = eLab;"}]}, "»DynamicModel"',
        "AOS123",
    ),
    "OneStateModel": Rule("room.ef", "horizon: 5«→\none_state_model: §perhaps»", "AOS106"),
    "print function": Rule(
        "room.json",
        '"ExtrinsicChangesDynamicModel": []«→, "PrintStateFunc": [{"AssignmentCode": "§state.at = eLab;"}]»',
        "AOS123",
    ),
    "AOS.Bernoulli": Rule("room.json", "AOS.Bernoulli(§«0.5→1.5»)", "AOS122"),
    "AOS.SampleDiscrete": Rule("go.json", "§{0.9, «→-»0.1}", "AOS122"),
    "AOS.SampleNormal": Rule("room.json", "AOS.«Bernoulli(0.5)→SampleNormal(0, §-1) > 0»", "AOS122"),
    "AOS.SampleUniform": Rule("room.json", "AOS.«Bernoulli(0.5)→SampleUniform(2, §1) > 1.5»", "AOS122"),
    "AOSUtils": Rule("room.ef", "«AOS.Bernoulli→AOSUtils::§Bernouli»(0.5)", "AOS110"),
    "AOS.SetNull and its like": Rule(
        "go.json", "«→AOS.§SetNul(state__.door.pose); »if (end == eWell)", "AOS110"
    ),
    "response rules": Rule("go.json", "? eDone : §«eLost→eGone»", "AOS116"),
    "shared code": Rule("room.ef", "horizon: 5«→\nshared_code:\nint §count = 3;»", "AOS145"),
    "shared code of mappings": Rule(
        "room.ef", "horizon: 5«→\nshared_mapping_code:\ndef far(x) §return x»", "AOS121"
    ),
    "stop_when": Rule("go glue.json", '"«GlueFramework": "ROS→StopWhen": "§ok»",', "AOS110"),
    "monitor": Rule("go glue.json", '"«→Monitor": "§battery", "»GlueFramework": "ROS",', "AOS114"),
    "no mapping": Rule("go glue.json", '"Name": "§«go→goo»"', "AOS114"),
    "local variables": Rule("go glue.json", '"§oDoor.«pose→where»"', "AOS110"),
}

WARNED_OF = {"AOS.SampleUniform", "anyValue"}
"""All other misuses are errors."""

AT_WORK = {
    "test_documents_constructs": {
        "every_construct_of_a_json_environment_is_read": ["v1.x JSON"],
        "every_construct_of_a_json_skill_is_read_under_the_papers_names": ["paper GSDL JSON"],
    },
    "test_odd_code": {"code_of_many_kinds_does_what_it_says": ["SDL 2.0"]},
    "test_emit_language": {
        "values_have_their_declared_defaults": ["enum", "compound type"],
        "containers_take_what_documents_do_with_the_standard_ones": [
            "array",
            "vector<...>",
            "map variable",
            "string observation",
        ],
        "a_value_without_meaning_here_can_be_set_and_asked_for": ["anyValue", "AOS.SetNull and its like"],
        "return_ends_the_dynamic_model_early": ["temporary variable"],
        "the_name_of_a_temporary_enum_stands_before_its_first_value": ["temporary enum"],
        "an_initial_belief_may_draw_an_enum_and_change_what_it_iterates_over": ["IteratePreviousStateVars"],
        "loops_run_over_declared_variables_in_order_and_change_only_what_they_may": ["IterateNextStateVars"],
        "lists_of_objects_read_like_vectors_of_pointers": ["xObjects", "xObjectsForActions"],
        "groundings_are_ordered_by_variable_name_and_the_first_parameter_is_outermost": [
            "declared action values"
        ],
        "draws_over_declared_local_and_numbered_enums_and_over_lists": [
            "AOS.SampleDiscrete",
            "AOS.SampleNormal",
            "AOS.SampleUniform",
            "AOSUtils",
        ],
    },
    "process/test_mission_parameters": {
        "one_compiled_model_has_the_exact_values_of_each_value": ["mission parameter"]
    },
    "test_arrays_over_enums": {
        "values_and_numbers_index_them_and_they_read_like_arrays": ["array over an enum"]
    },
    "test_low_level_values": {
        "they_begin_as_the_constants_that_types_and_variables_have_by_default": ["EnvironmentGlue constant"]
    },
    "test_emit_semantics": {
        "actions_are_grounded_by_the_skills_own_code": ["__possibleParameters"],
        "a_violated_precondition_costs_its_penalty_and_the_skill_still_runs": ["precondition", "penalty"],
        "rollout_weights_are_never_negative": ["rollout policy"],
        "a_state_heuristic_values_a_state": ["state heuristic"],
        "in_a_one_state_model_all_names_are_one_object": ["module execution time", "OneStateModel"],
        "a_one_time_reward_that_holds_at_the_start_is_used_up": [
            "special state, condition",
            "one-time reward",
        ],
        "a_special_state_that_stops_counts_once": ["special state, code"],
        "endings_absorb": ["goal"],
        "the_three_states_are_true_copies": ["extrinsic changes"],
        "the_initial_belief_draws_after_the_defaults": ["AOS.Bernoulli"],
    },
    "test_shared_code": {"all_code_sees_the_constants_and_calls_the_functions": ["shared code"]},
    "test_shared_mapping_code": {
        "all_mappings_call_the_functions_and_know_the_constants": ["shared code of mappings"]
    },
    "test_endings": {"what_is_said_of_failure_counts_whatever_the_reward": ["failure"]},
    "test_chosen_action": {"only_the_chosen_skill_is_seen": ["chosen action"]},
    "process/test_observed_numbers": {"several_numbers_and_a_response_count_together": ["__observed"]},
    "process/test_state_given_observation": {
        "code_corrects_every_state_with_the_local_variables": ["state given observation"],
        "a_simulated_state_is_shown_by_the_documents_print_function": ["print function"],
    },
    "test_mapping_semantics": {
        "the_first_rule_that_holds_wins_also_with_an_or_in_a_later_one": ["response rules"],
        "the_result_of_the_call_gives_service_variables": ["local variables"],
    },
    "test_stop_when": {"it_holds_once": ["stop_when"]},
    "process/test_monitors": {
        "the_belief_is_the_posterior_of_the_step_and_of_what_the_monitor_says": ["monitor"]
    },
    "test_derived_mapping": {
        "the_call_has_the_skills_name_and_its_parameters_and_the_result_the_response": ["no mapping"]
    },
}
"""The tests that show each construct at work, by their files."""


@pytest.mark.parametrize("construct", MISUSES)
def test_a_construct_that_is_misused_is_told_at_its_place(construct):
    rule = MISUSES[construct]
    files, place = bundle_of(rule)
    loaded = load_files(files)
    findings = list(loaded.diagnostics)
    if loaded.project is not None:
        findings += lower(loaded.project)[1]
    texts = [f"{finding.span} {finding.code} {finding.message}" for finding in findings]
    told = [finding for finding in findings if (finding.code, finding.span) == (rule.code, place)]
    assert told, texts
    assert any(finding.is_error for finding in told) == (construct not in WARNED_OF)


def test_each_construct_is_shown_at_work_by_tests_that_exist():
    shown = chain.from_iterable(chain.from_iterable(tests.values()) for tests in AT_WORK.values())
    assert sorted(shown) == sorted(MISUSES)
    for path, tests in AT_WORK.items():
        folder, _, file = path.rpartition("/")
        source = (ROOT / "tests" / (folder or "unit") / f"{file}.py").read_text(encoding="utf-8")
        assert [test for test in tests if f"def test_{test}(" not in source] == []
