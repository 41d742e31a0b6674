import json

import pytest
from dialects import say_the_same
from mapping_runs import loaded, observed
from projects import files_project

from aos_language.load import load_files
from aos_language.outline import outline
from aos_middleware.mappings.revisions import emit_project
from aos_middleware.workers.worker import LoadedMapping

SHARED = """import math

LIMIT_RAD = 0.2
NAMES = {"l": "left", "r": "right"}

def is_left(bearing_rad):
    # Far enough to the left.
    return bearing_rad > LIMIT_RAD / (1 + math.fabs(0))

def unused_by_step(text):
    return NAMES[text]"""
FILES = {
    "barn.ef": f"""project: barn
horizon: 4
shared_mapping_code:
{SHARED}
state_variable: int at
reward_code:
if (state.at > 0) __reward = 1;
""",
    "look.sd": "project: barn\ndynamic_model:\n__moduleResponse = state.at > 0 ? left : right;\n",
    "look.am": """project: barn
response: left
response_rule: is_left(bearing_rad)
response: right
response_rule: True
module_activation: skill
path: /look
local_variable: bearing_rad
from_ros_service_response: true
code:
bearing_rad = __input.bearing_rad
""",
    "ask.sd": 'project: barn\ndynamic_model:\n__moduleResponseStr = state.at > 0 ? "left" : "right";\n',
    "ask.am": """project: barn
response_local_variable: name
module_activation: skill
path: /ask
local_variable: name
from_ros_service_response: true
code:
name = unused_by_step(__input.text)
""",
    "step.sd": "project: barn\ndynamic_model:\nstate__.at += 1;\n",
}


def files(change: str = "") -> dict[str, bytes]:
    old, _, new = change.partition(" -> ")
    assert any(old in text for text in FILES.values())
    return {name: text.replace(old, new, 1).encode() for name, text in FILES.items()}


def running(skill: str, change: str = "") -> LoadedMapping:
    return loaded(
        next(mapping for mapping in emit_project(files_project(files(change))) if mapping.skill == skill)
    )


def test_all_mappings_call_the_functions_and_know_the_constants():
    look = running("look")
    assert observed(look, {}, [], {"bearing_rad": 0.3}).response == "left"
    assert observed(look, {}, [], {"bearing_rad": 0.1}).response == "right"
    assert observed(running("ask"), {}, [], {"text": "l"}).response == "left"


def test_only_mappings_that_use_it_have_it_and_its_lines_are_the_documents():
    look, step = (
        next(mapping for mapping in emit_project(files_project(files())) if mapping.skill == name)
        for name in ("look", "step")
    )
    lines = look.python.split("\n")
    at = lines.index("    return bearing_rad > LIMIT_RAD / (1 + math.fabs(0))") + 1
    assert str(look.locate(at, 12)) == "barn.ef:11:12"
    assert "LIMIT_RAD" not in step.python


def test_all_dialects_say_the_same():
    assert "shared code of the mappings" in outline(files_project(files()))
    as_json, _ = say_the_same(files())
    assert json.loads(as_json["environment.ef.json"])["SharedMappingCode"] == SHARED.split("\n")


@pytest.mark.parametrize(
    ("change", "code", "place"),
    [
        ("return NAMES[text] -> return NAMES[txt]", "AOS110", "barn.ef:14:18"),
        (
            "is_left(bearing_rad)\nresponse: right -> is_lefft(bearing_rad)\nresponse: right",
            "AOS110",
            "look.am:3:16",
        ),
        *(
            (f"is_left(bearing_rad)\nresponse: right -> {call}\nresponse: right", "AOS110", "look.am:3:16")
            for call in ("is_left()", "is_left(bearing_rad, 3)", "is_left(angle=bearing_rad)")
        ),
        ("    return NAMES[text] ->     return NAMES[text", "AOS121", "barn.ef:14:17"),
        ("    return NAMES[text] ->     NAMES.update(l=text)\n    return text", "AOS121", "barn.ef:14:5"),
        ("    return NAMES[text] ->     NAMES[text] = text\n    return text", "AOS121", "barn.ef:14:5"),
        ("    return NAMES[text] ->     global NAMES\n    return NAMES[text]", "AOS121", "barn.ef:14:5"),
        ("LIMIT_RAD = 0.2 -> LIMIT_RAD = 0.2\nOTHER = 3", "AOS133", "barn.ef:7:1"),
        ("LIMIT_RAD = 0.2 -> LIMIT_RAD = 0.2\ndef observe(x):\n    return x", "AOS126", "barn.ef:7:1"),
    ],
)
def test_a_mistake_is_told_at_its_place(change, code, place):
    places = [(finding.code, str(finding.span)) for finding in load_files(files(change)).diagnostics]
    assert (code, place) in places
    assert {found_code for found_code, _ in places} <= {code, "AOS139"}
