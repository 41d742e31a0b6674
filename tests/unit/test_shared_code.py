import json

import pytest
from dialects import say_the_same
from places import BUNDLES
from projects import files_project, text_project
from scripted_models import ScriptedModel, scripted
from texts import encoded

from aos_editor.symbols import read_bundle
from aos_language.cpp.shared import shared_code
from aos_language.load import load_files, read_bundle_files
from aos_language.outline import outline
from aos_protocol.diagnostics import Diagnostic
from aos_solver.building.compiler_messages import read_messages
from aos_solver.emission.emit import emit
from aos_solver.emission.lowering.lower import lower
from aos_solver.emission.program import Program

SHARED = """const double slip_probability = 0.1;
constexpr int start = 2;
enum Grip { Loose, Firm };
const Tool spade = {7};

bool slips(int times) {
    for (int i = 0; i < times; i++) {
        if (AOS.Bernoulli(slip_probability)) return true;
    }
    return false;
}
bool slips() { return slips(1); }
Grip grip_of(const auto& state, Plot plot) { return state.is_dug[plot] ? Firm : Loose; }
int depth(const Tool& tool) { return tool.length + spade.length; }
void dig(auto& state__, Plot plot) { state__.is_dug[plot] = true; }
void add(auto& list, int item) { list.push_back(item); }"""
ENVIRONMENT = f"""project: garden
horizon: 4
shared_code:
{SHARED}
define_type: Plot
enum_members: North, South
define_type: Tool
variable: int length start
state_variable: bool is_dug [Plot]
state_variable: Tool tool
state_variable: int log []
code:
state.log = {{0}};
state_variable: int size
default_value: start
state_variable: Plot best
action_parameter: Plot north
code:
state.north = North;
initial_belief:
state.best = slips() ? North : South;
reward_code:
if (grip_of(state, South) == Firm) __reward = 1;
"""
WORK = """project: garden
parameter: Plot plot
dynamic_model:
if (!slips(2)) dig(state__, plot);
if (grip_of(state__, plot) == Firm) add(state__.log, depth(state.tool) + state.size);
Grip drawn = AOS.SampleDiscrete(Grip, {0.5, 0.5});
__moduleResponse = drawn == Firm ? firm : loose;
"""
FILES = {"garden.ef": ENVIRONMENT, "work.sd": WORK}


def files(*changes: str) -> dict[str, bytes]:
    """The bundle; each `OLD -> NEW` replaces a text in it."""
    texts = dict(FILES)
    for change in changes:
        old, _, new = change.partition(" -> ")
        assert any(old in text for text in texts.values())
        texts = {name: text.replace(old, new, 1) for name, text in texts.items()}
    return encoded(texts)


def found(*changes: str) -> list[Diagnostic]:
    bundle = load_files(files(*changes))
    findings = [finding for finding in bundle.diagnostics if finding.code != "AOS139"]
    return findings + (list(lower(bundle.project)[1]) if bundle.project is not None else [])


def program(*changes: str) -> Program:
    bundle = load_files(files(*changes))
    assert bundle.project is not None, bundle.diagnostics
    lowered, findings = lower(bundle.project)
    assert lowered is not None, findings
    return lowered


@pytest.fixture(scope="module")
def model() -> ScriptedModel:
    return scripted(text_project(FILES))


def test_all_code_sees_the_constants_and_calls_the_functions(model: ScriptedModel):
    assert found() == []
    # The draws: of the belief, twice whether the hand slips, and the grip.
    played = model.play("work(plot=north)|0 0 1", initial="1")
    state = played.initial["state"]
    assert (state["best"], state["is_dug[North]"]) == ("North", "false")
    step = played.steps[0]
    assert step["state"]["is_dug[North]"] == "true"
    assert step["state"]["log[1]"] == str(2 + 7 + 2)
    assert step["observation"] == "firm"


def test_a_function_that_draws_ends_where_its_draws_say(model: ScriptedModel):
    played = model.play("work(plot=north)|1 0", initial="0")
    assert played.initial["state"]["best"] == "South"
    assert played.steps[0]["state"]["is_dug[North]"] == "false"
    assert played.observations == ["loose"]


