import pytest
from lint_texts import ENVIRONMENT, MAPPING, SKILL, finding_texts, found, skill_after
from places import ROOT
from texts import encoded

from aos_language.load import load_files
from aos_protocol.diagnostics import Severity

KETTLE = ROOT / "docs/examples/kettle-json"

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


def test_an_unknown_name_in_the_condition_of_a_response_is_taken_for_none():
    told = "10 AOS110 unknown name `stepz`. Did you mean `steps`?"
    assert finding_texts(skill=SKILL.replace("= walked;", "= stepz > 1 ? walked : walked;")) == [told]


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
    assert finding_texts(skill=skill_after(code)) == []


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
        ("steps < 1,5", "A decimal is written with a point"),
        ("steps == 1 or 2", "Write each comparison in full"),
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


RESULT = "\nlocal_variable: {0}\ntype: float\nfrom_ros_service_response: true\ncode:\n{0} = {1}\n"
NUMBERS = RESULT.format("a", "__input.a") + RESULT.format("b", "__input.b")
TWO = SKILL.replace("= walked;", "= AOS.Bernoulli(0.5) ? walked : stuck;")


def ruled(first: str, second: str) -> str:
    rules = f"response: walked\nresponse_rule: {first}\nresponse: stuck\nresponse_rule: {second}\n"
    return MAPPING.replace("response: walked\nresponse_rule: True\n", rules) + NUMBERS


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        ("a > 4", "a < 4 and b", ""),
        ("a > 4", "a <= 4", ""),
        ("0 < a < 4", "a >= 4", ""),
        ("count <= 1", "count >= 2", ""),
        ("a > 4", "a < 4", "AOS118 no rule holds where a is 4: what comes back is then unknown"),
        ("0 < a < 4", "a >= 5", "AOS118 no rule holds where a is 4: what comes back is then unknown"),
        ("count <= 1", "count > 2", "AOS118 no rule holds where count is 2: what comes back is then unknown"),
        ("a > 4 & b", "True", "AOS149 `&` binds before the comparison: this compares with `4 & b`"),
        ("a & 4 == 4 or (a > 4) & b or a == (4 | b)", "True", ""),
        ("True", "a > 4", "AOS118 the rule for stuck never fires"),
        ("True", "__skill_status == 'failed'", ""),
    ],
)
def test_rules_that_leave_a_number_out_never_hold_or_compare_with_bits_are_told(first, second, told):
    mapping = ruled(first, second) + RESULT.format("count", "__input.count").replace("float", "int")
    found_ = [text for text in finding_texts(skill=TWO, mapping=mapping) if "AOS133" not in text]
    assert [text.partition(" ")[2].split(". ")[0] for text in found_] == [told] * bool(told)


@pytest.mark.parametrize(
    ("mapping", "place"),
    [
        (ruled("a > b", "True").replace("__input.a", "1 + b"), (20, 9)),
        (ruled("a > b", "True").replace("code:\nsteps", "code:\nsteps + a"), (11, 9)),
        (ruled("a > b", "True").replace("__input.a", "1 if b is None else b"), None),
    ],
)
def test_a_result_that_is_read_before_it_is_set_is_told(mapping, place):
    told = found(skill=TWO, mapping=mapping)
    assert [(one.span.line, one.span.column) for one in told] == [place] * bool(place)
    assert all("is `None` here: it is set later" in one.message for one in told)


@pytest.mark.parametrize(
    ("code", "place"),
    [
        ("a = 1\ndel a", (2, 5)),
        ("try:\n    a = 1\nexcept KeyError as a:\n    pass", (3, 1)),
        ("del a; a = 1", None),
        ("try:\n    a = 1\nexcept KeyError as a:\n    return 2", None),
        ("try:\n    a = 1\nexcept KeyError as a:\n    pass\nimport math as a", None),
    ],
)
def test_code_that_takes_its_own_variable_away_is_told_where_it_does(code, place):
    mapping = ruled("a > 1", "True").replace("a = __input.a", code)
    first = mapping[: mapping.index(code)].count("\n")
    told = [one for one in found(skill=TWO, mapping=mapping) if one.severity is Severity.ERROR]
    assert [(one.span.line - first, one.span.column) for one in told] == [place] * bool(place)


def test_keys_that_no_value_of_an_enum_has_and_values_without_a_key_are_told():
    skill = SKILL.replace("int steps", "Side steps").replace("+ steps", "+ (steps == Left)")
    environment = SIDES.replace("action_parameter: int near\ncode:\nstate.near = 1;\n", "")
    for table, told in (
        ("{'Left': 1, 'Rihgt': 2}", "no value of Side is called 'Rihgt'. Did you mean 'Right'?"),
        ("{'Left': 1}", "there is no key for `Right` of Side, with which this fails"),
        ("{'Left': 1, 'Right': 2}", ""),
    ):
        mapping = MAPPING.replace("code:\nsteps", f"code:\n{table}[steps]")
        texts = finding_texts(environment=environment, skill=skill, mapping=mapping)
        assert [told in text for text in texts if "AOS149" in text] == [True] * bool(told)


