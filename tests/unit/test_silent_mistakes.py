import pytest
from lint_texts import ENVIRONMENT, MAPPING, SIDES, SKILL, finding_texts, found, skill_after
from places import ROOT
from texts import encoded

from aos_language.load import load_files
from aos_protocol.diagnostics import Severity

KETTLE = ROOT / "docs/examples/kettle-json"

TEXT = MAPPING.replace("response: walked\nresponse_rule: True\n", "response_local_variable: steps\n")
FAR = "int far(int a, bool b, int c = 2) { return b ? a : c; }"


def with_shared(code: str) -> str:
    return ENVIRONMENT.replace("define_type: Cell", f"shared_code:\n{code}\n\ndefine_type: Cell", 1)


@pytest.mark.parametrize(
    ("value", "name", "kind", "hint"),
    [
        ("count", "count", "int", "Write `std::to_string(count)`"),
        ('"step " + steps', "steps", "int", "Write `std::to_string(steps)`"),
        ('steps > 1 ? "far" : 0', "0", "number", 'Write it in quotes: `"0"`'),
        ("state__.side", "state__.side", "Side", "Write `std::to_string(state__.side)`, or a text"),
        ("Left", "Left", "Side", 'Write it in quotes: `"Left"`'),
    ],
)
def test_a_number_in_the_place_of_a_text_response_is_told(value, name, kind, hint):
    code = f"int count = steps;\n__moduleResponseStr = {value};"
    told = found(environment=SIDES, skill=SKILL.replace("__moduleResponse = walked;", code), mapping=TEXT)
    (only,) = [finding for finding in told if finding.code == "AOS116"]
    message = f"__moduleResponseStr takes a text, and `{name}` is of the type {kind}"
    assert (only.severity, only.message, only.hint[: len(hint)]) == (Severity.WARNING, message, hint)
    assert (only.span.line, only.span.column) == (11, 23 + value.index(name))


@pytest.mark.parametrize("value", ['steps > 1 ? "a" : name', "std::to_string(steps)", "names[steps]"])
def test_a_text_of_any_kind_is_a_text_response(value):
    code = f'std::string name = "n"; std::vector<std::string> names;\n__moduleResponseStr = {value};'
    assert finding_texts(skill=SKILL.replace("__moduleResponse = walked;", code), mapping=TEXT) == []


def test_a_number_in_the_place_of_a_response_is_told_with_the_names():
    told = "10 AOS116 `0` is a number, and no name of a response. The responses are `walked`"
    assert finding_texts(skill=SKILL.replace("= walked;", "= steps > 1 ? walked : 0;")) == [told]


def test_an_unknown_name_in_the_condition_of_a_response_is_taken_for_none():
    told = "10 AOS110 unknown name `stepz`. Did you mean `steps`?"
    assert finding_texts(skill=SKILL.replace("= walked;", "= stepz > 1 ? walked : walked;")) == [told]


@pytest.mark.parametrize(("call", "given"), [("far(1)", "1 value"), ("far(1, true, 2, 3)", "4 values")])
def test_a_call_of_a_shared_function_with_other_values_is_told_with_what_it_takes(call, given):
    told = f"9 AOS110 `far` is called with {given}. Shared code has `far(int a, bool b, int c = 2)`"
    assert finding_texts(environment=with_shared(FAR), skill=SKILL.replace("+ steps", f"+ {call}")) == [told]


@pytest.mark.parametrize(
    ("shared", "call"),
    [
        (FAR, "far(1, true)"),
        ("int far(int a) { return a; }\nint far() { return far(1); }", "far()"),
        ("int far(const auto&... all) { return sizeof...(all); }", "far(1, 2, 3)"),
        ("int far(int a) { return a; }", "[&](auto far) { return far(); }([] { return 1; }) + far(1)"),
    ],
)
def test_calls_that_a_shared_function_takes_are_left_alone(shared, call):
    skill = SKILL.replace("+ steps", f"+ {call}")
    assert finding_texts(environment=with_shared(shared), skill=skill) == []


def test_a_state_variable_that_is_set_without_its_state_is_told_with_it():
    for whole, before, meant in (
        ({"skill": SKILL}, "state__.second.x =", "state__.second"),
        ({"environment": ENVIRONMENT}, "if (state.second", "state.second"),
    ):
        (only,) = found(
            **{key: text.replace(before, f"second = {{3}};\n{before}") for key, text in whole.items()}
        )
        assert (only.code, only.message) == ("AOS110", "unknown name `second`")
        assert (only.hint, only.mend.text) == (f"Did you mean `{meant}`?", meant)


