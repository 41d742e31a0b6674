import math

import pytest
from mapping_runs import emitted_with, loaded, observed, raised, running

from aos_middleware.workers.frames import Begin, Finish, Raised, Take


def test_an_exception_is_placed_at_the_innermost_line_of_the_mapping():
    emission = emitted_with("""\
local_variable: level
topic: /level
message_type: Level
code:
def of(value):
    return value.levle
return of(__input)
""")
    answer = raised(loaded(emission), Take([("/level", {"level": 1})]))
    assert answer.error == "AttributeError: no field 'levle'; did you mean 'level'?"
    assert str(emission.locate(answer.line, answer.column)) == "look.am:9:12"


def test_columns_count_characters_not_bytes():
    emission = emitted_with("parameter: a\ncode:\n'äöü' + nothing\n")
    answer = loaded(emission).answer(Begin({}))
    assert isinstance(answer, Raised)
    assert str(emission.locate(answer.line, answer.column)) == "look.am:6:9"


def test_a_rule_over_a_silent_topic_says_which_variable_has_no_value():
    mapping = running("""\
response: high
response_rule: level > 3
local_variable: level
topic: /level
message_type: Level
code:
return __input.data
""")
    answer = raised(mapping, Finish({}))
    assert answer.unset == ("level",)
    assert answer.local_variables == {"level": "null"}


def test_a_type_error_in_a_rule_names_the_variables_of_its_expression():
    mapping = running("""\
response: high
response_rule: weight < 3
local_variable: weight
from_ros_service_response: true
code:
weight = "heavy"
""")
    assert raised(mapping, Finish({})).error.endswith("""'str' and 'int'; weight is "heavy\"""")


def test_a_result_without_a_value_is_told_and_not_the_silent_topic_beside_it():
    mapping = running("""\
response: high
response_rule: level is not None and level > 3 or weight > 3
local_variable: level
topic: /level
message_type: Level
code:
return __input.data
local_variable: weight
from_ros_service_response: true
code:
weight = None
""")
    answer = raised(mapping, Finish({}))
    assert answer.unset == ("weight",)


@pytest.mark.parametrize(
    ("code", "error", "place"),
    [
        ("raise ValueError('\\ud800')", "ValueError: \\ud800", "look.am:8:1"),
        ("level = 10**5000", "ValueError: Exceeds the limit", "look.am:4:26"),
    ],
)
def test_an_error_without_unicode_and_a_response_without_text_have_their_place(code, error, place):
    text = "response_local_variable: level\nlocal_variable: level\nfrom_ros_service_response: true\n"
    emission = emitted_with(f"{text}code:\n{code}\n")
    answer = raised(loaded(emission), Finish({}))
    assert answer.error.startswith(error)
    assert str(emission.locate(answer.line, answer.column)) == place


def test_a_service_variable_that_is_never_assigned_is_an_error_at_its_place():
    emission = emitted_with("""\
local_variable: success
from_ros_service_response: true
code:
succes = __input.success
""")
    answer = raised(loaded(emission), Finish({"success": True}))
    assert "success" in answer.error
    assert emission.locate(answer.line).line == 4


@pytest.mark.parametrize("success", ["yes", "", math.nan, -1, [True], {"ok": True}])
def test_what_is_neither_true_nor_false_is_no_value_of_the_type_bool(success):
    emission = emitted_with("""\
response: done
response_rule: success
response: not_done
response_rule: True
local_variable: success
type: bool
from_ros_service_response: true
code:
success = __input.success
""")
    mapping = loaded(emission)
    answer = raised(mapping, Finish({"success": success}))
    assert answer.error.startswith("TypeError: success has the type bool and is ")
    assert str(emission.locate(answer.line, answer.column)) == "look.am:12:1"
    for value, response in ((1, "done"), (0.0, "not_done"), (None, "not_done")):
        assert observed(mapping, {}, [], {"success": value}).response == response


def test_leaving_the_program_ends_only_the_evaluation():
    mapping = loaded(emitted_with("parameter: a\ncode:\n__import__('sys').exit(3)\n"))
    for _ in range(2):
        answer = mapping.answer(Begin({}))
        assert isinstance(answer, Raised)
        assert answer.error == "SystemExit: 3"
