import json

import pytest
from lint_texts import ENVIRONMENT, MAPPING, SKILL, finding_texts, found, skill_after
from marked_change import changed
from test_reading_rules import JSON
from texts import encoded

from aos_language.follow_ups import told_once
from aos_language.load import load_files
from aos_protocol.diagnostics import Diagnostic, Severity, Span, render


@pytest.mark.parametrize(
    ("text", "line", "word"),
    [
        (("environment", "horizon: 4", "horizon 4"), 2, "horizon"),
        (("environment", "state_variable: Cell second", "state_variable Cell second"), 11, "state_variable"),
        (("environment", "initial_belief:", "initial_belief"), 19, "initial_belief"),
        (("environment", "reward_code:", "reward_code  "), 22, "reward_code"),
        (("skill", "parameter: int", "parameter int"), 2, "parameter"),
        (("skill", "dynamic_model:", "dynamic_model"), 8, "dynamic_model"),
        (("skill", "violate_penalty: -1", "violate_penalty -1"), 6, "violate_penalty"),
        (("mapping", "module_activation: skill", "module_activation skill"), 5, "module_activation"),
        (("mapping", "local_variable: steps", "local_variable steps"), 11, "local_variable"),
        (("mapping", "response_rule: True", "response_rule True"), 3, "response_rule"),
    ],
)
def test_a_missing_colon_is_one_error(text, line, word):
    document, before, after = text
    whole = {"environment": ENVIRONMENT, "skill": SKILL, "mapping": MAPPING}[document]
    (only,) = finding_texts(**{document: whole.replace(before, after)})
    assert only == f"{line} AOS104 a colon is missing after `{word}`. Write `{word}:`"


@pytest.mark.parametrize(
    ("file", "before", "after", "skills"),
    [
        ("hall.ef", "reward_code:", "reward_code", ["run", "walk"]),
        ("hall.ef", "reward_code:", "rewrad_code:", ["run", "walk"]),
        ("walk.sd", "project: hall\n", "a line\nproject: hall\n", ["run"]),
        ("hall.ef", "project: hall\n", "a line\nproject: hall\n", []),
    ],
)
def test_the_compiler_may_tell_of_all_but_declarations_that_are_wrong(file, before, after, skills):
    files = {"hall.ef": ENVIRONMENT, "walk.sd": SKILL, "run.sd": SKILL, "walk.am": MAPPING}
    files[file] = files[file].replace(before, after)
    loaded = load_files(encoded(files))
    assert loaded.has_errors
    assert [skill.name for skill in loaded.draft.skills] == skills if loaded.draft else not skills


def test_a_condition_that_sets_what_may_only_be_read_is_one_error():
    (only,) = found(environment=ENVIRONMENT.replace("state.second.x == 3", "state.second.x = 3"))
    assert (only.code, only.hint) == ("AOS123", "It may only be read. To compare, write `==`")


@pytest.mark.parametrize(
    ("code", "told"),
    [
        (
            "__reward = -1,5;",
            "9 AOS149 the number behind this comma does nothing. A decimal is written with a point",
        ),
        (
            "if (state.second.x > 0,5 * steps) __reward = -1;",
            "9 AOS149 the number behind this comma does nothing. A decimal is written with a point",
        ),
        (
            "if (AOS.Bernoulli(0,3)) __reward = 1;",
            "9 AOS110 `AOS.Bernoulli` takes a probability, not 2 values. A decimal is written with a point",
        ),
        (
            "__reward = AOS.SampleNormal(1);",
            "9 AOS110 `AOS.SampleNormal` takes a mean and a deviation, not 1 value. ",
        ),
        (
            "if state.first.x > 0:\n    __reward = 1\nelse:\n    __reward = 2",
            "9 AOS108 `if ...:` is Python. The model's code is C++: `if (...) { ... } else { ... }`",
        ),
        ("if (steps => 2) __reward = 1;", "9 AOS108 `=>` is no operator of C++. Write `>=`"),
        (
            "if (to_string(steps) == '12' || '\\n' == '\\x41') __reward = 1;",
            "9 AOS108 '12' is no character. A text stands in double quotes",
        ),
        (
            "switch (steps) { case 1: __reward = 1; break; defualt: __reward = 2; }",
            "9 AOS108 `defualt:` is a label in C++. Did you mean `default:`?",
        ),
        (
            "int x = 3\n__reward = x;",
            "9 AOS108 unexpected '3' in C++. Is a semicolon missing at the end of this line?",
        ),
    ],
)
def test_what_other_languages_write_is_told_once(code, told):
    assert finding_texts(skill=skill_after(code)) == [told]


@pytest.mark.parametrize("name", ["__reward", "2fast", "__LINE__"])
def test_a_refused_name_is_told_once(name):
    block = f"assignment:\ntemporary_variable: int {name}\ncode:\nint n = {name};\nassignment:\ncode:\n"
    (only,) = found(environment=ENVIRONMENT.replace("initial_belief:\n", f"initial_belief:\n{block}"))
    assert only.code == "AOS126"


