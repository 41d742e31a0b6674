import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aos_language.cpp.snippets import (
    Access,
    DeclarationKind,
    FaultKind,
    read_cpp,
    read_cpp_expression,
    strip_comments,
)
from aos_language.cpp.tokens import cut
from aos_protocol.documents import line_and_column


def mentions(code: str) -> list[tuple[str, Access]]:
    return [(mention.text, mention.access) for mention in read_cpp(code).mentions]


@pytest.mark.parametrize(
    ("code", "text", "access"),
    [
        ("state__.robotLocation.discrete = 1;", "state__.robotLocation.discrete", Access.WRITE),
        ("x = state__.robotLocation.discrete;", "state__.robotLocation.discrete", Access.READ),
        ("state__.s += 2;", "state__.s", Access.UPDATE),
        ("state__.count++;", "state__.count", Access.UPDATE),
        ("state__.visitedObjects[i]->visited = true;", "state__.visitedObjects[].visited", Access.WRITE),
        ("state.grid.push_back(3);", "state.grid", Access.UPDATE),
        ("int n = state.grid.size();", "state.grid", Access.READ),
        ("auto& r = state__.robot;", "state__.robot", Access.BIND),
        ("state__.grid.at(1).at(i) = 3;", "state__.grid", Access.WRITE),
        ("state__.grid.at(1).push_back(3);", "state__.grid", Access.UPDATE),
        ("state__.boxes.back().weight = 1;", "state__.boxes", Access.WRITE),
        ("state__.boxes.at(state.i).weight = 1;", "state.i", Access.READ),
        ("const auto& r = state__.robot;", "state__.robot", Access.READ),
        ("for (auto& cell : state__.grid) cell = 0;", "state__.grid", Access.BIND),
        ("std::swap(state__.a, b);", "state__.a", Access.BIND),
        ("state__.m[make_tuple(1, 2)] = 3;", "state__.m[]", Access.WRITE),
        ("(flag ? state__.a : state__.b) = 1;", "state__.b", Access.WRITE),
        ("Row row(amount * 2, state.count);", "amount", Access.READ),
        ("vector<int>row(amount * 2);", "amount", Access.READ),
        ("if (a) { decltype(a)row(amount); }", "amount", Access.READ),
        ("Row\n*row (amount);", "amount", Access.READ),
        ("Row row(nearest(amount));", "nearest", Access.CALL),
        ("for (int n(std::max(low, high)); n > 0;) n--;", "high", Access.READ),
    ],
)
def test_an_access_path_says_what_happens_to_it(code, text, access):
    assert (text, access) in mentions(code)


def test_names_in_subscripts_and_arguments_are_read_on_their_own():
    assert ("i", Access.READ) in mentions("state__.grid[i] = 1;")
    assert ("oDestination.x", Access.READ) in mentions("double d = pow(oDestination.x, 2);")


def test_calls_have_names_and_the_text_of_their_arguments():
    code = "x = AOS.SampleDiscrete(Ending, {0.5, 0.5}) + AOSUtils::Bernoulli(f(1, 2));"
    cpp = read_cpp(code)
    found = [(call.name, [code[a.start : a.end] for a in call.arguments]) for call in cpp.calls]
    assert found == [
        (("AOS", "SampleDiscrete"), ["Ending", "{0.5, 0.5}"]),
        (("AOSUtils", "Bernoulli"), ["f(1, 2)"]),
        (("f",), ["1", "2"]),
    ]


def test_an_assignment_knows_what_it_assigns():
    code = "if (ok) __moduleResponse = a ? eA : eB; else other = 1;"
    (mention,) = [m for m in read_cpp(code).mentions if m.path == ("__moduleResponse",)]
    assert code[mention.assigned.start : mention.assigned.end] == "a ? eA : eB"