@pytest.mark.parametrize(
    "code",
    [
        "auto [first, second] = std::make_pair(1, 2); second = 3;",
        "auto set = [&](auto& second) { second = 3; }; set(state__.first.x);",
        "struct Pair { int second = 0; void raise() { second = 1; } };",
    ],
)
def test_names_that_code_declares_for_itself_are_no_state_variables(code):
    assert finding_texts(skill=skill_after(code)) == []


def test_a_mistyped_key_that_others_build_on_is_one_mistake():
    names = ("LocalVariablesInitialization", "GlobalVariablesDeclaration", "EnumValues", "ResponseRules")
    for name in (*names, "NextStateAssignments", "ModuleResponse", "GlobalVariableTypes"):
        files = {path.name: path.read_bytes() for path in KETTLE.iterdir() if path.is_file()}
        (changed,) = [file for file, text in files.items() if text.count(f'"{name}"'.encode()) and file]
        files[changed] = files[changed].replace(f'"{name}"'.encode(), f'"{name}x"'.encode(), 1)
        (only,) = load_files(files).diagnostics
        assert (only.code, only.hint, only.span.file) == ("AOS102", f"Did you mean `{name}`?", changed)


def test_a_key_of_which_only_the_beginning_is_written_is_told_whole():
    files = {path.name: path.read_bytes() for path in KETTLE.iterdir() if path.is_file()}
    files["environment.json"] = files["environment.json"].replace(b"BeliefStateAssignments", b"Belief")
    told = [one.hint for one in load_files(files).diagnostics if one.code == "AOS102"]
    assert told == ["Did you mean `InitialBeliefStateAssignments`?"]


def test_a_missing_semicolon_before_a_copy_of_the_state_is_told_once():
    (only,) = found(skill=skill_after("float far = state.first.x"))
    assert (only.code, only.span.line) == ("AOS108", 10)
    assert only.hint == "Is a semicolon missing at the end of the line above?"


@pytest.mark.parametrize(
    ("code", "hint"),
    [
        ("for (int each in state.walls) __reward += each;", "A loop over a list is `for (auto x : list)`"),
        ("for (int i = 0, i < 3, i++) __reward += i;", "Semicolons divide the parts of a `for`"),
        ("__reward := 3;", "To set a variable, write `=`"),
    ],
)
def test_words_of_other_languages_are_told_with_those_of_cpp(code, hint):
    told = [one for one in found(skill=skill_after(code)) if one.code == "AOS108"]
    assert (told[0].hint, told[0].span.line) == (hint, 9)


