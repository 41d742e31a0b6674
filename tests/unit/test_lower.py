import pytest
from mappings import mapping_of_model, mapping_text
from msgspec.structs import replace
from projects import text_project
from scripted_models import json_text

from aos_protocol.diagnostics import Diagnostic
from aos_protocol.documents import Project
from aos_solver.emission.emit import emit
from aos_solver.emission.lowering.lower import lower
from aos_solver.emission.program import Program

HOME = """project: test
horizon: 3
discount: 0.9
define_type: Light
enum_members: Off, On
state_variable: Light lamp
state_variable: int count
code:
state.count = 4;
state_variable: int row []
code:
state.row = {1, 2};
state_variable: int total
"""
ALL = ["lamp", "count", "row", "total"]
ACT = "project: test\ndynamic_model:\n"


def project_of(act: str = "state__.total += state.count;", home: str = "", given: str = "") -> Project:
    skill = f"{ACT}{act}\n" + (f"state_given_observation:\n{given}\n" if given else "")
    return text_project({"home.ef": HOME + home, "act.sd": skill, "act.am": mapping_of_model(skill)})


def program_of(project: Project) -> Program:
    program, diagnostics = lower(project)
    assert program is not None, diagnostics
    return program


def particle_of(act: str, home: str = "") -> list[str]:
    return [variable.name for variable in program_of(project_of(act, home)).particle]


@pytest.mark.parametrize(
    ("act", "particle"),
    [
        ("state__.total = 1;", ["total"]),
        ("state__.lamp = On; state__.row[1] += 2;", ["lamp", "row"]),
        ("int& counted = state__.count; counted++;", ["count"]),
        ("for (auto& n = state__.total; auto& cell : state__.row) cell = n++;", ["row", "total"]),
        ("state__.row.at(state.count) = 1;", ["row"]),
        ("std::span<int> cells{state__.row}; cells[0]++;", ["row"]),
        ("std::vector<std::reference_wrapper<int>> all; all.push_back(state__.total);", ["total"]),
        ("auto sum = [&]() -> int& { return state__.total; }; sum() = 1;", ["total"]),
        ("auto sum = [](auto& all) -> auto& { return all.total; }; sum(state__) = 1;", ALL),
        ("sort(state__.row.begin(), state__.row.end());", ["row"]),
        ("auto set = [&](int& x) { x = 1; }; set(state__.total);", ["total"]),
        ("auto held = std::ref(state__.total); held.get() = 1;", ["total"]),
        ("int read = max(int(state__.count), 2) + std::pow(state__.total, 2);", []),
        ("auto& all = state__; all.total = 1;", ALL),
        ("auto set = [](auto& all, int x) { all.total = x; }; set(state__, 1);", ["total"]),
        ("auto set = [](auto& all) { auto& it = all; it.total = 1; }; set(state__);", ALL),
        ("int read = state__.count + state.total;", []),
    ],
)
def test_a_particle_holds_what_code_may_change(act, particle):
    assert particle_of(act) == particle


def test_an_element_by_brackets_puts_itself_into_a_map():
    ages = "state_variable: map<int, int> ages\n"
    assert particle_of("__reward = state__.ages[3] + state__.row[0];", ages) == ["ages"]
    assert particle_of("__reward = state__.ages.at(3);", ages) == []


def test_what_an_initial_belief_sets_is_in_the_particle():
    assert particle_of("", "initial_belief:\nstate.lamp = On;\n") == ["lamp"]


def test_everything_from_a_drawn_default_on_is_in_the_particle():
    drawn = "state_variable: bool lucky\ncode:\nstate.lucky = AOS.Bernoulli(0.5);\n"
    after = "state_variable: bool as_well\ncode:\nstate.as_well = state.lucky;\n"
    assert particle_of("", drawn + after) == ["lucky", "as_well"]


def test_the_state_digest_is_of_the_declared_state():
    plain = emit(program_of(project_of("state__.total = 1;")))
    other_code = emit(program_of(project_of("state__.count = 2;")))
    more = emit(program_of(project_of("state__.total = 1;", "state_variable: bool extra\n")))
    assert plain.state_digest == other_code.state_digest
    assert plain.digest != other_code.digest
    assert plain.state_digest != more.state_digest


