import pytest
from lint_texts import ENVIRONMENT, MAPPING, SIDES, SKILL, finding_texts, found

from aos_protocol.diagnostics import Severity

TON = "\nlocal_variable: tons\nfrom_ros_service_response: true\ntype: float\ncode:\n"


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


@pytest.mark.parametrize(
    ("rule", "told"),
    [
        ('steps == "3"', ["`steps` is of the type int, and '3' is a text"]),
        ("'3' < steps", ["`steps` is of the type int, and '3' is a text"]),
        ("place == 3", ["`place` is a text, and 3 is none"]),
        ("steps == 3 and place == '3' and steps in ('3', 3) and many == '3'", []),
        ("isinstance(steps, str) and steps == '3'", []),
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


def test_a_misspelt_method_of_a_text_is_told_with_the_one_that_is_near():
    declared = "local_variable: place\ntype: string\nfrom_ros_service_response: true\ncode:\n"
    mapping = MAPPING.replace("rule: True", "rule: place.endwith('hall')")
    told = [one.hint for one in found(mapping=f"{mapping}\n{declared}place = __input.place\n")]
    assert told == ["Did you mean `endswith`?"]


@pytest.mark.parametrize(("imported", "is_told"), [("Far", True), ("*", False), ("FarRequest", False)])
def test_a_type_called_nearly_as_an_imported_one_is_told(imported, is_told):
    far = f"local_variable: far\nimports: from: m import: {imported}\ntopic: /far\nmessage_type: far\ncode:\n"
    told = [one.hint for one in found(mapping=f"{MAPPING}\n{far}return 1\n") if one.code == "AOS110"]
    assert told == ["Did you mean `Far`?"] * is_told


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


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("text = __input.name\ntext.strip()\ntons = float(text)", "nothing takes what `strip` gives"),
        ("round(__input.a, 2)\ntons = __input.a", "nothing takes what `round` gives"),
        ("tons = float('{__input.a}')", "`{__input.a}` is text here, and no value"),
        ("tons = __input.a ^ 2", "`^` is no power in Python"),
    ],
)
def test_python_that_does_other_than_it_seems_to_say_is_told(code, told):
    texts = [each.message for each in found(mapping=f"{MAPPING.replace('True', 'tons')}{TON}{code}\n")]
    assert [text[: len(told)] for text in texts] == [told]


@pytest.mark.parametrize(
    "code",
    [
        "all = list(map(str.strip, __input.all))\nall.remove('a')\nall.sort()\ntons = float(all[0])",
        "text = 'about {tons}'\ntext = text.format(tons=__input.a)\ntons = len(text)",
        "try:\n    float(__input.a)\n    tons = 1.0\nexcept ValueError:\n    tons = (__input.b & 4) == 4",
        "# Takes {tons}.\ntons = __input.a ^ 4",
        "import os\nos.replace('a', 'b')\ntons = float('{a}'.replace('{a}', __input.name))",
    ],
)
def test_python_that_means_what_it_says_is_left_alone(code):
    assert found(mapping=f"{MAPPING.replace('True', 'tons')}{TON}{code}\n") == ()
