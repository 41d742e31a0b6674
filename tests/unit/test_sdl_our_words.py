import pytest

from aos_language.findings import Findings
from aos_language.reading.document import Document
from aos_language.reading.files import read_documents
from aos_protocol.documents import AbstractionMapping, Environment, LowLevelDocument, SkillModel

HEADS = {
    "p.ef": "project: p\nhorizon: 3\n",
    "s.sd": "project: p\ndynamic_model:\n__reward = 1;\n",
    "s.am": "project: p\nmodule_activation: skill\npath: /s\n",
    "p.lf": "project: p\n",
}


def read(name: str, text: str) -> tuple[Document | None, list[str]]:
    findings = Findings()
    document = read_documents({name: (HEADS[name] + text).encode()}, findings).get(name)
    first = HEADS[name].count("\n")
    return document, [f"{f.span.line - first}:{f.span.column} {f.code}" for f in findings.sorted()]


def content_of(name: str, text: str) -> object:
    document, findings = read(name, text)
    assert findings == []
    assert document is not None
    return document.content


def test_a_section_holds_a_body_and_assignments():
    text = """initial_belief:
int n = 1;
assignment: draw it
temporary_variable: enum Ending { Good, Bad } ending
loop_previous: Cup each
loop_condition: each.is_full;
loop_next: Cup other
loop_body:
other.is_full = false;
code:
ending = Good;
assignment:
temporary_variable: Bool late
"""
    document, findings = read("p.ef", text)
    assert findings == ["13:21 AOS127"]
    assert isinstance(document.content, Environment)
    body, draw, late = document.content.initial_belief
    assert body.code.code == "int n = 1;"
    assert draw.name == "draw it"
    assert (draw.temporary.enum_name, draw.temporary.enum_values) == ("Ending", ("Good", "Bad"))
    assert draw.over_previous[0].condition.code == "each.is_full"
    assert draw.over_next[0].body.span.line == 11
    assert (late.name, late.temporary.type) == ("", "bool")


def test_an_environment_has_conditions_defaults_keys_and_low_level_types():
    text = """one_state_model: true
define_type: Cup
variable: anyValue handle of Pose
variable: anyValue lid of Pose false
state_variable: anyValue where of Pose
state_variable: anyValue places [] of Pose
state_variable: int grid[]
state_variable: int poured
key_types: Water, ( 0, 3, 1 )
default_value: 3;
special_state:
state_condition: state.poured > 3
reward: -2.5
is_goal_state: true
is_one_time_reward: true
print_code:
ss << state.poured;
"""
    environment = content_of("p.ef", text)
    assert isinstance(environment, Environment)
    assert environment.is_one_state_model
    handle, lid = environment.compounds[0].fields
    assert (handle.low_level_type, handle.default) == ("Pose", None)
    assert (lid.low_level_type, lid.default.code) == ("Pose", "false")
    where, places, grid, poured = environment.variables
    assert (where.low_level_type, where.is_array) == ("Pose", False)
    assert (places.low_level_type, places.is_array) == ("Pose", True)
    assert grid.is_array
    assert poured.key_types == ("Water", "( 0, 3, 1 )")
    assert poured.default_value.code == "3"
    (special,) = environment.special_states
    assert (special.reward, special.is_goal, special.is_one_time) == (-2.5, True, True)
    assert len(environment.print_state) == 1


def test_skills_mappings_and_low_level_files_have_theirs():
    skill = content_of(
        "s.sd", "execution_time:\n__moduleExecutionTime = 3;\nstate_given_observation:\nx();\n"
    )
    assert isinstance(skill, SkillModel)
    assert (len(skill.execution_time), len(skill.state_given_observation)) == (1, 1)
    heavy = "local_variable: map\ntopic: /map\nis_heavy_variable: true\ncode:\nreturn __input\n"
    mapping = content_of("s.am", heavy)
    assert isinstance(mapping, AbstractionMapping)
    assert mapping.local_variables[0].is_heavy
    text = "define_type: Pose\nvariable: float x\n"
    text += "constant: Pose ___home\ncode:\n  ___home.x = 1\n  ___home.y = 2\n"
    low_level = content_of("p.lf", text)
    assert isinstance(low_level, LowLevelDocument)
    assert low_level.types[0].fields[0].type == "float"
    assert low_level.constants[0].code.code == "___home.x = 1\n___home.y = 2"


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("p.ef", "one_state_model: perhaps\n", ["1:18 AOS106"]),
        ("p.ef", "initial_belief:\nloop_body:\nx();\n", ["2:1 AOS104"]),
        ("p.ef", "initial_belief:\nloop_next: Cup\n", ["2:12 AOS104"]),
        ("p.ef", "initial_belief:\nloop_next: Cup a-b\n", ["2:16 AOS126"]),
        ("p.ef", "initial_belief:\ntemporary_variable:\n", ["2:1 AOS104"]),
        ("p.ef", "initial_belief:\ntemporary_variable: enum E { } e\n", ["2:29 AOS105"]),
        ("p.ef", "initial_belief:\ntemporary_variable: enum E { A, 2 } e\n", ["2:33 AOS126"]),
        ("p.ef", "initial_belief:\nassignment: a\nx();\n", ["3:1 AOS104"]),
        ("p.ef", "special_state:\nreward: 1\n", ["1:1 AOS105"]),
        ("p.ef", "special_state:\nstate_condition: state.x\n", ["1:1 AOS105"]),
        ("p.ef", "special_state:\nstate_condition: state.x\nreward: much\n", ["3:9 AOS106"]),
        ("p.ef", "state_variable: int x\nkey_types: (0,3)\n", ["2:12 AOS104"]),
        ("p.ef", "state_variable: int x\ndefault_value: 1\ncode:\nstate.x = 2;\n", ["3:1 AOS106"]),
        ("p.ef", "state_variable: int x of Pose\n", ["1:23 AOS104"]),
        ("p.ef", "define_type: T\nvariable: int x[3]\n", ["2:16 AOS104"]),
        ("p.ef", "constant: Pose home\n", ["1:1 AOS102"]),
        ("s.sd", "special_state:\n", ["1:1 AOS102"]),
        ("p.lf", "define_type:\n", ["1:1 AOS105"]),
        ("p.lf", "define_type: Pose\nvariable: x\n", ["2:11 AOS104"]),
        ("p.lf", "constant: Pose home\n", ["1:1 AOS105"]),
        ("p.lf", "constant: home\ncode:\nhome = 1\n", ["1:11 AOS104"]),
    ],
)
def test_what_is_wrong_is_told_where_it_stands(name, text, found):
    assert read(name, text)[1] == found