@pytest.mark.parametrize(
    ("act", "word"),
    [
        ("state__.total = rand();", "rand"),
        ("static int calls = 0; state__.total = ++calls;", "static"),
        ("std::mt19937 own; state__.total = own();", "mt19937"),
        ("state__.total = std::bernoulli_distribution(0.9)(state__.count);", "bernoulli_distribution"),
        ("std::poisson_distribution<> far(2); state__.total = 1;", "poisson_distribution"),
        ("auto now = std::chrono::steady_clock::now(); state__.total = 1;", "steady_clock"),
    ],
)
def test_code_that_cannot_be_repeated_exactly_is_refused(act, word):
    program, diagnostics = lower(project_of(act))
    assert program is None
    assert diagnostics[0].code == "AOS124"
    assert str(diagnostics[0].span) == f"act.sd:3:{act.index(word) + 1}"


def test_a_distribution_of_the_standard_library_is_told_with_the_draw_that_aos_has():
    code = "std::minstd_rand own(1); std::normal_distribution<> far(2, 1); state__.total = far(own);"
    assert [finding.hint for finding in lower(project_of(code))[1]] == [
        "Leave it out: AOS.Bernoulli and its like need no generator",
        "Write `AOS.SampleNormal(mean, deviation)`",
    ]


def test_a_constant_static_a_variable_called_time_and_a_duration_are_fine():
    code = "static const int two = 2; int time = two; state__.total = time + std::chrono::seconds{3}.count();"
    assert lower(project_of(code))[0] is not None


def test_a_state_given_an_observation_takes_the_local_variables_that_it_names():
    text = 'state___.total = answer == "much" ? 9 : 0;'
    project = project_of("__reward = 1;", given=text)
    program = program_of(project)
    (skill,) = program.skills
    assert [(local.name, local.type) for local in skill.locals] == [("answer", "std::string")]
    assert [variable.name for variable in program.particle] == ["total"], "what it writes is no constant"


def test_a_local_variable_of_a_state_variables_name_and_type_is_told():
    project = project_of("__reward = 1;")
    skill = project.skills[0]
    variable = replace(skill.mapping.local_variables[0], name="total", type="int")
    mapping = replace(skill.mapping, local_variables=(variable,))
    shadowed = replace(project, skills=(replace(skill, mapping=mapping),))
    assert program_of(shadowed).skills[0].reported == ("total",)
    untyped = replace(mapping, local_variables=(replace(variable, type=""),))
    project = replace(project, skills=(replace(skill, mapping=untyped),))
    assert program_of(project).skills[0].reported == ()


def test_names_that_cpp_needs_are_refused_at_their_places():
    project = project_of()
    variables = tuple(
        replace(variable, name="operator" if variable.name == "total" else variable.name)
        for variable in project.environment.variables
    )
    environment = replace(project.environment, variables=variables)
    found = errors_of(replace(project, environment=environment))
    assert [(d.code, d.span) for d in found] == [("AOS126", variables[-1].span)]


def test_a_word_of_the_emitted_file_is_refused_only_where_it_would_be_in_the_way():
    kinds = "define_type: Kind\nenum_members: model, ground, main\nstate_variable: Kind model\n"
    assert lower(project_of("state__.model = ground;", kinds))[0] is not None
    (refusal,) = errors_of(project_of("", "define_type: model\nvariable: int age\n"))
    assert (refusal.code, refusal.span.line) == ("AOS126", HOME.count("\n") + 1)


def test_code_that_could_leave_its_function_is_refused():
    project = project_of()
    skill = project.skills[0]
    block = skill.model.dynamic_model[0]
    assert block.code is not None
    code = replace(block.code, code="} void escaped() {")
    model = replace(skill.model, dynamic_model=(replace(block, code=code),))
    project = replace(project, skills=(replace(skill, model=model),))
    assert {d.code for d in errors_of(project)} == {"AOS108"}


@pytest.mark.parametrize("stored", ["tuple<int,int>", "deque<int>", "vector<int*>"])
def test_what_no_state_can_hold_is_refused(stored):
    text = json_text(
        {
            "EnvironmentGeneral": {"Horizon": 3, "Discount": 0.9},
            "GlobalVariableTypes": [],
            "GlobalVariablesDeclaration": [{"Name": "kept", "Type": stored}],
            "InitialBeliefStateAssignments": [],
            "SpecialStates": [],
            "ExtrinsicChangesDynamicModel": [],
        },
        "Environment",
        "environment",
    )
    project = text_project({"home.json": text, "act.sd": ACT, "act.am": mapping_text()})
    assert [d.code for d in errors_of(project)] == ["AOS124"]


def errors_of(project: Project) -> list[Diagnostic]:
    program, diagnostics = lower(project)
    assert program is None
    return [diagnostic for diagnostic in diagnostics if diagnostic.is_error]
