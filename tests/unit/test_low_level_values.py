from pathlib import Path
from typing import Any

from mapping_documents import emitted
from mappings import mapping_text
from projects import bundle_project, text_project
from texts import encoded

from aos_language.load import load_files
from aos_middleware.mappings.low_level import LowLevelValues, assigned_variables, default_constants
from aos_middleware.workers.frames import Begin, Begun, Finish, Load, Observed, Raised
from aos_middleware.workers.worker import LoadedMapping
from aos_protocol.diagnostics import Severity
from aos_protocol.messages import Activate, ActivationId, Outcome

GARDEN = {
    "garden.ef": """project: garden
horizon: 3
define_type: Spot
variable: anyValue pose of Pose ___origin
variable: int number
define_type: Bed
variable: Spot near
state_variable: anyValue home of Pose
default_value: ___origin
state_variable: Bed roses
action_parameter: Spot gate
code:
// The gate is elsewhere.
state.gate.number = 1; state.gate.pose = ___gate;
""",
    "garden.lf": """project: garden
define_type: Pose
variable: float x
define_type: Pose
variable: float x
constant: Pose ___origin
code:
___origin.x = 0.0
constant: Pose ___gate
code:
___gate.x = 4.0
""",
    "walk.sd": "project: garden\nparameter: Spot to\ndynamic_model:\n__moduleResponse = arrived;\n",
    "walk.am": mapping_text("arrived: True", project="garden", skill="walk"),
}
HEAD = """\
project: garden
module_activation: skill
path: /walk
parameter: x
code:
pose.x
local_variable: pose
action_parameter: to.pose
local_variable: seen
from_ros_service_response: true
code:
seen = __input.seen
"""


def request(variables: dict[str, str] | None = None) -> Activate:
    parameters: dict[str, Any] = {"to": {"pose": True, "number": 1}}
    return Activate(ActivationId("m", 1), "walk", parameters, 5.0, variables=variables or {})


def outcome(**assigned: Any) -> Outcome:
    values = {path.replace("__", "."): value for path, value in assigned.items()}
    return Outcome(ActivationId("m", 1), "walk", "observed", "arrived", assigned=values)


def observed(
    mapping: LoadedMapping, value: Any, low_level: dict[str, Any] | None = None
) -> Observed | Raised:
    begun = mapping.answer(Begin({"to": {"pose": None}}, low_level or {"to.pose": {"x": 1.0}}))
    assert isinstance(begun, Begun), begun
    answer = mapping.answer(Finish({"seen": value}))
    assert isinstance(answer, Observed | Raised)
    return answer


def loaded(rules: str) -> LoadedMapping:
    mapping = emitted(HEAD + rules)
    return LoadedMapping(Load(mapping.python, mapping.file_name, 60.0, 60.0, None))


# --- where they begin ---


def test_they_begin_as_the_constants_that_types_and_variables_have_by_default():
    assert default_constants(text_project(GARDEN)) == {
        "home": "___origin",
        "roses.near.pose": "___origin",
        "gate.pose": "___gate",
    }


def test_a_field_that_a_low_level_type_has_not_is_a_warning_where_it_is_set():
    files = GARDEN | {"garden.lf": GARDEN["garden.lf"].replace("___gate.x", "___gate.z")}
    loaded = load_files(encoded(files))
    found = [f for f in loaded.diagnostics if "`z`" in f.message]
    assert [(f.code, f.severity, f.span.line, f.span.column) for f in found] == [
        ("AOS110", Severity.WARNING, 11, 9)
    ]
    assert loaded.project is not None


def test_the_original_armadillos_places_have_their_constants(corpus: Path):
    constants = default_constants(bundle_project(corpus / "armadillo-finer"))
    assert constants["locationCorridor.actual_location"] == "___locationCorridor"
    assert len(constants) == 3


def test_a_parameter_finds_the_value_of_the_variable_it_stands_for():
    constants = {"gate.pose": "___gate", "shed.pose": "___shed"}
    parameters, low_level = LowLevelValues().arguments(request({"to": "gate"}), constants)
    assert parameters == {"to": {"pose": "___gate", "number": 1}}
    assert low_level == {}


def test_a_computed_parameter_stands_for_no_variable_and_stays_as_it_is():
    parameters, _ = LowLevelValues().arguments(request(), {"gate.pose": "___gate"})
    assert parameters == request().parameters


# --- new ones ---


def test_what_a_response_gave_is_found_by_later_activations_and_after_a_restart():
    values = LowLevelValues([outcome(gate__pose={"x": 4.5}), outcome(shed__pose={"x": 9.0})])
    values.take(outcome(gate__pose={"x": 4.6}))
    _, low_level = values.arguments(request({"to": "gate"}), {})
    assert low_level == {"to.pose": {"x": 4.6}}


def test_a_path_may_start_with_a_parameter_or_with_a_state_variable():
    given = {"to.pose": 1, "shed.pose": 2, "state.home": 3}
    assert assigned_variables(given, request({"to": "gate"})) == {"gate.pose": 1, "shed.pose": 2, "home": 3}


def test_what_is_assigned_to_a_computed_parameter_is_dropped_with_a_warning(caplog):
    assert assigned_variables({"to.pose": 1}, request()) == {}
    assert "to stands for no state variable" in caplog.text


def test_only_the_rule_that_holds_gives_values():
    mapping = loaded(
        "response: near\nresponse_rule: seen < 2\nassign_variable: to.pose\nvalue: {'x': pose.x + seen}\n"
        "response: far\nresponse_rule: True\nassign_variable: home\nvalue: pose\n"
    )
    near, far = observed(mapping, 1), observed(mapping, 5)
    assert isinstance(near, Observed)
    assert isinstance(far, Observed)
    assert (near.response, near.assigned) == ("near", {"to.pose": {"x": 2.0}})
    assert (far.response, far.assigned) == ("far", {"home": {"x": 1.0}})


def test_a_value_that_cannot_be_kept_fails_at_its_place_in_the_document():
    rules = "response: near\nresponse_rule: True\nassign_variable: to.pose\nvalue: print\n"
    answer = observed(loaded(rules), 1)
    assert isinstance(answer, Raised)
    assert answer.error == "TypeError: a value of type builtin_function_or_method is no plain data"
    place = emitted(HEAD + rules).locate(answer.line, answer.column)
    assert place.line == HEAD.count("\n") + 4