def test_a_real_number_that_rounding_makes_miss_a_decimal_is_told():
    changed = ENVIRONMENT.replace(
        "x 0\n", "x 0\nvariable: float width\nvariable: double far\nvariable: double at 0.3\n"
    )
    code = "state__.first.far += 0.1;\n__reward = (state.second.width == 0.3) + (state.first.far == 0.3);\n"
    exact = "__reward += (state.second.width == 0.5) + (state.first.at == 0.3) + (state.first.far == 0.25);\n"
    told = found(environment=changed, skill=SKILL.replace("state__.second", f"{code}{exact}state__.second"))
    assert [(one.span.column, one.severity, one.hint) for one in told] == [
        (13, "warning", "Write `std::abs(state.second.width - 0.3) < 1e-6`"),
        (43, "remark", "Write `std::abs(state.first.far - 0.3) < 1e-6`"),
    ]


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("steps;", "9 AOS149 this statement does nothing. To set a variable, write `NAME = steps;`"),
        (
            "__reward - (1);",
            "9 AOS149 this statement does nothing. To set a variable, write `NAME = __reward - (1);`",
        ),
        ("__reward =+ 1;", "9 AOS149 this `+` does nothing. To add, write `+=`"),
        ("__reward = +1; __reward += +1;", ""),
        ("(void)steps; if (steps > 1) state__.first.x++;", ""),
        ("state__.first.x += 0.2;", "9 AOS149 `state__.first.x` is a whole number, and `0.2` is none. "),
        ("int far = -1.5; state__.first.x = far;", "9 AOS149 `far` is a whole number, and `-1.5` is none. "),
        ("int n = 2.0; state__.first.x = n * 1.5; state__.first.x *= 0.5;", ""),
        (
            "vector<int> n = [1, 2]; __reward = n[0];",
            "9 AOS108 a list stands in braces in C++. Write `{1, 2}`",
        ),
        ("if (steps =< 1) __reward = 1;", "9 AOS108 `=<` is no operator of C++. Write `<=`"),
        ("auto f = [steps] { return steps; }; __reward = f();", ""),
        ("__reward = 7/2;", "9 AOS149 `7/2` is 3 in C++. Write `7.0 / 2`"),
        (
            "__reward = 4/2 + (steps ^ 1) + (1 < steps < 3);",
            "9 AOS149 this compares the truth of `1 < steps`",
        ),
        ("__reward = steps ^ 2;", "9 AOS149 `^` is no power in C++. Write `std::pow(steps, 2)`"),
        ("if (steps > 1); __reward = 1;", "9 AOS149 this semicolon ends the `if`. "),
        ("if (steps > 1) ; else if (std::max<int>(steps, 1) > 2) __reward = 1;", ""),
        ("switch (steps) { case 1: __reward = 1; case 2: ; }", "9 AOS149 what stands here goes on into "),
        ("switch (steps) { case 0: case 1: { return; } case 3: ; [[fallthrough]]; default: ; }", ""),
    ],
)
def test_code_that_does_nothing_or_loses_a_fraction_is_told(code, told):
    texts = finding_texts(skill=skill_after(code))
    assert [text[: len(told)] for text in texts] == [told] * bool(told)


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("if (state.side == Left || Right) return;", "`Right` is compared with nothing here"),
        ("if (state.side != Left || state.side != Right) return;", "with what stands before it, this always"),
        ("if (steps > 1 && steps == 2 && steps == 3) return;", "with what stands before it, this never"),
        ("if (!steps == 3) return;", "`!` binds first: this compares `!steps`"),
        ("if (steps & 1 == 1) return;", "`==` binds first: this is `steps & (1 == 1)`"),
        ("__reward = -1 + steps ? 2 : 3;", "`+` binds before `?`: the condition is `-1 + steps`"),
        ("AOS.Bernoulli(0.5);", "nothing takes what `AOS.Bernoulli` gives"),
        ("state__.cells.empty();", "nothing takes what `state__.cells.empty` gives"),
        ("for (auto cell : state__.cells) cell.x = 1;", "`cell` is a copy: this changes nothing"),
        ("for (auto [key, n] : state__.table) ++n;", "`n` is a copy: this changes nothing"),
        ("auto first = state__.first; first.x = 1; first.x++;", "`first` is a copy: this changes nothing"),
        ("Cell cell = state.cells[0]; if (steps > 1) { cell.x = 2; }", "`cell` is a copy: this changes"),
        ("auto c = state__.first; c.x = 1; state__.first = c; auto& d = state__.first; d.x = 2;", ""),
        ("auto after = state__; after.first.x = 2;", "`after` is a copy: this changes nothing"),
        ("auto x = state__.first.x; x = 2;", "`x` is a copy: this changes nothing"),
        ("for (auto cell : state__.cells) cell = Cell();", "`cell` is a copy: this changes nothing"),
        ("auto first = state__.first; state__.first.x = 2;", ""),
        ("int n = state.first.x; n = 2; auto at = state__.table.find(1); at->second = 3;", ""),
        ("state__.first = state__.first;", "`state__.first` is set to itself"),
        ("if (steps > 1) ; else; __reward = 1;", "this semicolon ends the `else`"),
        ("__reward =- 1;", "`=-` subtracts nothing: it sets"),
        ("__reward = -1; __reward = state.first.x;", "`__reward` is set again before anything reads it"),
        ("state__.first.x = 1; /* so */ state__.first.x = AOS.Bernoulli(0.5);", "`state__.first.x` is set"),
        ("__reward = 1; __reward = __reward * 2; __reward += 1;", ""),
        ("auto twice = [&] { return 2 * __reward; }; __reward = 1; __reward = twice();", ""),
        ("auto* first = &state__.first; state__.first.x = 1; state__.first.x = first->x + 1;", ""),
        ("bool b = AOS.Bernoulli(1 - steps / 4); return;", "`steps / 4` is a whole number: the fraction"),
        ("int n = 3; bool b = AOS.Bernoulli(state.first.x / n); return;", "`state.first.x / n` is a whole"),
        ("int n = AOSUtils::SampleDiscrete(vector<double>{1 / steps}); return;", "`1 / steps` is a whole"),
        ("bool b = AOS.Bernoulli(1.0 * steps / 4) + AOS.Bernoulli(0.5 / steps); return;", ""),
        ("double n = 2; bool b = AOS.Bernoulli((double)steps / 4) + AOS.Bernoulli(steps / n); return;", ""),
        ("bool b = steps > 1 && 0.9; if (b) return;", "`0.9` is always true here"),
        ("switch (steps) { case 1: __reward = 1; case 2: break; case 3: __reward = 2; }", ""),
        ("bool b = steps == 1 || steps == 2 && state.side != Left; if (!b == b || b) return;", ""),
        ("if (steps == 1 | (steps & 2) == 2 && AOS.Bernoulli(0.5)) state__.cells.clear();", ""),
        ("for (auto c : state__.cells) __reward += c.x++; for (auto& c : state__.cells) c.x = 1;", ""),
    ],
)
def test_code_that_says_other_than_it_means_is_told(code, told):
    environment = f"{SIDES}state_variable: vector<Cell> cells\nstate_variable: map<int, int> table\n"
    all_told = found(environment=environment, skill=skill_after(code))
    texts = [each.message for each in all_told if each.code == "AOS149"]
    assert [text[: len(told)] for text in texts] == [told] * bool(told)


