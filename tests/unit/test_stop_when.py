from typing import Any

import pytest
from mapping_documents import emitted
from mapping_runs import HEAD, fields, loaded, raised

from aos_language.load import load_files
from aos_middleware.workers.frames import Raised, Take, Taken

ENVIRONMENT = b"""\
project: garden
horizon: 3
state_variable: bool is_done
code:
state.is_done = false;
reward_code:
if (state.is_done) { __reward = 1; __isGoalState = true; }
"""
MODEL = b"project: garden\ndynamic_model:\nstate__.is_done = true;\n__moduleResponse = seen;\n"
NEAR = """\
response: seen
response_rule: True
local_variable: near
topic: /near
message_type: Bool
code:
return __input.data
local_variable: found
from_ros_service_response: true
code:
found = __input.found
"""


def findings(stop_when: str, rule: str = "near or __skill_status == 'stopped' or found") -> list[str]:
    text = NEAR.replace("response_rule: True", f"response_rule: {rule}")
    mapping = f"{HEAD}stop_when: {stop_when}\n{text}"
    loaded_files = load_files({"g.ef": ENVIRONMENT, "look.sd": MODEL, "look.am": mapping.encode()})
    return [
        f"{finding.severity} {finding.code} {finding.span.line}:{finding.span.column} {finding.message}"
        for finding in loaded_files.diagnostics
    ]


@pytest.mark.parametrize(
    ("stop_when", "finding"),
    [
        ("naer", "error AOS110 4:12 no local variable gives `naer`"),
        ("near and found", 
         "error AOS110 4:21 `found` comes from the result, which is not there while the skill runs"),
        ("near or __skill_status", "error AOS110 4:20 no local variable gives `__skill_status`"),
        ("near &", "error AOS121 4:18 this is not Python: something is missing here"),
        ("3", "error AOS106 4:12 `stop_when` is neither True nor False: `3`"),
        ("near + 1", "error AOS106 4:12 `stop_when` is neither True nor False: `near + 1`"),
        ("-near", "error AOS106 4:12 `stop_when` is neither True nor False: `-near`"),
        ("[near]", "error AOS106 4:12 `stop_when` is neither True nor False: `[near]`"),
        ("False", "warning AOS118 4:12 `stop_when` never holds"),
        ("True",
         "warning AOS118 4:12 `stop_when` always holds: the first message on any topic stops the skill"),
        ("1 > 2", "warning AOS118 4:12 `stop_when` reads no topic, so no message changes whether it holds"),
        ("", "error AOS105 4:1 `stop_when:` has no expression"),
    ],
)  # fmt: skip
def test_what_can_be_told_from_the_document_is_told_at_its_place(stop_when, finding):
    assert findings(stop_when) == [finding]


def test_rules_that_look_at_the_result_alone_say_nothing_of_a_stop():
    (finding,) = findings("near", rule="found")
    assert finding.startswith("warning AOS116 4:12 no rule of look says what is observed")
    assert findings("near", rule="found or near") == []


def taken(stop_when: str, *messages: Any) -> list[Taken | Raised]:
    mapping = loaded(emitted(f"{HEAD}stop_when: {stop_when}\n{NEAR}"))
    fields(mapping, {})
    answers = [mapping.answer(Take([("/near", {"data": data})])) for data in messages]
    return [answer for answer in answers if isinstance(answer, Taken | Raised)]


def test_it_holds_once():
    assert [answer.stops for answer in taken("near", False, True, False, True)] == [False, True, False, False]


def test_of_several_messages_those_behind_the_one_that_stops_are_left():
    mapping = loaded(emitted(f"{HEAD}stop_when: near\n{NEAR}"))
    fields(mapping, {})
    messages = [("/near", {"data": data}) for data in (False, True, False)]
    assert mapping.answer(Take(messages)) == Taken(2, stops=True)
    assert mapping.answer(Take(messages[2:])) == Taken(1)
    fields(mapping, {})
    assert mapping.answer(Take(messages)) == Taken(2, stops=True)


def test_it_is_not_asked_before_each_topic_that_it_reads_has_a_value():
    far = "local_variable: far\ntopic: /far\nmessage_type: Level\ncode:\nreturn __input.data\n"
    mapping = loaded(emitted(f"{HEAD}stop_when: near and far > 1\n{NEAR}{far}"))
    fields(mapping, {})
    assert mapping.answer(Take([("/near", {"data": True})])) == Taken(1)
    assert mapping.answer(Take([("/far", {"data": 2})])) == Taken(1, stops=True)
    mapping = loaded(emitted(f"{HEAD}stop_when: near and far > 1\n{NEAR}{far}initial_value: 3\n"))
    fields(mapping, {})
    assert mapping.answer(Take([("/near", {"data": True})])) == Taken(1, stops=True)


def test_truth_values_of_numpy_are_some_and_what_is_none_is_an_error_at_its_place():
    array = "imports: from: numpy import: bool_\n"
    mapping = loaded(emitted(f"{HEAD}{array}stop_when: bool_(near)\n{NEAR}"))
    fields(mapping, {})
    assert mapping.answer(Take([("/near", {"data": True})])) == Taken(1, stops=True)
    emission = emitted(f"{HEAD}stop_when:\n(near\n    or near)\n{NEAR}")
    mapping = loaded(emission)
    answer = raised(mapping, Take([("/near", {"data": 3.5})]))
    assert answer.error == "TypeError: stop_when is 3.5, which is neither True nor False"
    assert str(emission.locate(answer.line, answer.column)) == "look.am:5:1"
