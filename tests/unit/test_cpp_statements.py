from random import Random

import pytest

from aos_language.cpp import tree
from aos_language.cpp.statements import Marks, Statement, marked


def before(statement: Statement) -> str:
    return f"@{statement.line}:{statement.column}"


def after(statement: Statement) -> str:
    return "set!" if "__reward" in statement.text else ""


MARKS = Marks(before, after, inside="in!")


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("a(); b();", "@1:1; a(); @1:6; b();"),
        ('é = "é"; b();\n  c();', '@1:1; é = "é"; @1:10; b();\n  @2:3; c();'),
        ("if (a) b(); else c();", "@1:1; if (a) { @1:8; b(); } else { @1:18; c(); }"),
        (
            "if (a) if (b) c(); else d();",
            "@1:1; if (a) { @1:8; if (b) { @1:15; c(); } else { @1:25; d(); } }",
        ),
        ("while (a)\n  b();", "@1:1; while (@1:1, a)\n  { @2:3; b(); }"),
        ("do { a(); } while (b);", "@1:1; do { @1:6; a(); } while (@1:1, b);"),
        ("for (;;) a();", "@1:1; for (;@1:1, true;) { @1:10; a(); }"),
        ("for (int i = 0; i < 3; ++i) {}", "@1:1; for (int i = 0; @1:1, i < 3; ++i) {}"),
        ("while (int a = b()) c();", "@1:1; while (int a = b()) { @1:21; c(); }"),
        ("for (auto& a : b) c();", "@1:1; for (auto& a : b) { @1:19; c(); }"),
        (
            "switch (a) { case 1: b(); break; default: c(); }",
            "@1:1; switch (a) { case 1: @1:22; b(); @1:27; break; default: @1:43; c(); }",
        ),
        ("try { a(); } catch (...) { b(); }", "@1:1; try { @1:7; a(); } catch (...) { @1:28; b(); }"),
        ("auto f = [] { return 1; };", "@1:1; auto f = [] { in!  @1:15; return 1; };"),
        ("for (;a;) __reward = 1; b();", "@1:1; for (;@1:1, a;) { @1:11; __reward = 1; set! }@1:25;  b();"),
        ("// nothing", "// nothing"),
    ],
)
def test_every_statement_has_its_mark(code, expected):
    text = marked(code, MARKS)
    assert text.replace(" ", "") == expected.replace(" ", "")


@pytest.mark.parametrize("code", ["a ? b : c", "if (a", "state.x == 1"])
def test_what_is_no_statement_is_left_alone(code):
    assert marked(code, MARKS) is None


def test_nothing_is_put_after_statements_of_a_lambda_which_may_not_see_it():
    text = marked("auto f = [&] { __reward = 1; };", MARKS)
    assert text is not None
    assert "set!" not in text


def test_any_depth_is_marked():
    text = marked("{" * 2000 + "a();" + "}" * 2000, MARKS)
    assert text is not None
    assert "@1:2001; a();" in text


def test_no_text_with_a_variable_that_is_read_as_a_function_is_passed_over():
    """The first look of `tree_of` finds each text in which its slow search finds something."""
    random = Random(1)
    found = 0
    for _ in range(3000):
        parts = [random.choice(TOKENS) + random.choice(["", " "]) for _ in range(random.randrange(12))]
        start = random.choice(["Row row", "auto& row", "A::B *row", "Row row/*c*/", "Row\nrow // c\n", ""])
        text = f"void f() {{ {random.choice(['', 'x; ', 'else '])}{start}({''.join(parts)}; }}"
        root = tree._PARSER.parse(text.encode()).root_node
        if tree._starts(root):
            found += 1
            assert tree._MAY_DECLARE.search(text.encode(), text.index("{")), text
    assert found > 50


TOKENS = [*"1:;{}()[]<>&*x,=.$\n", "row", "int", "const", "return", "else", "if", "case", "::", "->", "/*c*/"]