def test_all_dialects_say_the_same(tmp_path):
    assert "  | bool slips() { return slips(1); }" in outline(files_project(files()))
    json_texts, _ = say_the_same(files())
    assert json.loads(json_texts["environment.ef.json"])["SharedCode"] == SHARED.split("\n")
    for name, data in files().items():
        (tmp_path / name).write_bytes(data)
    bundle = read_bundle(tmp_path, {})
    called = bundle.at("work.sd", 4, 6)
    definition = bundle.definition(called.symbol)
    assert str(definition.span) == "garden.ef:9:6"


# --- what analyses make of it ---


def test_what_a_function_draws_and_changes_is_known():
    shared = shared_code(SHARED, frozenset({"Tool"}))
    assert shared.drawing == {"slips"}
    assert shared.reading == {"grip_of", "depth"}
    assert shared.changing == {"slips", "dig", "add"}
    assert [name.name for name in shared.names if name.is_late] == ["spade"]
    assert not shared_code("using Place = int&; int put(Place at) { return at = 1; }").reading


def test_only_what_functions_may_change_is_part_of_a_particle():
    changed = {variable.name for variable in program().particle}
    assert changed == {"is_dug", "log", "best"}
    by_whole = program(
        "{ state__.is_dug[plot] = true; } -> { auto& all = state__; all.is_dug[plot] = true; }"
    )
    by_reference = program(
        "bool slips() -> int& size(auto& s) { return s.size;} bool slips()", "if (! -> size(state__)++; if (!"
    )
    assert not by_whole.constants
    assert not by_reference.constants


def test_a_vector_that_a_function_fills_has_room():
    types = {variable.name: variable.type for variable in program().variables}
    assert types["log"] == "aos::Vector<int, 64>"


def test_constants_say_how_long_vectors_are():
    changes = (
        "state.log = {0}; -> state.log.assign(start, 0);",
        "add(state__.log, -> twice(",
        "void add( -> void adds(",
    )
    types = {
        v.name: v.type
        for v in program(*changes, "void dig( -> int twice(int n) { return n; }\nvoid dig(").variables
    }
    assert types["log"] == "aos::Vector<int, 2>"


def test_a_reward_is_certain_only_where_no_function_draws():
    assert not program().skills[0].has_certain_rewards
    assert program("if (!slips(2)) dig -> if (depth(state.tool) > 1) dig").skills[0].has_certain_rewards


def test_a_default_may_be_drawn_by_a_function():
    assert not program().draws_defaults
    assert program("default_value: start -> default_value: slips() ? 1 : 2").draws_defaults


def test_a_variable_that_only_shapes_what_a_function_reads_matters():
    alone = "dig(state__, plot); -> state__.is_dug[plot] = true;", "void dig( -> void digs("
    assert [variable.name for variable in program(*alone).irrelevant] == ["best"]
    whole = "return state.is_dug[plot] ? Firm -> auto& all = state; return all.is_dug[plot] ? Firm"
    assert program(*alone, whole).irrelevant == ()


@pytest.mark.parametrize("name", ["armadillo-finer", "turtlebot-noisy", "bench/laser", "bench/tag"])
def test_draws_behind_a_function_are_taken_for_no_less_than_written_out(name):
    written, behind = {}, {}
    for file, data in read_bundle_files(BUNDLES / name)[0].items():
        text = data.decode()
        written[file] = data
        if not file.endswith(".am"):
            text = text.replace("AOS.Bernoulli(", "falls(")
        shared = "shared_code:\nbool falls(double p) { return AOS.Bernoulli(p); }\nhorizon:"
        behind[file] = text.replace("horizon:", shared, 1).encode()
    programs = []
    for texts in (written, behind):
        project = load_files(texts).project
        assert project is not None
        lowered, findings = lower(project)
        assert lowered is not None, findings
        programs.append(lowered)
    one, other = programs
    assert [(v.name, v.type) for v in one.particle] == [(v.name, v.type) for v in other.particle]
    assert {v.name for v in other.irrelevant} <= {v.name for v in one.irrelevant}
    for skill, its_other in zip(one.skills, other.skills, strict=True):
        assert its_other.has_certain_rewards <= skill.has_certain_rewards
        assert its_other.has_alike_groundings <= skill.has_alike_groundings
        assert its_other.keeps_state >= skill.keeps_state


