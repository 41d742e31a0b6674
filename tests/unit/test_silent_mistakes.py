"""Slips that C++ and Python take without a word, or tell only when a robot runs."""

import pytest
from lint_texts import ENVIRONMENT, MAPPING, SKILL, finding_texts, found

from aos_protocol.diagnostics import Severity

TEXT = MAPPING.replace("response: walked\nresponse_rule: True\n", "response_local_variable: steps\n")
SIDES = f"{ENVIRONMENT}\ndefine_type: Side\nenum_members: Left, Right\nstate_variable: Side side\n"
TON = "\nlocal_variable: tons\nfrom_ros_service_response: true\ntype: float\ncode:\n"
FAR = "int far(int a, bool b, int c = 2) { return b ? a : c; }"


def with_shared(code: str) -> str:
    return ENVIRONMENT.replace("define_type: Cell", f"shared_code:\n{code}\n\ndefine_type: Cell", 1)


@pytest.mark.parametrize(
    ("value", "name", "kind", "hint"),
    [
        ("count", "count", "int", "Write `std::to_string(count)`"),
        ('"step " + steps', "steps", "int", "Write `std::to_string(steps)`"),
        ('steps > 1 ? "far" : 0', "0", "number", 'Write it in quotes: `"0"`'),
        ("state__.side", "state__.side", "Side", "Write `std::to_string(state__.side)`, or a text"),
        ("Left", "Left", "Side", 'Write it in quotes: `"Left"`'),
    ],
)
def test_a_number_in_the_place_of_a_text_response_is_told(value, name, kind, hint):
    code = f"int count = steps;\n__moduleResponseStr = {value};"
    told = found(environment=SIDES, skill=SKILL.replace("__moduleResponse = walked;", code), mapping=TEXT)
    (only,) = [finding for finding in told if finding.code == "AOS116"]
    message = f"__moduleResponseStr takes a text, and `{name}` is of the type {kind}"
    assert (only.severity, only.message, only.hint[: len(hint)]) == (Severity.WARNING, message, hint)
    assert (only.span.line, only.span.column) == (11, 23 + value.index(name))


@pytest.mark.parametrize("value", ['steps > 1 ? "a" : name', "std::to_string(steps)", "names[steps]"])
def test_a_text_of_any_kind_is_a_text_response(value):
    code = f'std::string name = "n"; std::vector<std::string> names;\n__moduleResponseStr = {value};'
    assert finding_texts(skill=SKILL.replace("__moduleResponse = walked;", code), mapping=TEXT) == []


def test_a_number_in_the_place_of_a_response_is_told_with_the_names():
    told = "10 AOS116 `0` is a number, and no name of a response. The responses are `walked`"
    assert finding_texts(skill=SKILL.replace("= walked;", "= steps > 1 ? walked : 0;")) == [told]


@pytest.mark.parametrize(("call", "given"), [("far(1)", "1 value"), ("far(1, true, 2, 3)", "4 values")])
def test_a_call_of_a_shared_function_with_other_values_is_told_with_what_it_takes(call, given):
    told = f"9 AOS110 `far` is called with {given}. Shared code has `far(int a, bool b, int c = 2)`"
    assert finding_texts(environment=with_shared(FAR), skill=SKILL.replace("+ steps", f"+ {call}")) == [told]


@pytest.mark.parametrize(
    ("shared", "call"),
    [
        (FAR, "far(1, true)"),
        ("int far(int a) { return a; }\nint far() { return far(1); }", "far()"),
        ("int far(const auto&... all) { return sizeof...(all); }", "far(1, 2, 3)"),
        ("int far(int a) { return a; }", "[&](auto far) { return far(); }([] { return 1; }) + far(1)"),
    ],
)
def test_calls_that_a_shared_function_takes_are_left_alone(shared, call):
    skill = SKILL.replace("+ steps", f"+ {call}")
    assert finding_texts(environment=with_shared(shared), skill=skill) == []


def test_a_state_variable_that_is_set_without_its_state_is_told_with_it():
    for whole, before, meant in (
        ({"skill": SKILL}, "state__.second.x =", "state__.second"),
        ({"environment": ENVIRONMENT}, "if (state.second", "state.second"),
    ):
        (only,) = found(
            **{key: text.replace(before, f"second = {{3}};\n{before}") for key, text in whole.items()}
        )
        assert (only.code, only.message) == ("AOS110", "unknown name `second`")
        assert (only.hint, only.mend.text) == (f"Did you mean `{meant}`?", meant)


@pytest.mark.parametrize(
    "code",
    [
        "auto [first, second] = std::make_pair(1, 2); second = 3;",
        "auto set = [&](auto& second) { second = 3; }; set(state__.first.x);",
        "struct Pair { int second = 0; void raise() { second = 1; } };",
    ],
)
def test_names_that_code_declares_for_itself_are_no_state_variables(code):
    assert finding_texts(skill=SKILL.replace("state__.second.x =", f"{code}\nstate__.second.x =")) == []


@pytest.mark.parametrize(
    ("code", "right"),
    [
        ("tons = __input[tons]", "Write `__input.tons`"),
        ("tons = __input.report['load']", "Write `__input.report.load`"),
        ("tons = __input.loads[0]", ""),
        ("try:\n    tons = __input['a']\nexcept TypeError:\n    tons = 1.0", ""),
    ],
)
def test_a_field_of_the_input_in_brackets_is_told_as_an_attribute(code, right):
    told = found(mapping=f"{MAPPING.replace('True', 'tons')}{TON}{code}\n")
    places = [(each.code, each.span.line, each.span.column, each.hint) for each in told]
    assert places == ([("AOS121", 18, 8, right)] if right else [])


@pytest.mark.parametrize(
    ("rule", "hint"),
    [
        ("steps is TRUE", "Python writes `True`"),
        ("str(steps) == Left", "A value of Side is a text here: write `'Left'`"),
        ("math.isnan(steps)", "It is a module of Python: import it"),
        ("steps => 1", "Python writes `>=`"),
    ],
)
def test_a_name_of_another_place_is_told_with_what_python_writes(rule, hint):
    told = found(environment=SIDES, mapping=MAPPING.replace("rule: True", f"rule: {rule}"))
    assert hint in [each.hint for each in told]


def test_where_everything_is_imported_a_name_that_is_nearly_known_is_told():
    imports = "skill\nimports: from: hall.msg import: *\npath"
    mapping = MAPPING.replace("skill\npath", imports).replace("True", "stepss > stride and Steps(1) != true")
    told = [(each.severity, each.hint) for each in found(mapping=mapping) if each.code == "AOS110"]
    warning = Severity.WARNING
    assert told == [(warning, "Did you mean `steps`?"), (warning, "Python writes `True`")]


def test_a_first_value_that_takes_a_local_variable_is_told_what_to_write():
    topic = "local_variable: far\ntopic: /far\ntype: bool\ninitial_value: steps > 1\ncode:\nreturn far\n"
    (only,) = found(mapping=f"{MAPPING.replace('rule: True', 'rule: far')}\n{topic}")
    assert only.hint == "A first value is made when there is no local variable yet: write a constant"


def test_a_field_of_a_whole_compound_is_taken_by_brackets():
    (only,) = found(
        environment=ENVIRONMENT.replace("action_parameter: int near", "action_parameter: Cell near").replace(
            "state.near = 1", "state.near.x = 1"
        ),
        skill=SKILL.replace("int steps", "Cell steps").replace("+ steps;", "+ steps.x;"),
        mapping=MAPPING.replace("code:\nsteps", "code:\nsteps.x"),
    )
    assert (only.code, only.hint) == ("AOS121", "Write `steps['x']`")
