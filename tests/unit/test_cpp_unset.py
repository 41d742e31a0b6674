import pytest
from lint_texts import SKILL, finding_texts

from aos_language.cpp.snippets import read_cpp
from aos_language.cpp.unset import unset_reads
from aos_protocol.documents import line_and_column

NEVER = [
    ("bool b; if (b) x = 1;", "b", 13),
    ("int x; x += 1;", "x", 8),
    ("int x; x++;", "x", 8),
    ("int n, m = 2; y = m; z = n", "n", 26),
    ("unsigned long n; y = n * 2;", "n", 22),
    ("Side s; y = s;", "s", 13),
    ("int x; y = c ? x : 2;", "x", 16),
    ("if (c) return; int k; __reward = k;", "k", 34),
    ("double p; y = AOS.Bernoulli(p);", "p", 29),
    ("int x; rows.push_back(x);", "x", 23),
    ("int x; for (int i = 0; i < x; i++) y += i;", "x", 28),
    ("int x; if (c) { int x = 1; y = x; } else { y = x; }", "x", 48),
    ("double d; while (d < 0.5) { d = AOS.SampleUniform(0, 1); }", "d", 18),
]
SOMETIMES = [
    ("bool found; for (int i = 0; i < 3; i++) if (a[i]) found = true; if (found) x = 1;", "found", 69),
    ("int x; if (c) x = 1; y = x;", "x", 26),
    ("int x; switch (m) { case 1: x = 1; break; case 2: break; } y = x;", "x", 64),
    ("int x; if (r == A) x = 1; else if (q > B) x = 2; y = x;", "x", 54),
    ("int x; while (true) { if (a) break; x = 1; if (b) break; } y = x;", "x", 64),
    ("int x; for (auto& o : list) { if (o.p) { continue; } x = 2; } y = x;", "x", 67),
]
RIGHT = [
    "bool b; b = true; if (b) x = 1;",
    "int x; if (c) x = 1; else x = 2; y = x;",
    "int x; if (c) x = 1; else return; y = x;",
    "int x; if (c) x = 1; if (c && d) y = x;",
    "int x; if (c) x = 1; y = c ? x : 0;",
    "int x; for (int i = 0; i < 3; i++) x = i; y = x;",
    "int last; for (int i = 0; i < 3; i++) { if (i > 0) y += last; last = i; }",
    "int best; bool any = false;\nfor (i = 0; i < 3; i++) if (!any || a[i] > best) best = a[i], any = true;"
    "\nif (any) y = best;",
    "int x; switch (m) { case 1: x = 1; break; case 2: x = 3; break; } y = x;",
    "int x; switch (m) { case 1: case 2: x = 1; break; default: return; } y = x;",
    "int x; if (r == A) x = 1; else if (r == B) x = 2; y = x;",
    "int x; auto f = [&]() { x = 2; }; f(); y = x;",
    "int x; draw_into(x); y = x;",
    "int x; draw_into(&x); y = x;",
    "int x; std::tie(x, z) = pair; y = x;",
    "int x; int& r = x; r = 1; y = x;",
    "double d; do { d = AOS.SampleUniform(0, 1); } while (d < 0.5); y = d;",
    "double d; while (true) { d = AOS.SampleUniform(0, 1); if (d > 0.5) break; } y = d;",
    "int x; for (auto& o : list) { if (o.p) { x = 1; continue; } x = 2; } y = x;",
    "int x; { int x = 1; y = x; }",
    "int x{}; int z(1); y = x + z;",
    "if (int n = count(state)) y = n; while (double d = next()) y += d;",
    "static int x; int row[3]; Cup cup; std::vector<int> v; y = x + row[0] + cup.size + v[0];",
    "int x; y = sizeof(x);",
    "int x; try { x = f(); } catch (...) { x = 2; } y = x;",
    "int x; if (state.side == 0) { x = 1; } else { x = 2 }\ny = x",
]


def found(code: str) -> list[tuple[str, int, bool]]:
    unset = unset_reads(read_cpp(code), frozenset({"Side"}))
    return [(variable.name, variable.extent.start + 1, variable.never) for variable in unset]


@pytest.mark.parametrize(("code", "name", "column"), NEVER)
def test_what_no_way_sets_is_told_at_its_first_read(code, name, column):
    assert found(code) == [(name, column, True)]


@pytest.mark.parametrize(("code", "name", "column"), SOMETIMES)
def test_what_some_ways_leave_without_a_value_is_told_as_that(code, name, column):
    assert found(code) == [(name, column, False)]


@pytest.mark.parametrize("code", RIGHT)
def test_what_has_or_may_well_have_a_value_is_left_alone(code):
    assert found(code) == []


def test_places_count_characters_of_the_document_before_semicolons_that_were_put_in():
    code = 'auto t = "ä"; { y = 1 }\nint x;\ny = x;'
    (unset,) = unset_reads(read_cpp(code))
    assert line_and_column(code, unset.extent.start) == (3, 5)


def test_text_that_is_nested_very_deeply_is_read_or_left():
    assert found("int x; y = " + "(" * 5000 + "x" + ")" * 5000 + ";") in ([], [("x", 5012, True)])
    assert found("int x; " + "while (c) { " * 30 + "y = x; " + "}" * 30) == []


@pytest.mark.parametrize(
    ("code", "finding"),
    [
        (
            "bool wet;\nif (wet) __reward = -1;",
            "11 AOS143 `wet` has no value here. Declare it with one: `bool wet = ...;`",
        ),
        (
            "int n;\nif (steps > 1) n = 2;\n__reward = n;",
            "12 AOS143 `n` may have no value here. Declare it with one: `int n = ...;`",
        ),
    ],
)
def test_lint_tells_it_at_its_line(code, finding):
    skill = SKILL.replace("__moduleResponse", f"{code}\n__moduleResponse")
    assert finding_texts(skill=skill) == [finding]
