from pathlib import Path

import pytest
from dialects import say_the_same
from projects import text_project
from texts import encoded, write_texts

from aos_deploy.bundles.files import project_of
from aos_deploy.deployment.reading import read_deploy_file
from aos_language.load import load_files
from aos_language.mission_parameters import mission_value_of_option, parameter_leaves, usable_values
from aos_language.outline import outline
from aos_protocol.documents import StateVariable
from aos_protocol.errors import DeployError, DocumentError, PlanningError
from aos_solver.child.questions.asking import parameter_arguments
from aos_solver.offline.alpha_vectors import AlphaVectors
from aos_solver.offline.policy import Policy, PolicyHeader

SDL = """project: home
horizon: 4

define_type: Person
enum_members: alice, bob, carol

define_type: Spot
variable: double x_m 1.5
variable: Person near bob
variable: int log []

state_variable: Person holder

mission_parameter: Person target
default_value: bob

mission_parameter: Spot dock

mission_parameter: bool wanted [Person]
default_value: true

mission_parameter: int count
code:
state.count = 3;

mission_parameter: string word

reward_code:
if (state.holder == state.target && state.wanted[alice] && state.count > 0) __reward = state.dock.x_m;
if (state.word == "so") __isGoalState = true;
"""
SKILL = "project: home\n\ndynamic_model:\n__reward = -1;\n__moduleResponse = done;\n"
FILES = {"home.ef": SDL, "act.sd": SKILL}


def said(variable: StateVariable) -> tuple[object, ...]:
    value, code = variable.default_value, variable.default_code
    texts = (value.code if value else None, code.code if code else None)
    return variable.name, variable.type, variable.index_enum, variable.is_mission_parameter, *texts


def test_every_dialect_declares_the_same_parameters():
    say_the_same(encoded(FILES))
    variables = text_project(FILES).environment.variables
    assert [said(variable) for variable in variables] == [
        ("holder", "Person", "", False, None, None),
        ("target", "Person", "", True, "bob", None),
        ("dock", "Spot", "", True, None, None),
        ("wanted", "bool", "Person", True, "true", None),
        ("count", "int", "", True, None, "state.count = 3;"),
        ("word", "string", "", True, None, None),
    ]


def test_what_is_read_of_a_bundle_shows_parameters_with_type_and_default():
    shown = outline(text_project(FILES))
    assert "mission parameter Person target = bob " in shown
    assert "mission parameter bool[Person] wanted = true " in shown


MISTAKES = {
    "mission_parameter: int log []": ("AOS106", "nobody could set a value for the mission parameter log"),
    "mission_parameter: vector<int> log": ("AOS106", "nobody could set a value"),
    "mission_parameter: anyValue pose": ("AOS106", "nobody could set a value"),
    "mission_parameter: int holder": ("AOS126", "`holder` is already the name of a variable"),
    "mission_parameter: bool lucky\ndefault_value: AOS.Bernoulli(0.5)": ("AOS124", "is drawn at random"),
    "mission_parameter: Person other\ndefault_value: state.holder": ("AOS124", "depends on `state.holder`"),
    "state_variable: int n\ncode:\nstate.n = 1;\nstate.count = 2;": ("AOS128", "count is written"),
    "initial_belief:\nstate.target = alice;": ("AOS128", "target is written in the initial belief"),
    "extrinsic_code:\nstate_.wanted[alice] = false;": ("AOS128", "wanted is written"),
    "extrinsic_code:\nstate_.dock.x_m += 1;": ("AOS128", "dock is written"),
    "shared_code:\nvoid f(auto& state_) { state_.count = 1; }\nextrinsic_code:\nf(state_);": (
        "AOS128",
        "count is written in shared code",
    ),
}


@pytest.mark.parametrize("declared", MISTAKES)
def test_a_mistake_with_a_parameter_is_told_in_its_line(declared):
    code, message = MISTAKES[declared]
    files = FILES | {"home.ef": f"{SDL}\n{declared}\n"}
    loaded = load_files(encoded(files))
    (found,) = [diagnostic for diagnostic in loaded.diagnostics if diagnostic.is_error]
    assert found.code == code
    assert message in found.message
    assert found.span.line > SDL.count("\n")


def test_a_variable_is_no_parameter_of_actions_and_of_missions_at_once():
    files, _ = say_the_same(encoded(FILES))
    one = b'"IsMissionParameter": true'
    environment = files["environment.ef.json"].replace(one, one + b', "IsActionParameterValue": true', 1)
    loaded = load_files(files | {"environment.ef.json": environment})
    assert [(d.code, d.is_error) for d in loaded.diagnostics] == [("AOS106", True)]


def test_a_local_variable_of_a_mapping_with_its_name_does_not_tell_it():
    mapping = (
        "project: home\n\nresponse: done\nresponse_rule: count > 0\n\nmodule_activation: skill\n"
        "path: /act\n\nlocal_variable: count\ntype: int\nfrom_ros_service_response: true\ncode:\n"
        "count = __input.count\n"
    )
    loaded = load_files(encoded(FILES | {"act.am": mapping}))
    assert [d.code for d in loaded.diagnostics if d.code in ("AOS128", "AOS134")] == []


