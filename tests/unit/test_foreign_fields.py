import pytest

from aos_protocol.errors import SkillError
from aos_runtime.adapters.expressions import check_expression, translated

GOAL = {"goal": {"x": 1.5, "y": -2.0, "parts": [{"name": "arm"}]}, "yaw": 0.5, "success": True}


def test_fields_pass_as_they_are_where_nothing_else_is_said():
    assert translated(None, GOAL, "a call") == GOAL


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("goal.x", 1.5),
        ("goal.x + 2 * yaw", 2.5),
        ("degrees(pi)", 180.0),
        ("'true' if success else 'false'", "true"),
        ("goal", GOAL["goal"]),
        ("goal.parts[0].name", "arm"),
        ("[goal.x, goal.y]", [1.5, -2.0]),
        (" 0.25", 0.25),
    ],
)
def test_an_expression_sees_the_fields_that_come_in(expression, value):
    assert check_expression(expression) == ""
    assert translated({"field": expression}, GOAL, "a call") == {"field": value}


def test_with_expressions_nothing_else_passes():
    assert translated({}, GOAL, "a call") == {}


def test_a_field_that_cannot_be_computed_is_named_with_those_there_are():
    with pytest.raises(SkillError) as error:
        translated({"x": "pose.x"}, GOAL, "a call of /go")
    assert error.value.code == "AOS502"
    assert "the field x of a call of /go cannot be computed by 'pose.x': NameError" in str(error.value)
    assert "the fields that come in are goal, success, yaw" in str(error.value)


@pytest.mark.parametrize("text", ["goal.", "x = 1", "1 +", ""])
def test_what_is_no_expression_is_found_when_the_file_is_read(text):
    assert check_expression(text) != ""
