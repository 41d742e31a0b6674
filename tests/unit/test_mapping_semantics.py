"""The run of a generated mapping in one activation: sources of local variables, order, rules.

The module runs in this process; tests/process runs it where it belongs.
"""

from pathlib import Path

import pytest
from mapping_documents import emitted
from mapping_runs import HEAD, fields, loaded, observed, running
from places import BUNDLES, ROOT
from projects import bundle_project

from aos_middleware.mappings.revisions import emit_project
from aos_middleware.workers.worker import LoadedMapping
from aos_protocol.diagnostics import Span
from aos_protocol.documents import LowLevelConstant, LowLevelDocument, Snippet


def original(corpus: Path, bundle: str, skill: str) -> LoadedMapping:
    project = bundle_project(corpus / bundle)
    return loaded(next(generated for generated in emit_project(project) if generated.skill == skill))


# --- sources of local variables ---


def test_parameters_reach_the_call_through_dotted_paths():
    project = bundle_project(BUNDLES / "armadillo-finer")
    navigate = next(mapping for mapping in emit_project(project) if mapping.skill == "navigate")
    parameters = {"destination": {"place": "EasyTable", "x": 0.5, "y": 2.0, "yaw": 1.57}}
    assert fields(loaded(navigate), parameters) == {"x": 0.5, "y": 2.0, "yaw": 1.57}


def test_the_result_of_the_call_gives_service_variables():
    mapping = running("""\
response: done
response_rule: success
response: not_done
response_rule: not success
local_variable: success
from_ros_service_response: true
code:
success = __input.success
""")
    assert observed(mapping, {}, [], {"success": True}).response == "done"
    assert observed(mapping, {}, [], {"success": False}).response == "not_done"


@pytest.mark.parametrize(
    "code",
    [
        "if __input.m > 5:\n    far = True",
        "if __input.m > 5:\n    return True",
        "far: bool\n__input.m > 5 and (far := True)",
        "with closing(__input):\n    if __input.m > 5:\n        far = True",
        "with suppress(ZeroDivisionError):\n    far = __input.m / 0",
        "with suppress(ZeroDivisionError):\n    far = 1 / 0\n    return far",
        "match __input.m:\n    case 5:\n        far = True",
        "def is_far():\n    far = True\nif __input.m > 5:\n    far = is_far()",
        "near = [1 for far in ()]\nif __input.m > 5:\n    far = near",
    ],
)
def test_what_the_code_of_a_result_does_not_assign_has_no_value(code):
    mapping = running(f"""\
response: done
response_rule: far is None
local_variable: far
imports: from: contextlib import: nullcontext as closing, suppress
from_ros_service_response: true
code:
{code}
""")
    assert observed(mapping, {}, [], {"m": 2}).response == "done"


def test_topic_messages_are_evaluated_in_the_order_in_which_they_came():
    mapping = running("""\
response: three
response_rule: seen == [1, 2, 3]
local_variable: seen
topic: /n
message_type: Int
initial_value: []
code:
return seen + [__input.data]
""")
    messages = [("/n", {"data": number}) for number in (1, 2, 3)]
    assert observed(mapping, {}, messages, {}).response == "three"


def test_one_message_updates_its_variables_in_the_documents_order():
    mapping = running("""\
local_variable: first
topic: /n
message_type: Int
code:
return __input.data
local_variable: second
topic: /n
message_type: Int
code:
return first * 10
""")
    assert observed(mapping, {}, [("/n", {"data": 4})], {}).local_variables == {"first": "4", "second": "40"}


def test_the_result_is_evaluated_after_all_topic_messages():
    mapping = running("""\
local_variable: total
from_ros_service_response: true
code:
total = __input.offset + last
local_variable: last
topic: /n
message_type: Int
code:
return __input.data
""")
    variables = observed(mapping, {}, [("/n", {"data": 4})], {"offset": 1}).local_variables
    assert variables["total"] == "5"


def test_every_service_variable_is_evaluated_and_may_read_those_before_it():
    mapping = running("""\
local_variable: a
from_ros_service_response: true
code:
a = __input.x
local_variable: b
from_ros_service_response: true
code:
b = a + 1
""")
    assert observed(mapping, {}, [], {"x": 1}).local_variables == {"a": "1", "b": "2"}


def test_messages_of_topics_that_the_mapping_does_not_name_change_nothing():
    mapping = loaded(emitted(HEAD))
    assert observed(mapping, {}, [("/other", {"x": 1})], {}).response == "DefaultObservation"


def test_initial_values_are_evaluated_anew_for_each_activation():
    mapping = running("""\
response: one
response_rule: len(seen) == 1
local_variable: seen
topic: /n
message_type: Int
initial_value: []
code:
seen.append(__input.data)
""")
    for _ in range(2):
        assert observed(mapping, {}, [("/n", {"data": 1})], {}).response == "one"


def test_a_topic_that_says_nothing_in_this_activation_keeps_no_value_of_the_last():
    mapping = running("""\
response: heard
response_rule: level is not None
response: silent
response_rule: True
local_variable: level
topic: /level
message_type: Level
code:
return __input.data
""")
    assert observed(mapping, {}, [("/level", {"data": 1})], {}).response == "heard"
    assert observed(mapping, {}, [], {}).response == "silent"