def test_code_that_uses_a_variable_with_a_refused_name_is_not_wrong_as_well():
    codes = {finding.code for finding in found(environment=ENVIRONMENT.replace("near", "__reward"))}
    assert codes == {"AOS126"}


def test_a_number_that_cannot_be_read_hides_no_other_mistake_and_brings_no_remark():
    files = encoded(JSON)
    for file, change in (
        ("room.json", '"Reward": «5.0→"much"»'),
        ("room.json", "state.«at→att» == eLab"),
        ("go.json", '«-2→"a lot"»\n'),
    ):
        files, _ = changed(files, file, change)
    assert sorted(finding.code for finding in load_files(files).diagnostics) == ["AOS106", "AOS106", "AOS110"]


def test_a_second_value_for_a_field_and_a_misspelt_type_of_a_mapping_are_told():
    mapping = MAPPING.replace("parameter: steps\ncode:\nsteps\n", "parameter: steps\ncode:\nsteps\n" * 2)
    mapping = mapping.replace("local_variable: steps\n", "local_variable: steps\ntype: imt\n")
    assert finding_texts(mapping=mapping) == [
        "12 AOS126 a second value for the field `steps` of the call. Take one of the two out",
        "14 AOS110 unknown type `imt` of the local variable steps. Did you mean `int`?",
    ]


def test_names_to_import_that_are_no_list_are_one_error():
    mapping = {
        "PlpMain": {"Project": "hall", "Name": "walk", "Type": "Glue"},
        "ModuleActivation": {"Skill": {"ServicePath": "/walk", "ImportCode": [{"From": "m", "Import": "N"}]}},
    }
    files = {"hall.ef": ENVIRONMENT, "walk.sd": SKILL, "walk.json": json.dumps(mapping)}
    errors = [each for each in load_files(encoded(files)).diagnostics if each.severity is Severity.ERROR]
    assert [each.message for each in errors if each.span.file == "walk.json"] == [
        '"Import" must be a list, not a string'
    ]


@pytest.mark.parametrize(
    ("written", "hint"),
    [
        ("state__.x = 1;", 'Write `[{"AssignmentCode": "..."}]`'),
        (["state__.x = 1;"], 'Write `{"AssignmentCode": "..."}`'),
        ({"AssignmentCode": "state__.x = 1;"}, 'Write `[{"AssignmentCode": "..."}]`'),
    ],
)
def test_code_where_a_list_of_assignments_belongs_is_told_how_to_write_one(written, hint):
    skill = {
        "PlpMain": {"Project": "hall", "Name": "run", "Type": "PLP"},
        "DynamicModel": {"NextStateAssignments": written},
    }
    (error,) = load_files(encoded({"hall.ef": ENVIRONMENT, "run.json": json.dumps(skill)})).diagnostics
    assert (error.code, error.hint) == ("AOS106", hint)


@pytest.mark.parametrize(
    ("assignment", "code", "hint"),
    [
        ({"Code": "state__.second.x = 1;"}, "AOS102", "Did you mean `AssignmentCode`?"),
        ({"AssignmentName": "a", "Body": ["int n = 1;"]}, "AOS102", "Missing here: `AssignmentCode`"),
        (
            {"IterateNextStateVars": [{"Type": "Cell", "ItemName": "each", "Code": "each.x = 1;"}]},
            "AOS102",
            "Missing here: `WhenConditionTrueCode`",
        ),
        (
            {
                "TempVar": {
                    "VarName": "n",
                    "Type": "Enum",
                    "EnumName": "Ending",
                    "EnumValues": ["Good", "Bad"],
                }
            },
            "AOS127",
            "It is read as enum",
        ),
        ({"AssignmentName": "nothing yet", "Comment": "to do"}, "", ""),
    ],
)
def test_code_below_a_wrong_key_is_an_error_where_nothing_else_is_done(assignment, code, hint):
    skill = {
        "PlpMain": {"Project": "hall", "Name": "run", "Type": "PLP"},
        "DynamicModel": {"NextStateAssignments": [assignment, {"AssignmentCode": "__reward = 1;"}]},
    }
    found = load_files(encoded({"hall.ef": ENVIRONMENT, "run.json": json.dumps(skill)})).diagnostics
    assert [(each.code, each.hint) for each in found if each.code != "AOS114"][:1] == [(code, hint)] * bool(
        code
    )


@pytest.mark.parametrize(
    ("change", "hint"),
    [
        ("ServicePath→ActionPath", "Did you mean `ServicePath`?"),
        (
            "FromGlobalVariable→SKILL_PARAM",
            "Missing here: `FromGlobalVariable`, `FromROSServiceResponse`, `RosTopicPath`",
        ),
    ],
)
def test_an_unknown_key_of_an_object_that_lacks_one_is_told_with_what_it_may_mean(change, hint):
    files, _ = changed(encoded(JSON), "go glue.json", f'"«{change}»"')
    (error,) = [each for each in told_once(load_files(files).diagnostics) if each.is_error]
    assert (error.code, error.hint) == ("AOS102", hint)