def test_a_mistyped_key_that_others_build_on_is_one_mistake():
    names = ("LocalVariablesInitialization", "GlobalVariablesDeclaration", "EnumValues", "ResponseRules")
    for name in (*names, "NextStateAssignments", "ModuleResponse", "GlobalVariableTypes"):
        files = {path.name: path.read_bytes() for path in KETTLE.iterdir() if path.is_file()}
        (changed,) = [file for file, text in files.items() if text.count(f'"{name}"'.encode()) and file]
        files[changed] = files[changed].replace(f'"{name}"'.encode(), f'"{name}x"'.encode(), 1)
        (only,) = load_files(files).diagnostics
        assert (only.code, only.hint, only.span.file) == ("AOS102", f"Did you mean `{name}`?", changed)


def test_a_key_of_which_only_the_beginning_is_written_is_told_whole():
    files = {path.name: path.read_bytes() for path in KETTLE.iterdir() if path.is_file()}
    files["environment.json"] = files["environment.json"].replace(b"BeliefStateAssignments", b"Belief")
    told = [one.hint for one in load_files(files).diagnostics if one.code == "AOS102"]
    assert told == ["Did you mean `InitialBeliefStateAssignments`?"]


@pytest.mark.parametrize(
    ("rule", "told"),
    [
        ('steps == "3"', ["`steps` is of the type int, and '3' is a text"]),
        ("'3' < steps", ["`steps` is of the type int, and '3' is a text"]),
        ("place == 3", ["`place` is a text, and 3 is none"]),
        ("steps == 3 and place == '3' and steps in ('3', 3) and many == '3'", []),
    ],
)
def test_a_number_compared_with_a_text_in_a_mapping_is_told(rule, told):
    mapping = MAPPING.replace(
        "response_rule: True", f"response_rule: {rule}\nresponse: walked\nresponse_rule: True"
    )
    for name, kind in (("place", "string"), ("many", "int[]")):
        declared = f"local_variable: {name}\ntype: {kind}\nfrom_ros_service_response: true"
        mapping += f"\n{declared}\ncode:\n{name} = __input\n"
    texts = [one.message for one in found(mapping=mapping) if one.code == "AOS149"]
    assert texts == told


@pytest.mark.parametrize(
    ("rule", "line", "told"),
    [
        ("place.isupper", "", "`place.isupper` is a function, and counts as true"),
        ("place is 'far'", "", "`is` asks whether this is the very object 'far'"),
        ("place", "place = __input.places.sort()", "`sort` changes the list and gives None"),
        ("place.isupper() and place is not None", "far = __input.places; far.sort(key=place.count)", ""),
    ],
)
def test_slips_of_python_are_told(rule, line, told):
    mapping = MAPPING.replace("rule: True", f"rule: {rule}\nresponse: walked\nresponse_rule: True")
    mapping += "\nlocal_variable: place\ntype: string\nfrom_ros_service_response: true\ncode:\n"
    texts = [one.message for one in found(mapping=f"{mapping}place = __input.place\n{line}\n")]
    assert texts == [told] * bool(told)


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ("steps == 3", ["this line does nothing"]),
        ("steps.data > 3", ["this line does nothing", "`steps` is of the type int, which has no `data`"]),
        ("try:\n    __input.far\nexcept AttributeError:\n    print(steps.real)", []),
    ],
)
def test_a_line_that_does_nothing_and_a_field_of_a_number_are_told(lines, told):
    declared = "local_variable: far\ntopic: /far\nmessage_type: Far\ntype: int\ncode:\n"
    mapping = f"{MAPPING}\n{declared}{lines}\nreturn __input.far\n"
    texts = [one.message for one in found(mapping=mapping) if one.code == "AOS149"]
    assert sorted(texts) == sorted(told)


@pytest.mark.parametrize(("imported", "is_told"), [("Far", True), ("*", False), ("FarRequest", False)])
def test_a_type_called_nearly_as_an_imported_one_is_told(imported, is_told):
    far = f"local_variable: far\nimports: from: m import: {imported}\ntopic: /far\nmessage_type: far\ncode:\n"
    told = [one.hint for one in found(mapping=f"{MAPPING}\n{far}return 1\n") if one.code == "AOS110"]
    assert told == ["Did you mean `Far`?"] * is_told


def test_a_missing_semicolon_before_a_copy_of_the_state_is_told_once():
    (only,) = found(skill=skill_after("float far = state.first.x"))
    assert (only.code, only.span.line) == ("AOS108", 10)
    assert only.hint == "Is a semicolon missing at the end of the line above?"


