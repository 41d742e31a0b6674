import pytest
from texts import encoded

from aos_language.load import LoadedBundle, load_files
from aos_language.local_types import LocalType, local_type
from aos_protocol.diagnostics import Severity

ENVIRONMENT = """project: rover
horizon: 3
define_type: Spot
variable: anyValue pose of Pose
variable: int number
state_variable: float charge
state_variable: bool is_here
state_variable: int count
action_parameter: Spot base
reward_code:
if (state.count > 3) { __reward = 1; __isGoalState = true; }
"""
SKILL = """project: rover
parameter: Spot to

dynamic_model:
state__.is_here = state.count == 0 && state.charge > 0;
__moduleResponse = arrived;
state_given_observation:
int old = state__.count;
state___.is_here = {told};
"""
MAPPING = """project: rover
response: arrived
response_rule: True
{assignment}
module_activation: skill
path: /drive
parameter: goal
code:
to
local_variable: to
action_parameter: to
local_variable: reached
{type}
from_ros_service_response: true
code:
reached = __input.reached
local_variable: charge
type: float
from_ros_service_response: true
code:
charge = __input.charge
"""


def bundle(response: str = "reached", type_line: str = "type: bool", assignment: str = "") -> LoadedBundle:
    files = {
        "rover.ef": ENVIRONMENT,
        "rover.lf": "project: rover\ndefine_type: Pose\nvariable: float x\n",
        "drive.sd": SKILL.format(told=response),
        "drive.am": MAPPING.format(assignment=assignment, type=type_line),
    }
    return load_files(encoded(files))


def findings(response: str = "reached", type_line: str = "type: bool", assignment: str = "") -> list[str]:
    """All that is wrong with the bundle; what tells a state variable by its name is not."""
    loaded = bundle(response, type_line, assignment)
    return [
        f"{finding.span}: {finding.code} {finding.message}"
        for finding in loaded.diagnostics
        if finding.code != "AOS134"
    ]


def test_what_model_code_uses_or_what_tells_a_state_variable_is_not_unused():
    assert findings() == []


def test_a_local_variable_that_tells_a_state_variable_by_its_name_is_remarked():
    (remark,) = bundle().diagnostics
    assert (remark.severity, remark.code, str(remark.span)) == (Severity.REMARK, "AOS134", "drive.am:17:17")
    assert "the state variable charge" in remark.message


def test_a_local_variable_that_nothing_uses_is_told_still():
    assert findings(response="true") == [
        "drive.am:12:17: AOS133 no rule and no field uses the local variable reached"
    ]


@pytest.mark.parametrize(("type_line", "kind"), [("", "no type"), ("type: anyValue", "the type anyValue")])
def test_model_code_cannot_use_a_local_variable_without_a_type_of_cpp(type_line, kind):
    message = f"the local variable `reached` has {kind}, so model code cannot use it"
    assert findings(type_line=type_line) == [f"drive.sd:9:20: AOS110 {message}"]


def test_the_copies_that_a_step_makes_in_between_are_not_there():
    (finding,) = findings(response="reached && state_.is_here")
    assert finding.startswith("drive.sd:9:31: AOS123 there is no `state_` in the state given the observation")


def test_the_state_before_the_step_cannot_be_written():
    (finding,) = findings(response="reached; state__.count = 1")
    assert "AOS123 `state__.count` is written in the state given the observation" in finding


@pytest.mark.parametrize("path", ["to.pose", "base.pose", "state.base.pose"])
def test_a_rule_may_give_a_value_to_any_anyvalue(path):
    assert findings(assignment=f"assign_variable: {path}\nvalue: [reached]") == []


@pytest.mark.parametrize(
    ("assignment", "finding"),
    [
        ("assign_variable: too.pose\nvalue: 1", "drive.am:4:18: AOS110 there is no parameter and no state"),
        ("assign_variable: to.poses\nvalue: 1", "drive.am:4:18: AOS110 the type Spot has no field `poses`"),
        ("assign_variable: to.number\nvalue: 1", "drive.am:4:18: AOS110 `to.number` is no anyValue, but int"),
        ("assign_variable: to.pose\nvalue: 1 +", "drive.am:5:11: AOS121 this is not Python"),
        ("assign_variable: to.pose", "drive.am:4:1: AOS105 the low-level assignment to to.pose has no value"),
        ("assign_variable: to.pose\nvalue: seen", "drive.am:5:8: AOS110 no local variable gives `seen`"),
    ],
)
def test_a_mistake_in_a_low_level_assignment_is_told_at_its_place(assignment, finding):
    (found,) = findings(assignment=assignment)
    assert found.startswith(finding)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("int", LocalType("int")),
        ("std::string", LocalType("string")),
        ("float[]", LocalType("float", is_array=True)),
        ("std::vector< bool >", LocalType("bool", is_array=True)),
        ("vector<vector<int>>", None),
        ("anyValue", None),
        ("", None),
    ],
)
def test_the_types_that_model_code_can_see(text, kind):
    assert local_type(text) == kind