def test_a_misspelt_truth_of_a_source_is_one_error():
    mapping = MAPPING + "\nlocal_variable: ok\nfrom_ros_service_response: ture\ncode:\nok = __input.ok\n"
    assert [told.split(" ", 2)[1] for told in finding_texts(mapping=mapping)] == ["AOS106"]


def test_a_bare_name_is_told_beside_a_wrong_declaration_of_the_environment():
    environment = ENVIRONMENT.replace("horizon: 4", "horizon: four")
    skill = SKILL.replace(
        "dynamic_model:\n", "dynamic_model:\nint lenght = steps;\nif (length > 1) __reward = 1;\n"
    )
    lines = finding_texts(environment=environment, skill=skill)
    assert any("unknown name `length`. Did you mean `lenght`?" in line for line in lines), lines


def test_shared_code_that_is_no_cpp_is_an_error_that_no_compiler_follows():
    shared = "shared_code:\nint twice(int n) { retrun n * 2; }\nint one() { return twice(1); }\n"
    files = {"hall.ef": f"{ENVIRONMENT}\n{shared}", "walk.sd": SKILL, "walk.am": MAPPING}
    loaded = load_files(encoded(files))
    (only,) = [found for found in loaded.diagnostics if found.is_error]
    assert (only.code, only.excerpt) == ("AOS108", shared.splitlines()[1])
    assert loaded.draft is None


@pytest.mark.parametrize(
    ("before", "wrong", "told"),
    [
        ("int x 0", "x int 0", "the type comes first: `int x`"),
        ("state_variable: Cell first", "state_variable: first Cell", "the type comes first: `Cell first`"),
        ("int x 0", "x", "`variable:` needs a type and a name"),
        ("int x 0", "int x [2]", "unexpected '[2]'"),
        ("horizon: 4", "horizon: 4\na hall\nof cells", "text after `horizon:` that belongs to no section"),
    ],
)
def test_uses_of_a_variable_that_is_declared_wrongly_are_no_mistakes(before, wrong, told):
    assert [each.message for each in found(environment=ENVIRONMENT.replace(before, wrong))] == [told]


@pytest.mark.parametrize("wrong", ["steps int", "steps Cell"])
def test_uses_of_a_parameter_that_is_declared_wrongly_are_no_mistakes(wrong):
    skill = SKILL.replace("int steps", wrong).replace("state.second.x + steps", "steps")
    environment = f"{ENVIRONMENT}\naction_parameter: Cell third\n"
    assert [each.code for each in found(environment=environment, skill=skill)] == ["AOS104"]


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("Cell& one = state.first;\none.x = 3;", 10),
        ("for (Cell* one : state_.CellObjects) one->x = 3;", 9),
        ("Cell* one = &state.first; one->x++;", 9),
        ("auto& one = state.first.x ? state__.first : state__.second; one.x = 3;", None),
        ("Cell& one = state.first; int x = one.x; x = 3;", None),
        ("vector<int> v; for (auto& x : v) x = 3; Cell* one = &state.first; one = &state.second;", None),
    ],
)
def test_what_a_reference_changes_may_change(code, told):
    lines = [
        each.span.line
        for each in found(skill=SKILL.replace("state__.second", f"{code}\nstate__.second"))
        if each.code == "AOS123" and "may only be read in the dynamic model" in each.message
    ]
    assert lines == ([told] if told else [])


@pytest.mark.parametrize(
    "code",
    [
        "std::sort(state__.CellObjects.begin(), state__.CellObjects.end());",
        "std::swap(state__.CellObjects[0], state__.CellObjects[1]);",
        "state__.CellObjects.clear();",
    ],
)
def test_a_list_of_objects_that_is_changed_is_told_once_with_what_may_change(code):
    (told,) = found(skill=skill_after(code))
    assert (told.code, told.span.line) == ("AOS128", 9)
    assert told.hint == "Change a copy of it: `auto list = state__.CellObjects;`"
    copied = "auto list = state__.CellObjects; std::sort(list.begin(), list.end()); list[0]->x = 1;"
    assert not found(skill=skill_after(copied))


def test_a_list_and_a_loop_without_objects_are_told_once():
    environment = ENVIRONMENT.replace("state_variable: Cell", "action_parameter: Cell")
    environment = environment.replace("initial_belief:\nstate.first.x", "initial_belief:\nint x")
    loop = "while (state.CellObjects.empty()) for (auto* each : state__.CellObjects) each->x = 1;"
    skill = SKILL.replace("state__.second.x =", f"{loop}\nint next =")
    assert finding_texts(environment=environment, skill=skill) == [
        "9 AOS133 `CellObjects` is empty: no state variable is a Cell. Action parameters and elements of "
        "arrays are not among them"
    ]


def test_a_message_that_is_cut_off_keeps_its_points():
    assert (
        render(Diagnostic(Severity.ERROR, "A", "x=1, ...", Span("a"), "Look")) == "a: error[A]: x=1, ... Look"
    )