@pytest.mark.parametrize(("code", "value"), [
    ("pass", '"old"'), ("return", "null"), ("return None", "null"),
    ("class Calm:\n    __enter__ = __exit__ = lambda *_: True\nwith Calm():\n    return int('x')", '"old"'),
])  # fmt: skip
def test_a_topic_value_becomes_none_only_by_an_explicit_return(code, value):
    mapping = running(f"""\
local_variable: text
topic: /n
message_type: Int
initial_value: 'old'
code:
{code}
""")
    assert observed(mapping, {}, [("/n", {})], {}).local_variables == {"text": value}


# --- rules ---


def test_the_first_rule_that_holds_wins_also_with_an_or_in_a_later_one():
    mapping = running("""\
response: low
response_rule: level < 3
response: any
response_rule: level > 5 or level < 4
local_variable: level
from_ros_service_response: true
code:
level = __input.level
""")
    answers = [observed(mapping, {}, [], {"level": level}).response for level in (1, 3, 6, 4)]
    assert answers == ["low", "any", "any", None]


def test_a_response_variable_without_a_value_is_no_response():
    mapping = running("""\
response_local_variable: board
local_variable: board
from_ros_service_response: true
code:
board = __input.state
""")
    assert observed(mapping, {}, [], {"state": "XO?"}).response == "XO?"
    assert observed(mapping, {}, [], {"state": None}).response is None


# --- imports and low-level values ---


def test_the_name_of_a_low_level_constant_reaches_the_mapping_as_its_value():
    (emission,) = emit_project(bundle_project(ROOT / "docs" / "examples" / "kettle-json"))
    assert fields(loaded(emission), {"cup": {"handle": "___left_handle"}}) == {"x": 0.3}


def test_what_one_activation_does_to_a_constant_does_not_reach_the_next():
    span = Span("environment.json", 1, 1)
    door = LowLevelConstant("___door", "Door", Snippet("___door.x = 1", (span,)), span)
    low_level = LowLevelDocument("garden", span, constants=(door,))
    for source in ("action_parameter: goal\n", "topic: /goal\ninitial_value: ___door\ncode:\npass\n"):
        text = "parameter: x\ncode:\nplace.__dict__.update(x=place.x + 1) or place.x\n"
        mapping = loaded(emitted(f"{HEAD}{text}local_variable: place\n{source}", low_level))
        for _ in range(2):
            assert fields(mapping, {"goal": "___door"}) == {"x": 2}


def test_a_part_of_a_constant_that_cannot_be_copied_is_shared_and_the_rest_is_not():
    span = Span("environment.json", 1, 1)
    code = "import threading as t\n___door.lock = {1: [t.Lock()]}\n___door.loop = ___door\n___door.x = 1"
    door = LowLevelConstant("___door", "Door", Snippet(code, (span,)), span)
    low_level = LowLevelDocument("garden", span, constants=(door,))
    text = (
        "parameter: same\ncode:\nid(___door.lock[1][0])\n"
        "parameter: x\ncode:\n___door.__dict__.update(x=___door.x + 1) or ___door.loop.x\n"
    )
    mapping = loaded(emitted(f"{HEAD}{text}", low_level))
    first = fields(mapping, {})
    assert first["x"] == 2
    assert fields(mapping, {}) == first


def test_a_module_that_is_installed_is_used_itself():
    mapping = loaded(
        emitted(
            HEAD.replace("path:", "imports: from: fractions import: Fraction\npath:")
            + "parameter: half\ncode:\nstr(Fraction(2, 4))\n"
        )
    )
    assert fields(mapping, {}) == {"half": "1/2"}


def test_an_import_that_the_deployment_does_not_allow_is_refused_and_nothing_stands_in():
    mapping = emitted(HEAD.replace("path:", "imports: from: socket import: socket\npath:"))
    with pytest.raises(Exception, match="does not allow mappings to import socket"):
        loaded(mapping, allowed_imports=("math",))
    loaded(mapping, allowed_imports=("socket",))


# --- original bundles ---


@pytest.mark.corpus
def test_the_papers_navigation_hears_its_topic(corpus: Path):
    for bundle in ("paper-example-sdl", "paper-example-json"):
        mapping = original(corpus, bundle, "navigate")
        place = {"oDesiredLocation": {"x": 1.0, "y": 2.0, "z": 0.0}}
        assert fields(mapping, place) == {"goal": {"x": 1.0, "y": 2.0, "z": 0.0}}
        reached = [("/rosout", {"msg": "Goal reached"}), ("/rosout", {"msg": "idle"})]
        assert observed(mapping, place, reached, {"success": True}).response == "eSuccess"
        assert observed(mapping, place, [], {"success": True}).response == "eFailed"
        assert observed(mapping, place, reached, {"success": False}).response == "eFailed"


@pytest.mark.corpus
def test_the_original_armadillo_drives_to_a_low_level_constant(corpus: Path):
    mapping = original(corpus, "armadillo-finer", "navigate")
    parameters = {
        "oDesiredLocation": {"discrete_location": "eCorridor", "actual_location": "___locationCorridor"}
    }
    assert fields(mapping, parameters) == {"goal": {"x": 5.641, "y": 1.576, "z": 0.0}, "yaw": -2.779}
    assert observed(mapping, parameters, [], {"success": True}).response == "eSuccess"


@pytest.mark.corpus
def test_the_board_of_tic_tac_toe_is_answered_as_text(corpus: Path):
    for bundle, skill in (("tic-tac-toe-sdl", "detect"), ("tic-tac-toe-json", "detect_board_state")):
        mapping = original(corpus, bundle, skill)
        assert observed(mapping, {}, [], {"state": "??X?O????"}).response == "??X?O????"