def test_the_emitted_functions_stand_at_the_documents_lines():
    emitted = emit(program())
    lines = emitted.cpp.split("\n")
    line = next(n for n, text in enumerate(lines, 1) if "bool slips(auto& AOS, int" in text)
    assert str(emitted.locate(line, lines[line - 1].index("int times") + 1)) == "garden.ef:9:12"
    assert "bool slips(auto& AOS) { return slips(AOS, 1); }" in emitted.cpp


@pytest.mark.parametrize(
    ("said", "name", "hint"),
    [
        ("there are no arguments to 'slipps' that depend on a template parameter", "slipps", "slips"),
        ("'Tree' was not declared in this scope; did you mean 'free'?", "Tree", ""),
        ("'sqr' was not declared in this scope; did you mean 'sqrt'?", "sqr", "sqrt"),
        ("'tool' was not declared in this scope; did you mean 'bool'?", "tool", "state.tool"),
        ("'is_dug' was not declared in this scope", "is_dug", "state.is_dug"),
        (
            "'retrun' was not declared in this scope\nm.cpp:{line}:1: error: void value not ignored",
            "retrun",
            "return",
        ),
    ],
)
def test_a_misspelt_name_is_told_with_one_that_documents_have(said, name, hint):
    emitted = emit(program())
    line = next(n for n, text in enumerate(emitted.cpp.split("\n"), 1) if "slips(AOS, 2)" in text)
    (error,) = read_messages(
        f"m.cpp:{line}:6: error: {said.format(line=line)}\n", "m.cpp", emitted
    ).diagnostics
    assert (error.message, error.hint) == (
        f"`{name}` was not declared",
        f"Did you mean `{hint}`?" if hint else "",
    )
    assert error.span.file == "work.sd"


@pytest.mark.parametrize(
    ("said", "message", "hint"),
    [
        ("'elif' was not declared in this scope", "`elif` was not declared", "C++ writes `else if`"),
        ("use of undeclared identifier 'True'", "use of undeclared identifier `True`", "C++ writes `true`"),
        ("'TRUE' was not declared in this scope", "`TRUE` was not declared", "C++ writes `true`"),
        (
            "no match for 'operator[]' (operand types are "
            "'aos::Map<aos::Vector<aos::Pair<aos::Text, int>, 2> >' and 'Tool')",
            "no match for `operator[]` (operand types are `map<string, int>` and `Tool`)",
            "",
        ),
        ("expected ';' before 'AND'", "expected `;` before `AND`", "C++ writes `&&`"),
        (
            "expected ';' before 'in'\nm.cpp:{line}:9: error: use of 'p' before deduction of 'auto'",
            "expected `;` before `in`",
            "C++ writes `:`",
        ),
        (
            "expected '(' before 'slips'\nm.cpp:{line}:9: error: expected '}' before 'else'",
            "expected `(` before `slips`",
            "A condition stands in brackets: `if (...)`",
        ),
        ("expected primary-expression before ')' token", "a value is missing behind `(`", ""),
        (
            "cannot convert 'const char*' to 'model::Side' in assignment",
            "cannot convert `const char*` to `Side` in assignment",
            "Numbers, values of enums and responses are written without quotes",
        ),
        (
            "assigning to 'model::Side' from incompatible type 'const char[5]'",
            "assigning to `Side` from incompatible type `const char[5]`",
            "Numbers, values of enums and responses are written without quotes",
        ),
        (
            "no matching function for call to 'aos::AnySource::Bernoulli()'",
            "no matching function for call to `AOS.Bernoulli()`",
            "",
        ),
        (
            "no matching function for call to "
            "'model::Environment::initial_belief<aos::AnySource>(model::State&)::Deck::take()'",
            "no matching function for call to `Deck::take()`",
            "",
        ),
        (
            "could not convert 'is_in.model::aos_skill_go::next_state<aos::Effect, aos::AnySource>"
            "(const model::State&, bool, aos::AnySource&)::<lambda(int, int)>(r, c)' from 'void' to 'bool'",
            "could not convert `is_in(r, c)` from `void` to `bool`",
            "",
        ),
        (
            "'const class aos::Vector<int, 64>' has no member named 'push_bak'; did you mean 'push_back'?",
            "`vector<int>` has no member named `push_bak`",
            "Did you mean `push_back`?",
        ),
        (
            "conversion from 'std::ios_base& (*)(std::ios_base&)' to 'int'\nm.cpp:{line}:9: error: could not "
            "convert 'std::right' from 'std::ios_base&(std::ios_base&)' to 'int'",
            "`right` was not declared",
            "",
        ),
        (
            "'depth' was not declared in this scope",
            "`depth` was not declared",
            "It has to stand before its first use",
        ),
    ],
)
def test_messages_are_told_in_the_documents_terms_with_what_to_write(said, message, hint):
    emitted = emit(program())
    line = next(n for n, text in enumerate(emitted.cpp.split("\n"), 1) if "slips(AOS, 2)" in text)
    said = said.replace("{line}", str(line))
    (error,) = read_messages(f"m.cpp:{line}:9: error: {said}\n", "m.cpp", emitted).diagnostics
    assert (error.message, error.hint) == (message, hint)