def values(*options: str) -> dict[str, str]:
    leaves = parameter_leaves(text_project(FILES).environment)
    return usable_values([mission_value_of_option(option) for option in options], leaves)


def test_values_have_one_spelling_and_the_last_counts():
    found = values(
        "target=alice", "dock.x_m=.5", "dock.near=carol", "wanted[bob]=false", "wanted.carol=true",
        "count=+07", "word= so ", "target=carol",
    )  # fmt: skip
    assert found == {
        "target": "carol",
        "dock.x_m": "0.5",
        "dock.near": "carol",
        "wanted[bob]": "false",
        "wanted[carol]": "true",
        "count": "7",
        "word": " so ",
    }


def test_an_engine_gets_them_as_the_numbers_of_a_saved_state():
    leaves = parameter_leaves(text_project(FILES).environment)
    found = parameter_arguments(leaves, values("target=carol", "wanted.bob=true", "count=-2", "word=ab"))
    assert found == ("target=2", "wanted[bob]=1", "count=-2", "word=2 97 98")


@pytest.mark.parametrize(
    ("option", "says"),
    [
        ("targt=alice", "unknown mission parameter `targt`. Did you mean `target`?"),
        ("holder=alice", "unknown mission parameter `holder`. The mission parameters are `target`, "),
        ("target=caro", "target cannot be 'caro': it is one of alice, bob, carol. Did you mean `carol`?"),
        ("dock=2", "dock has parts, which are set one by one. They are `dock.x_m`, `dock.near`"),
        ("wanted[dave]=true", "unknown mission parameter `wanted[dave]`. Did you mean `wanted["),
        ("dock.log=2", "unknown mission parameter `dock.log`"),
        ("count=2.5", "count cannot be '2.5': it is a whole number of 32 bits"),
        ("count=2147483648", "count cannot be '2147483648'"),
        ("dock.x_m=nan", "dock.x_m cannot be 'nan': it is a number"),
        ("wanted.bob=yes", "wanted[bob] cannot be 'yes': it is true or false"),
        (f"word={'x' * 63}", "word cannot be"),
        ("target", "'target' sets no mission parameter. Write it as --set target=alice"),
    ],
)
def test_what_cannot_be_set_is_told_with_the_nearest_name(option, says):
    with pytest.raises(DocumentError) as caught:
        values(option)
    assert caught.value.code == "AOS146"
    assert f"{caught.value.message}. {caught.value.hint}".startswith(says)


DEPLOY = """aos: 1
robot: home
bundles: [home]
mission:
  set:
    target: carol
    dock: {x_m: 2, near: alice}
    wanted: {bob: false}
bind: {"*": model}
"""


@pytest.fixture
def deploy_file(tmp_path) -> Path:
    (tmp_path / "home").mkdir()
    write_texts(FILES, tmp_path / "home")
    path = tmp_path / "home.yaml"
    path.write_text(DEPLOY)
    return path


def test_a_deploy_file_sets_parts_by_mappings(deploy_file: Path):
    given = project_of(read_deploy_file(deploy_file)).mission_values
    assert {value.name: value.text for value in given} == {
        "target": "carol",
        "dock.x_m": "2",
        "dock.near": "alice",
        "wanted.bob": "false",
    }


def test_documents_that_only_play_the_world_need_not_have_a_parameter(deploy_file: Path):
    documents = deploy_file.with_name("home") / "home.ef"
    documents.write_text(documents.read_text().replace("target", "whom"))
    deployment = read_deploy_file(deploy_file)
    with pytest.raises(DeployError):
        project_of(deployment)
    names = [value.name for value in project_of(deployment, plays_world=True).mission_values]
    assert names == ["dock.x_m", "dock.near", "wanted.bob"]


@pytest.mark.parametrize(
    ("before", "after", "code", "place"),
    [
        ("target: carol", "target: carl", "AOS146", "6:13"),
        ("near: alice", "naer: alice", "AOS146", "7:26"),
        ("target: carol", "target: [carol]", "AOS106", "6:13"),
    ],
)
def test_a_wrong_value_of_a_deploy_file_is_told_where_it_stands(
    deploy_file: Path, before, after, code, place
):
    deploy_file.write_text(DEPLOY.replace(before, after))
    with pytest.raises(DeployError) as caught:
        project_of(read_deploy_file(deploy_file))
    (found,) = caught.value.diagnostics
    assert found.code == code
    assert str(found.span).endswith(f"home.yaml:{place}")


def test_a_policy_is_for_the_values_that_it_was_solved_with():
    header = PolicyHeader(
        model="home", model_digest="d", discount=0.9, lower=0, upper=1, actions=("act",), states=("s",),
        mission_parameters={"target": "bob", "count": "3"},
    )  # fmt: skip
    policy = Policy(header, AlphaVectors.of_bytes(1, (), b""))
    policy.check_model("d", {"target": "bob", "count": "3"})
    with pytest.raises(
        PlanningError, match="solved for target = bob, and this mission has target = carol"
    ) as it:
        policy.check_model("d", {"target": "carol", "count": "3"})
    assert (it.value.code, it.value.hint) == ("AOS322", "Solve it with aos solve --set target=carol")