def test_a_real_number_that_rounding_makes_miss_a_decimal_is_told():
    changed = ENVIRONMENT.replace(
        "x 0\n", "x 0\nvariable: float width\nvariable: double far\nvariable: double at 0.3\n"
    )
    code = "state__.first.far += 0.1;\n__reward = (state.second.width == 0.3) + (state.first.far == 0.3);\n"
    exact = "__reward += (state.second.width == 0.5) + (state.first.at == 0.3) + (state.first.far == 0.25);\n"
    told = found(environment=changed, skill=SKILL.replace("state__.second", f"{code}{exact}state__.second"))
    assert [(one.span.column, one.severity, one.hint) for one in told] == [
        (13, "warning", "Write `std::abs(state.second.width - 0.3) < 1e-6`"),
        (43, "remark", "Write `std::abs(state.first.far - 0.3) < 1e-6`"),
    ]


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("steps;", "9 AOS149 this statement does nothing. To set a variable, write `NAME = steps;`"),
        (
            "__reward - (1);",
            "9 AOS149 this statement does nothing. To set a variable, write `NAME = __reward - (1);`",
        ),
        ("__reward =+ 1;", "9 AOS149 this `+` does nothing. To add, write `+=`"),
        ("__reward = +1; __reward += +1;", ""),
        ("(void)steps; if (steps > 1) state__.first.x++;", ""),
        ("state__.first.x += 0.2;", "9 AOS149 `state__.first.x` is a whole number, and `0.2` is none. "),
        ("int far = -1.5; state__.first.x = far;", "9 AOS149 `far` is a whole number, and `-1.5` is none. "),
        ("int n = 2.0; state__.first.x = n * 1.5; state__.first.x *= 0.5;", ""),
        (
            "vector<int> n = [1, 2]; __reward = n[0];",
            "9 AOS108 a list stands in braces in C++. Write `{1, 2}`",
        ),
        ("if (steps =< 1) __reward = 1;", "9 AOS108 `=<` is no operator of C++. Write `<=`"),
        ("auto f = [steps] { return steps; }; __reward = f();", ""),
        ("__reward = 7/2;", "9 AOS149 `7/2` is 3 in C++. Write `7.0 / 2`"),
        (
            "__reward = 4/2 + (steps ^ 1) + (1 < steps < 3);",
            "9 AOS149 this compares the truth of `1 < steps`",
        ),
        ("__reward = steps ^ 2;", "9 AOS149 `^` is no power in C++. Write `std::pow(steps, 2)`"),
        ("if (steps > 1); __reward = 1;", "9 AOS149 this semicolon ends the `if`. "),
        ("if (steps > 1) ; else if (std::max<int>(steps, 1) > 2) __reward = 1;", ""),
        ("switch (steps) { case 1: __reward = 1; case 2: ; }", "9 AOS149 what stands here goes on into "),
        ("switch (steps) { case 0: case 1: { return; } case 3: ; [[fallthrough]]; default: ; }", ""),
    ],
)
def test_code_that_does_nothing_or_loses_a_fraction_is_told(code, told):
    texts = finding_texts(skill=skill_after(code))
    assert [text[: len(told)] for text in texts] == [told] * bool(told)


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("if (state.side == Left || Right) return;", "`Right` is compared with nothing here"),
        ("if (state.side != Left || state.side != Right) return;", "with what stands before it, this always"),
        ("if (steps > 1 && steps == 2 && steps == 3) return;", "with what stands before it, this never"),
        ("if (!steps == 3) return;", "`!` binds first: this compares `!steps`"),
        ("if (steps & 1 == 1) return;", "`==` binds first: this is `steps & (1 == 1)`"),
        ("__reward = -1 + steps ? 2 : 3;", "`+` binds before `?`: the condition is `-1 + steps`"),
        ("AOS.Bernoulli(0.5);", "nothing takes what `AOS.Bernoulli` gives"),
        ("state__.cells.empty();", "nothing takes what `state__.cells.empty` gives"),
        ("for (auto cell : state__.cells) cell.x = 1;", "`cell` is a copy: this changes nothing"),
        ("for (auto [key, n] : state__.table) ++n;", "`n` is a copy: this changes nothing"),
        ("bool b = steps == 1 || steps == 2 && state.side != Left; if (!b == b || b) return;", ""),
        ("if (steps == 1 | (steps & 2) == 2 && AOS.Bernoulli(0.5)) state__.cells.clear();", ""),
        ("for (auto c : state__.cells) __reward += c.x++; for (auto& c : state__.cells) c.x = 1;", ""),
    ],
)
def test_code_that_says_other_than_it_means_is_told(code, told):
    environment = f"{SIDES}state_variable: vector<Cell> cells\nstate_variable: map<int, int> table\n"
    all_told = found(environment=environment, skill=skill_after(code))
    texts = [each.message for each in all_told if each.code == "AOS149"]
    assert [text[: len(told)] for text in texts] == [told] * bool(told)