def test_declarations_of_variables_enums_and_lambda_parameters_are_found():
    code = "enum Ending { Good, Bad }; int a = 1, b; auto f = [&](int const& cell) { return cell; };"
    found = {(d.name, d.kind) for d in read_cpp(code).declarations}
    assert {
        ("Ending", DeclarationKind.ENUM),
        ("Good", DeclarationKind.ENUMERATOR),
        ("a", DeclarationKind.VARIABLE),
        ("b", DeclarationKind.VARIABLE),
        ("cell", DeclarationKind.PARAMETER),
    } <= found


def test_missing_semicolons_are_located_and_can_be_put_in():
    cpp = read_cpp("if (a) {x = f()}\ny = 2  // last")
    assert cpp.replace([(offset, ";") for offset in cpp.missing_semicolons]) == (
        "if (a) {x = f();}\ny = 2;  // last"
    )


def test_a_replacement_does_not_touch_what_lies_around_it():
    cpp = read_cpp('s = "eA"; r = eA;')
    edits = [(m.root, "pick_eA") for m in cpp.mentions if m.path == ("eA",)]
    assert cpp.replace(edits) == 's = "eA"; r = pick_eA;'


def test_overlapping_edits_are_refused():
    cpp = read_cpp("abc = 1;")
    (mention,) = cpp.mentions
    with pytest.raises(ValueError, match="overlap"):
        cpp.replace([(mention.extent, "x"), (1, "y")])


def test_places_count_characters_also_behind_wide_ones():
    code = '// größer\nstring s = "naïve"; state.x = 1;'
    (mention,) = [m for m in read_cpp(code).mentions if m.text == "state.x"]
    assert line_and_column(code, mention.extent.start) == (2, 21)


@pytest.mark.parametrize(
    ("code", "kind", "line", "column"),
    [
        ("a = (b;", FaultKind.BRACKET, 1, 5),
        ("}\n", FaultKind.BRACKET, 1, 1),
        ("f(]);", FaultKind.BRACKET, 1, 3),
        ('s = "abc;\nt = 1;', FaultKind.QUOTE, 1, 5),
        ("c = 'x;", FaultKind.QUOTE, 1, 5),
        ("/* a", FaultKind.COMMENT, 1, 1),
        ("x = 1;\n  #line 4", FaultKind.PREPROCESSOR, 2, 3),
        ("%:define X", FaultKind.PREPROCESSOR, 1, 1),
        ("x = 1; \\\n y = 2;", FaultKind.PREPROCESSOR, 1, 8),
        ("a<%", FaultKind.BRACKET, 1, 2),
    ],
)
def test_what_could_leave_the_function_is_found(code, kind, line, column):
    fault = cut(code).faults[0]
    assert (fault.kind, *line_and_column(code, fault.extent.start)) == (kind, line, column)


@pytest.mark.parametrize(
    "code",
    [
        "s = \")\"; c = '('; // (\n/* { */ x = 1;",
        's = R"x( " ( )x";',
        "int n = 1'000'000;",
        "char c = '\\''; s = \"\\\"(\";",
        "// a comment that goes on \\\n ( still the comment",
        "vector<::std::string> v;",
    ],
)
def test_brackets_in_literals_and_comments_do_not_count(code):
    assert cut(code).faults == ()


def test_comments_are_blanked_and_offsets_stay():
    assert strip_comments("a /* x\ny */ b // c") == "a     \n     b     "


def test_a_comment_alone_is_empty():
    assert read_cpp("// nothing").is_empty
    assert not read_cpp("x = 1;").is_empty


def test_an_expression_is_read_as_one():
    cpp = read_cpp_expression("state.a == eX && !state.b")
    assert [mention.text for mention in cpp.mentions] == ["state.a", "eX", "state.b"]
    assert cpp.faults == ()


@settings(max_examples=150, deadline=None)
@given(st.text(alphabet="ab.={}()[];,\"'\\/*#<>?:&+- \n0é\ud800"))
def test_any_text_can_be_read(code: str):
    for cpp in (read_cpp(code), read_cpp_expression(code)):
        for mention in cpp.mentions:
            assert 0 <= mention.extent.start < mention.extent.end <= len(code)