@pytest.mark.parametrize(
    ("code", "is_told"),
    [
        ("if (steps > 1) __meetPrecondition = true;", True),
        ("__meetPrecondition |= steps > 1;", True),
        ("__meetPrecondition = __meetPrecondition || steps > 1;", True),
        ("__meetPrecondition = false; if (steps > 1) __meetPrecondition = true;", False),
        ("__meetPrecondition = true; __meetPrecondition &= steps > 1;", False),
        ("__meetPrecondition = true;", False),
    ],
)
def test_a_precondition_that_code_only_meets_is_told(code, is_told):
    texts = finding_texts(skill=SKILL.replace("dynamic_model:", f"precondition:\n{code}\n\ndynamic_model:"))
    told = "9 AOS147 this precondition is never false: __meetPrecondition starts as true. "
    assert [text[: len(told)] == told for text in texts if "AOS147" in text and "keeps" not in text] == [
        True
    ] * is_told


@pytest.mark.parametrize(
    ("time", "is_told"),
    [("1.33", True), ("AOS.SampleNormal(3, 1)", True), ("std::round(1.5 * steps)", False), ("steps", False)],
)
def test_an_execution_time_with_a_fraction_is_told(time, is_told):
    section = f"execution_time:\n__moduleExecutionTime = {time};\n\ndynamic_model:"
    texts = finding_texts(skill=SKILL.replace("dynamic_model:", section))
    message = f"9 AOS149 `__moduleExecutionTime` is a whole number, and `{time}` is none"
    assert [text.partition(". ")[0] for text in texts] == [message] * is_told


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("near", "17 AOS149 this code for the default of near sets nothing. Write `state.near = near;`"),
        ("{1, 2}", "17 AOS149 this code for the default of near sets nothing. Write `state.near = {1, 2};`"),
        ("state.near = 1.5;", "17 AOS149 `state.near` is a whole number, and `1.5` is none. "),
        ("AOS.SetNull(state.near);", ""),
    ],
)
def test_a_default_that_sets_nothing_or_loses_a_fraction_is_told(code, told):
    texts = finding_texts(environment=ENVIRONMENT.replace("state.near = 1;", code))
    assert [text[: len(told)] for text in texts] == [told] * bool(told)


def test_a_decimal_comma_in_the_default_of_a_field_is_an_error():
    (only,) = found(environment=ENVIRONMENT.replace("int x 0", "int x 0\nvariable: float far 0,5"))
    assert (only.is_error, only.code, only.mend.text) == (True, "AOS149", ".")


def test_a_mistyped_low_level_type_of_a_constant_is_told():
    low_level = (
        "project: hall\ndefine_type: Pose\nvariable: float x\n\nconstant: Psoe home\ncode:\nhome.x = 1\n"
    )
    files = {"hall.ef": ENVIRONMENT, "walk.sd": SKILL, "walk.am": MAPPING, "hall.lf": low_level}
    (only,) = load_files(encoded(files)).diagnostics
    assert (only.message, only.hint) == ("unknown low-level type `Psoe`", "Did you mean `Pose`?")