# --- mistakes ---


@pytest.mark.parametrize(
    ("change", "hint"),
    [
        ("constexpr int start -> using namespace std;\nconstexpr int start", "Leave it out"),
        ("int size\n -> Grip size\n", "Declare it with `define_type:`"),
        ("int size\n -> Whole size\n", "Write the type that it stands for"),
    ],
)
def test_what_shared_code_need_not_or_cannot_declare_is_told_with_what_to_write(change, hint):
    whole = "enum Grip -> using Whole = int;\nenum Grip"
    assert hint in [finding.hint for finding in found(whole, change)]


@pytest.mark.parametrize(
    ("change", "code", "place"),
    [
        ("constexpr int start -> int start", "AOS145", "garden.ef:5:5"),
        ("probability = 0.1 -> probability = AOS.Bernoulli(0.1)", "AOS145", "garden.ef:4:14"),
        ("enum Grip { Loose, Firm }; -> struct Grip { int force; };", "AOS145", "garden.ef:6:1"),
        ("bool slips(int times) -> bool slips(auto& AOS, int times)", "AOS145", "garden.ef:9:18"),
        ("int depth( -> int max(", "AOS145", "garden.ef:17:5"),
        ("Grip grip_of( -> Grip Firm(", "AOS126", "garden.ef:16:6"),
        ("const Tool spade -> const Tool next_state", "AOS126", "garden.ef:7:12"),
        ("constexpr int start -> constexpr int North", "AOS126", "garden.ef:5:15"),
        ("{ return slips(1); } -> { return slips(1); }}", "AOS108", "garden.ef:15:34"),
        ("constexpr int start -> #define later 3\nconstexpr int start", "AOS108", "garden.ef:5:1"),
        ("    for (int i -> static int n = 0;\n    for (int i", "AOS124", "garden.ef:10:1"),
        ("if (!slips(2)) -> auto may = slips;\nif (!slips(2))", "AOS145", "work.sd:4:12"),
        ("    return false; -> int lost; return lost > 0;", "AOS143", "garden.ef:13:18"),
        ("AOS.Bernoulli(slip_probability) -> rand() % 2 > slip_probability", "AOS124", "garden.ef:11:13"),
        ("AOS.Bernoulli(slip_probability) -> AOS.Bernouli(slip_probability)", "AOS110", "garden.ef:11:17"),
        ("state.is_dug[plot] ? -> state.is_dugg[plot] ?", "AOS110", "garden.ef:16:59"),
        ("const auto& state, Plot -> const auto& s, Plot", "AOS123", "garden.ef:16:49"),
        ("enum Grip -> const int depth_m = 3;\nenum Grip", "AOS133", "garden.ef:6:11"),
        ("void add( -> int twice(int n) { return 2 * n; }\nvoid add(", "AOS133", "garden.ef:19:5"),
    ],
)  # fmt: skip
def test_a_mistake_is_told_at_its_place(change, code, place):
    places = [(finding.code, str(finding.span)) for finding in found(change)]
    assert (code, place) in places
    assert len(set(places)) == 1 or code in ("AOS145", "AOS126"), places
