import json

import pytest
from mapping_runs import fields, loaded, observed
from mappings import mapping_text
from projects import files_project
from texts import encoded

from aos_deploy.adapter_templates import adapter_files
from aos_editor.symbols import read_bundle
from aos_language.convert import Dialect, convert, without_origins
from aos_language.load import LoadedBundle, load_files
from aos_language.outline import outline
from aos_middleware.activations.activation import no_response
from aos_middleware.emission.emit import emit_mapping
from aos_middleware.workers.worker import LoadedMapping
from aos_protocol.documents import AbstractionMapping, Project

ENVIRONMENT = """project: barn
horizon: 4
define_type: Side
enum_members: Left, Right
state_variable: Side at
action_parameter: Side left
code:
state.left = Left;
initial_belief:
state.at = AOS.Bernoulli(0.5) ? Left : Right;
reward_code:
if (state.at == Left) __reward = 1;
"""
LOOK = """project: barn
parameter: Side side
dynamic_model:
bool sees = AOS.Bernoulli(0.8) == (state.at == side);
__moduleResponse = sees ? seen : unseen;
"""
LOOK_JSON = {
    "GlobalVariableModuleParameters": [{"Name": "side", "Type": "Side"}],
    "DynamicModel": {
        "NextStateAssignments": [{"AssignmentCode": LOOK.split("dynamic_model:\n")[1].splitlines()}]
    },
}


def loaded_files(look: str = LOOK, **more: str) -> LoadedBundle:
    texts = {"barn.ef": ENVIRONMENT, "look.sd": look} | {name.replace("_", "."): more[name] for name in more}
    return load_files(encoded(texts))


def project_of(look: str = LOOK) -> Project:
    bundle = loaded_files(look)
    assert bundle.project is not None, bundle.diagnostics
    assert [finding for finding in bundle.diagnostics if finding.code != "AOS139"] == []
    return bundle.project


def mapping_of(look: str) -> AbstractionMapping:
    return project_of(look).skills[0].mapping


def running(look: str = LOOK) -> LoadedMapping:
    return loaded(emit_mapping(project_of(look).skills[0]))


def responses(model: str) -> list[str]:
    return [rule.response for rule in mapping_of(f"project: barn\ndynamic_model:\n{model}\n").rules]


def test_the_call_has_the_skills_name_and_its_parameters_and_the_result_the_response():
    assert mapping_of(LOOK).activation.path == "/look"
    mapping = running()
    assert fields(mapping, {"side": "Left"}) == {"side": "Left"}
    for response in ("seen", "unseen"):
        assert observed(mapping, {"side": "Left"}, [], {"response": response}).response == response
    for result in ({"response": "sen"}, {"success": True}, {}):
        assert observed(mapping, {"side": "Left"}, [], result).response is None


@pytest.mark.parametrize(("head", "kind"), [("PlpMain", "PLP"), ("GsdlMain", "GSDL")])
def test_the_json_dialects_derive_the_same(head, kind):
    document = {head: {"Project": "barn", "Name": "look", "Type": kind}, **LOOK_JSON}
    bundle = load_files({"barn.ef": ENVIRONMENT.encode(), "look.json": json.dumps(document).encode()})
    assert bundle.project is not None, bundle.diagnostics
    assert without_origins(bundle.project.skills) == without_origins(project_of().skills)


def test_responses_are_the_names_that_can_become_the_response():
    assert responses("__moduleResponse = done;") == ["done"]
    assert responses("__moduleResponse = state.at == Left ? (state__.at == Left ? a : b) : c;") == [
        "a",
        "b",
        "c",
    ]
    assert responses("auto told = missed;\nif (state.at == Left) told = hit;\n__moduleResponse = told;") == [
        "missed", "hit",
    ]  # fmt: skip
    assert responses("int told[] = {left, right};\n__moduleResponse = told[state.at];") == ["left", "right"]
    assert responses("if (state.at == Left) __moduleResponse = here; else __moduleResponse = gone;") == [
        "here", "gone",
    ]  # fmt: skip


def test_a_skill_that_reports_nothing_needs_no_response():
    mapping = running("project: barn\ndynamic_model:\nstate__.at = Left;\n")
    assert observed(mapping, {}, [], {}).response == "DefaultObservation"


def test_a_text_response_and_reported_numbers_come_from_the_result_too():
    mapping = running('project: barn\ndynamic_model:\n__moduleResponseStr = state.at == Left ? "l" : "r";\n')
    assert observed(mapping, {}, [], {"response": "l"}).response == "l"
    model = "__moduleResponse = told;\n__observed.bearing = AOS.SampleNormal(state.at, 1.0);"
    mapping = running(f"project: barn\ndynamic_model:\n{model}\n")
    found = observed(mapping, {}, [], {"response": "told", "bearing": 0.25})
    assert (found.response, found.local_variables["bearing"]) == ("told", "0.25")


