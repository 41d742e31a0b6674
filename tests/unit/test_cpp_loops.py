import pytest

from aos_language.cpp.loops import DrawingLoop, Scope, loops_of
from aos_language.cpp.snippets import read_cpp, read_cpp_declarations

STATE = Scope(frozenset({"state"}))


def found(code: str) -> tuple[DrawingLoop, ...]:
    return loops_of(read_cpp(code), STATE).loops


@pytest.mark.parametrize(
    "code",
    [
        "while (state.side == 0) state.side = AOS.Bernoulli(0.5);",
        "do { state.side = AOS.Bernoulli(0.5); } while (state.side == 0);",
        "for (;;) if (AOS.Bernoulli(0.5)) break;",
        "auto roll = [&]() { return AOS.Bernoulli(0.5); }; while (roll()) state.side++;",
        "for (int i = 0; i < 3; i++) if (AOS.Bernoulli(0.5)) i--;",
        "for (int i = 0; i < 3; i++) { int& j = i; if (AOS.Bernoulli(0.5)) j--; }",
        "while (AOS.Bernoulli(0.5))",
        "do { state.side = AOSUtils::SampleDiscrete(state.odds); } while (state.side == 0);",
    ],
)
def test_a_loop_that_draws_is_told(code):
    assert len(found(code)) == 1


@pytest.mark.parametrize(
    "code",
    [
        "while (state.side < 3) state.side++;",
        "for (int i = 0; i < 3; i++) state.at[i] = AOS.Bernoulli(0.1 * i);",
        "for (int i = 0; i < 3 && !state.done; ++i) state.done = AOS.Bernoulli(0.5);",
        "for (bool& each : state.at) each = AOS.Bernoulli(0.5);",
        "auto roll = [&AOS]() { while (AOS.Bernoulli(0.5)) {} };",
        "while (bool again = AOS.Bernoulli(0.5)) state.side++;",
        "int x = 0; if (state.side) { bool x = true; while (x) x = AOS.Bernoulli(0.5); }",
    ],
)
def test_others_are_left_as_they_are(code):
    assert found(code) == ()


def test_variables_are_those_that_the_condition_sees():
    code = """const int limit = 3;
int outer, unrelated = 1;
auto spin = [&](int n) { while (n > 0) n -= AOS.Bernoulli(0.5); return n; };
for (int i = 0; i < limit; i++) {
    int inner = 0, later;
    while (inner == 0) { int gone = AOS.Bernoulli(0.5); inner += gone + outer; }
    int unseen = 0;
}"""
    (in_lambda, nested) = found(code)
    assert in_lambda.mentioned == ("n",)
    assert in_lambda.others == ("outer", "state", "unrelated")
    assert nested.mentioned == ("inner", "outer")
    assert nested.others == ("i", "later", "state", "unrelated")
    read = loops_of(read_cpp(code), STATE)
    assert [code[:end].rsplit(None, 1)[-1] for end in read.unset] == ["outer", "later"]
    assert read.after.variables == {"state", "outer", "unrelated"}
    assert read.after.drawing == {"AOS", "AOSUtils", "spin"}


def test_a_function_sees_its_parameters_and_its_own_variables():
    code = """const int most = 3;
int roll(const auto& state, auto& state__, int sides) {
    int face = 0;
    while (face == 0) face = AOS.SampleDiscrete(-1, {0.5, 0.5});
    return face;
}
int twice(int sides) { while (roll(sides) < 1) {} return sides; }"""
    scope = Scope(drawing=frozenset({"AOS", "roll"}))
    first, second = loops_of(read_cpp_declarations(code), scope, are_declarations=True).loops
    assert first.is_in_function
    assert first.mentioned == ("face",)
    assert first.others == ("sides", "state__")
    assert second.mentioned == ("sides",)


def test_what_is_called_is_told_unless_it_is_a_lambda_that_keeps_nothing():
    code = """int x = 0, n = 0;
auto plain = [&]() { x += AOS.Bernoulli(0.5); };
auto keeps = [n]() mutable { n++; };
while (x < 1) { plain(); keeps(); }"""
    (loop,) = found(code)
    assert loop.mentioned == ("keeps", "n", "x")
    assert not loop.is_in_function


def test_places_are_those_of_the_text_before_its_semicolons_are_put_in():
    code = "int é = 0;\nwhile (é == 0 /* again */) é = AOS.Bernoulli(0.5)"
    cpp = read_cpp(code)
    (loop,) = loops_of(cpp, STATE).loops
    assert code[loop.start : loop.end] == "while (é == 0 /* again */) é = AOS.Bernoulli(0.5)"
    assert code[loop.head : loop.head_end] == "é == 0 /* again */"