@pytest.mark.parametrize(
    ("time", "is_told"),
    [("1.33", True), ("AOS.SampleNormal(3, 1)", True), ("std::round(1.5 * steps)", False), ("steps", False)],
)
def test_an_execution_time_with_a_fraction_is_told(time, is_told):
    section = f"execution_time:\n__moduleExecutionTime = {time};\n\ndynamic_model:"
    texts = finding_texts(skill=SKILL.replace("dynamic_model:", section))
    message = f"9 AOS149 `__moduleExecutionTime` is a whole number, and `{time}` is none"
    assert [text.partition(". ")[0] for text in texts] == [message] * is_told


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("near", "17 AOS149 this code for the default of near sets nothing. Write `state.near = near;`"),
        ("{1, 2}", "17 AOS149 this code for the default of near sets nothing. Write `state.near = {1, 2};`"),
        ("state.near = 1.5;", "17 AOS149 `state.near` is a whole number, and `1.5` is none. "),
        ("AOS.SetNull(state.near);", ""),
    ],
)
def test_a_default_that_sets_nothing_or_loses_a_fraction_is_told(code, told):
    texts = finding_texts(environment=ENVIRONMENT.replace("state.near = 1;", code))
    assert [text[: len(told)] for text in texts] == [told] * bool(told)


def test_a_decimal_comma_in_the_default_of_a_field_is_an_error():
    (only,) = found(environment=ENVIRONMENT.replace("int x 0", "int x 0\nvariable: float far 0,5"))
    assert (only.is_error, only.code, only.mend.text) == (True, "AOS149", ".")


def test_a_constant_of_a_message_class_is_told():
    imported = MAPPING.replace("path:", "imports: from: actionlib_msgs.msg import: GoalStatus\npath:")
    mapping = imported.replace("response_rule: True", "response_rule: steps == GoalStatus.SUCCEEDED or True")
    message = (
        "GoalStatus.SUCCEEDED is not known where GoalStatus cannot be imported. Write the constant's number"
    )
    assert finding_texts(mapping=mapping) == [f"3 AOS121 {message}"]


@pytest.mark.parametrize(
    ("rule", "column", "told"),
    [
        (
            "steps then",
            22,
            "`then` cannot stand here. Between two values stands an operator, such as `and` or `==`",
        ),
        ("if steps", 16, "`if` cannot stand here. This is one expression: leave `if` out"),
        ("steps;", 21, "`;` cannot stand here. This is one expression: leave `;` out"),
        ("steps++ > 1", 24, "`>` cannot stand here. Python writes `steps += 1`"),
        ("steps AND 3", 22, "`AND` cannot stand here. Python writes `and`, `or`, `not`"),
        ("steps =< 3", 22, "`=` cannot stand here. Python writes `<=`"),
        ("steps ? 1 : 0", 22, "`?` cannot stand here. Python writes `a if condition else b`"),
        ("steps >", 23, "something is missing here. "),
    ],
)
def test_a_word_that_python_cannot_read_is_told_with_what_to_write(rule, column, told):
    (only,) = found(mapping=MAPPING.replace("response_rule: True", f"response_rule: {rule}"))
    assert (f"{only.message}. {only.hint}", only.span.column) == (f"this is not Python: {told}", column)


def test_a_mistyped_low_level_type_of_a_constant_is_told():
    low_level = (
        "project: hall\ndefine_type: Pose\nvariable: float x\n\nconstant: Psoe home\ncode:\nhome.x = 1\n"
    )
    files = {"hall.ef": ENVIRONMENT, "walk.sd": SKILL, "walk.am": MAPPING, "hall.lf": low_level}
    (only,) = load_files(encoded(files)).diagnostics
    assert (only.message, only.hint) == ("unknown low-level type `Psoe`", "Did you mean `Pose`?")


@pytest.mark.parametrize(
    ("rule", "told"),
    [
        ("__skill_status == 'fail'", "3 AOS149 no value of __skill_status is called 'fail'. "),
        (
            "__skill_status in ('failed', 'timedout')",
            "3 AOS149 no value of __skill_status is called 'timedout'. ",
        ),
        ("__skill_status not in ('failed', 'timed_out')", ""),
    ],
)
def test_a_status_that_no_skill_has_is_told(rule, told):
    rules = f"response_rule: {rule}\nresponse: walked\nresponse_rule: True"
    texts = finding_texts(mapping=MAPPING.replace("response_rule: True", rules))
    assert [text[: len(told)] for text in texts if "AOS149" in text] == [told] * bool(told)