@pytest.mark.parametrize("name", ["response", "request", "from", "from_", "parameters"])
def test_a_parameter_may_have_a_name_that_the_mapping_needs(name):
    mapping = running(LOOK.replace("side", name))
    assert fields(mapping, {name: "Left"}) == {name: "Left"}
    assert observed(mapping, {name: "Left"}, [], {"response": "seen"}).response == "seen"


def test_a_result_that_brings_no_response_is_told_with_its_reason():
    mapping = mapping_of(LOOK)
    missing = no_response(mapping, {"success": True}, {})
    assert "the result of /look has no `response`: it has `success`" in missing.message
    assert "one of `seen`, `unseen`" in missing.hint
    unknown = no_response(mapping, {"response": "sen"}, {})
    assert (unknown.code, unknown.hint) == ("AOS402", "Did you mean `seen`?")
    assert "'sen', which look does not know" in unknown.message
    assert str(unknown.diagnostics[0].span) == "look.sd:5:27"


def test_a_mapping_that_has_no_skill_is_told_once_with_the_name_that_was_meant():
    mapping = mapping_text(project="barn", skill="look")
    bundle = loaded_files(lok_am=mapping)
    (told,) = [finding for finding in bundle.diagnostics if finding.is_error]
    assert (told.code, told.span.file, told.hint) == ("AOS114", "lok.am", "Did you mean `look`?")
    assert told.message.endswith("has no skill document, and the skill look has no mapping")


def test_a_mapping_that_cannot_be_read_is_not_replaced():
    bundle = loaded_files(look_am="project: barn\npath: /look\n")
    assert {finding.span.file for finding in bundle.diagnostics if finding.is_error} == {"look.am"}


@pytest.mark.parametrize(
    ("model", "code", "place"),
    [
        ("bool sees = true;\n__moduleResponse = seees ? seen : unseen;", "AOS110", "look.sd:4:20"),
        ("__moduleResponse = state.at;", "AOS114", "look.sd:3:1"),
    ],
)
def test_what_no_response_can_be_read_from_is_an_error(model, code, place):
    bundle = loaded_files(f"project: barn\ndynamic_model:\n{model}\n")
    assert [(finding.code, str(finding.span)) for finding in bundle.diagnostics if finding.is_error] == [
        (code, place)
    ]


def test_it_is_shown_and_not_converted_and_a_template_answers_it(tmp_path):
    project = project_of()
    shown = outline(project)
    assert "activation: skill /look(side=side)" in shown
    assert "derived: no abstraction mapping is written" in shown
    environment = ENVIRONMENT.replace("action_parameter: Side left\ncode:\nstate.left = Left;\n", "")
    files = {"barn.ef": environment.encode(), "look.sd": LOOK.encode()}
    texts, findings = convert(files, Dialect.JSON)
    assert (set(texts), findings) == ({"environment.ef.json", "look.sd.json"}, ())
    made = adapter_files("python", project, "barn")
    assert "async def look(call: Call, side: Any)" in made["barn_robot.py"]
    assert "return {'response': 'seen'}" in made["barn_robot.py"]
    at = "__input.pose.at"
    code = f"sum(e.m for e in __input.echoes) + {at}.find(1) + {at}.x"
    written = (
        mapping_text("seen", "unseen", project="barn", skill="look").replace("__input.answer", code).encode()
    )
    made = adapter_files("python", files_project({**files, "look.am": written}), "barn")
    assert "return {'echoes': [], 'pose': {'at': {'x': ''}}}" in made["barn_robot.py"]
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    bundle = read_bundle(tmp_path, {})
    response = bundle.at("look.sd", 5, 27)
    assert response.is_declaration
    assert str(response.span) == "look.sd:5:27"


def test_a_type_with_a_name_of_cpp_is_told_where_it_stands_and_not_in_code_that_nobody_wrote():
    environment = ENVIRONMENT.replace("action_parameter: Side left\ncode:\nstate.left = Left;\n", "")
    files = {"barn.ef": environment.replace("Side", "class").encode()}
    files["look.sd"] = b"project: barn\nparameter: class side\n"
    found = load_files(files).diagnostics
    assert "AOS126" in {each.code for each in found}
    assert "AOS108" not in {each.code for each in found}


@pytest.mark.parametrize(
    "code",
    [
        "const auto t = std::vector{seen, unseen}; __moduleResponse = t[state.at];",
        "auto say = [&](int k) { return k == 1 ? seen : unseen; }; __moduleResponse = say(state.at);",
        "int t[2]; t[0] = seen; t[1] = unseen; __moduleResponse = t[state.at];",
        "vector<int> t; t.push_back(seen); t.push_back(unseen); __moduleResponse = t.at(state.at);",
        "map<Side, int> t{{Left, seen}, {Right, unseen}}; __moduleResponse = t[state.at];",
    ],
)
def test_responses_are_found_in_what_the_response_is_taken_out_of(code):
    look = LOOK.partition("dynamic_model:\n")[0] + f"dynamic_model:\n{code}\n"
    assert [rule.response for rule in mapping_of(look).rules] == ["seen", "unseen"]
