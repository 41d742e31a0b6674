import pytest

from aos_language.cpp.goal_conditions import counted_conditions
from aos_language.cpp.snippets import read_cpp, read_cpp_expression

MARKS = {
    "aos_effect.holds(": "+(",
    "aos_effect.fails(": "-(",
    "aos_effect.entered(": "?(",
    "& aos::evaluate_all &": "&",
    "| aos::evaluate_all |": "|",
}


def counted(code: str, *, is_expression: bool = False) -> str:
    cpp = read_cpp_expression(code) if is_expression else read_cpp(code)
    edits = counted_conditions([cpp], is_expression=is_expression)
    text = cpp.replace(dict.fromkeys(edits[0])) if edits else ""
    for call, mark in MARKS.items():
        text = text.replace(call, mark)
    return text


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        (
            "if (state.a == 1 && !state.b && state.c > 2) __reward = 5;",
            "if (+(state.a == 1) & !-(state.b) & +(state.c > 2)) __reward = 5;",
        ),
        (
            "if (state.a != 1 || state.b || state.c) __reward = -1; else __isGoalState = true;",
            "if (-(state.a != 1) | -(state.b) | -(state.c)) __reward = -1; else __isGoalState = true;",
        ),
        (
            "if (state.a) if (state.b) { if (state.c) __reward = 5; }",
            "if (+(state.a)) if (+(state.b)) { if (+(state.c)) __reward = 5; }",
        ),
        (
            "if (state.a) { bool all = true; for (auto& d : state.d) all = all && d;"
            " __reward = all ? 5 : -5; }",
            "if (?(state.a)) { bool all = true; for (auto& d : state.d) all = all & +(d);"
            " __reward = all ? 5 : -5; }",
        ),
        (
            "if (Thing* a = state.a) { if (state.b && state.c && state.d) __reward = 5; }",
            "if (Thing* a = state.a) { if (+(state.b) & +(state.c) & +(state.d)) __reward = 5; }",
        ),
        (
            "if (state.n) { if (state.b && state.c && 6 / state.n > 2) __reward = 5; }",
            "if (+(state.n)) { if (+(state.b) & +(state.c) && +(6 / state.n > 2)) __reward = 5; }",
        ),
        (
            "if (state.a) { if (state.b && state.c && fabs(state.d) < 1) __reward = 5; } else __reward = -1;",
            "if (+(state.a)) { if (+(state.b) & +(state.c) & +(fabs(state.d) < 1)) __reward = 5; }"
            " else __reward = -1;",
        ),
        (
            "bool all = true; for (int i = 0; i < 5; i++) if (!state.d[i]) { all = false; break; }"
            " if (all) __reward = 5;",
            "bool all = true; for (int i = 0; i < 5; i++) if (!+(state.d[i])) { all = false; ; }"
            " if (all) __reward = 5;",
        ),
        (
            "int n = 0; for (int i = 0; i < 5; i++) n += state.d[i] == 2; __reward = n == 5 ? 60 : -5;",
            "int n = 0; for (int i = 0; i < 5; i++) n += +(state.d[i] == 2); __reward = n == 5 ? 60 : -5;",
        ),
        (
            "int m = 0; for (auto& d : state.d) if (d.at != 3) m++; if (m > 0) return; __reward = 5;",
            "int m = 0; for (auto& d : state.d) if (-(d.at != 3)) m++; if (m > 0) return; __reward = 5;",
        ),
    ],
)
def test_conditions_of_rewards_and_goals_are_counted(code, expected):
    assert counted(code) == expected


def test_conditions_of_a_special_state_are_counted():
    expected = "+(state.a == 1) & +(state.b == 2) & +(state.c)"
    assert counted("state.a == 1 && state.b == 2 && state.c", is_expression=True) == expected


@pytest.mark.parametrize(
    "code",
    [
        "if (state.a == 1 && state.b == 2) __reward = 5;",
        "if (state.a && state.b && state.c) __reward = -5;",
        "if (state.a || state.b || state.c) __reward = 5;",
        "if (state.a && state.b && state.c) { __reward = -5; __isGoalState = true; }",
        "__reward = state.a && state.b && state.c ? -5 : 0;",
        "if (AOS.Bernoulli(state.p) && AOS.Bernoulli(state.q) && AOS.Bernoulli(state.r)) __reward = 5;",
    ],
)
def test_what_is_asked_for_by_fewer_than_three_conditions_or_by_a_loss_is_left_as_it_is(code):
    assert counted(code) == ""


def test_what_may_fail_is_asked_only_after_what_guards_it():
    code = "if (state.a > 0 && 10 / state.a == 2 && state.b) __reward = 5;"
    assert counted(code) == "if (+(state.a > 0) && +(10 / state.a == 2) & +(state.b)) __reward = 5;"
