import pytest

from aos_language.cpp.snippets import read_cpp
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Snippet
from aos_solver.emission.program import Piece
from aos_solver.emission.rewriting.rewrite import Rewriting, rewrite

NAMES = Rewriting(
    frozenset({"tBox"}),
    {"tColour": None, "Odd": ("Odd::three", "Odd::seven")},
    frozenset({"eRed"}),
    frozenset({"slips"}),
)


def rewritten(code: str) -> str:
    return piece_of(code).text


def piece_of(code: str) -> Piece:
    origins = tuple(Span("a.sd", number, 1) for number in range(10, 11 + code.count("\n")))
    snippet = Snippet(code, origins)
    return Piece(1, snippet, *rewrite(read_cpp(code), NAMES, {}))


@pytest.mark.parametrize(
    "code",
    [
        "state__.x = state.y ? AOS.Bernoulli(0.5) : false;",
        "e = AOS.SampleDiscrete(enumEnding, {0.5, 0.5});",
        "vector<int> values{1, n}; n = AOS.SampleDiscrete(values, {0.5, 0.5});",
        'note = "AOSUtils::x state.tBoxObjects";  // AOS.SampleDiscrete(tColour, {1})',
        "state.tColourObjects.size();",
        "vector<int> a{1, 2}; a.at(0) = 3;",
        "vector<int> a{1, 2}; sort(a.begin(), a.end());",
        "vector<int> a{1, n};",
        "vector<double> w{0.2, 0.8}; use(w);",
        "const vector<int> a{1, 2}; auto f = [a] { return a.size(); };",
        "n = AOS.SampleDiscrete(vector<double>{0.2, n});",
        "const tBox* box = other; int* n = 0;",
        "auto f = [&, m] { return AOS.Bernoulli(0.5); }; auto g = [=] { return n; };",
        "vector<int> local; vector<int>& row = local;",
        "auto f = [](const vector<int>& a) {}; f({1, 2}); f(state__.row); state__.row = {3};",
        "auto f = [](const vector<int>& a) {}; f(state__.row); all_of(f); state__.row = {3};",
        "auto f = [](const vector<int>& a, int i) {}; f(state.row, 1); state.row.size();",
        "auto f = [](const vector<int>& a) { auto b = a; }; f(state__.row); state__.row = {3};",
    ],
)
def test_plain_code_stands_as_it_is(code):
    assert rewritten(code) == code


@pytest.mark.parametrize(
    ("code", "text"),
    [
        ("x = 1", "x = 1;"),
        ("if (a) {x = f()}", "if (a) {x = f();}"),
        ("b = AOSUtils::Bernoulli(0.1);", "b = AOSUtils.Bernoulli(0.1);"),
        ("n = state__.tBoxObjects.size();", "n = state__.tBoxObjects().size();"),
        ("state.tBoxObjects[i]->x;", "state.tBoxObjects()[i]->x;"),
        ("std::vector<bool>::reference b = state__.b[f];", "auto&& b = state__.b[f];"),
        ("vector<int>& row = state__.row;", "auto& row = state__.row;"),
        ("auto f = [&](int i, const vector<int>& a) {}; f(1, state__.row); state__.row = {3};",
         "auto f = [&](int i, const auto& a) {}; f(1, state__.row); state__.row = {3};"),
        ("auto f = [&](string& s, int i) { s += i; };", "auto f = [&](auto& s, int i) { s += i; };"),
        ("vector<int> a{1, eRed}; n = a[0];", "static const vector<int> a{1, eRed}; n = aos::at(a, 0);"),
        ("vector<double> w{0.2, 0.8}; n = AOS.SampleDiscrete(w);",
         "static const vector<double> w{0.2, 0.8}; n = AOS.SampleDiscrete(w);"),
        ("const vector<int> a{1, 2}; auto b = a;", "static const vector<int> a{1, 2}; auto b = a;"),
        ("n = AOSUtils::SampleDiscrete(vector<double>{0.2, 0.8});",
         "n = AOSUtils.SampleDiscrete({0.2, 0.8});"),
        ("c = AOS.SampleDiscrete(tColour, std::vector<double>{1, 2});",
         "c = AOS.template SampleDiscrete<tColour>({1, 2});"),
        ("state->x = 1;", "state.x = 1;"),
        ("auto all = state.tBoxObjects;", "auto all = aos::listed(state.tBoxObjects());"),
        ("auto& all = state.tBoxObjects;", "auto& &all = state.tBoxObjects();"),
        ("auto f = [n](double p) { return AOS.Bernoulli(p); };",
         "auto f = [n, &AOS](double p) { return AOS.Bernoulli(p); };"),
        ("auto f = [] { return AOSUtils::Bernoulli(row[i] (2)); };",
         "auto f = [&AOSUtils] { return AOSUtils.Bernoulli(aos::at(row, i) (2)); };"),
        ("if (a && row[i]) n = grid.rows[y].back();",
         "if (a && aos::at(row, i)) n = aos::filled(aos::at(grid.rows, y)).back();"),
        ("all.pop_back(); end = &row[2][9]; n = f(x)[k];",
         "aos::filled(all).pop_back(); end = &aos::at(row, 2)[9]; n = aos::at(f(x), k);"),
        ("n = *row.begin() + *std::max_element(row.begin(), row.end()); v.begin()->x = 1; i = row.begin();",
         "n = *aos::filled(row).begin() + *std::max_element(aos::filled(row).begin(), row.end());"
         " aos::filled(v).begin()->x = 1; i = row.begin();"),
        ("n = *std::ranges::min_element(state.row) + *f(x).begin() + *p->begin();",
         "n = *std::ranges::min_element(aos::filled(state.row)) + *f(x).begin() + *p->begin();"),
        ("b = slips(odds[i][0]);", "b = slips(AOS, aos::at(aos::at(odds, i), 0));"),
        ("std::vector<tBox*> a = state__.tBoxObjects; n = state.tBoxObjects.size();",
         "std::vector<tBox*> a = state__.tBoxObjects(); n = state.tBoxObjects().size();"),
        ("vector<tBox*> a{&state__.one}; auto b = state.tBoxObjects[0];",
         "vector<tBox*> a{&state__.one}; auto b = state.tBoxObjects()[0];"),
        ("for (tBox* box : state.tBoxObjects) n++;", "for (auto* box : state.tBoxObjects()) n++;"),
        ("for (auto&& a : state.tBoxObjects) for (tBox*& b : all) f = [](int i, auto& c) { c = 1; };",
         "for (auto&& a : state.tBoxObjects()) for (auto&& b : all) f = [](int i, auto&& c) { c = 1; };"),
        ("tBox* a[2] = {&state.one, &state.two};",
         "aos::Pointer<tBox, decltype(state)> a[2] = {&state.one, &state.two};"),
        ("auto f = [](tBox* box) { return box->x; };", "auto f = [](auto* box) { return box->x; };"),
        ("c = AOS.SampleDiscrete(tColour, {1, 2});", "c = AOS.template SampleDiscrete<tColour>({1, 2});"),
        ("{c = AOS.SampleDiscrete(tColour, {1})}", "{c = AOS.template SampleDiscrete<tColour>({1});}"),
        (
            "c = AOS.SampleDiscrete /* ( */ (tColour,  // ,\n{1, 2});",
            "c = AOS.template SampleDiscrete /* ( */ <tColour>(// ,\n{1, 2});",
        ),
        (
            "o = AOS.SampleDiscrete(Odd, {1, 1});",
            "o = AOS.SampleOf({Odd::three, Odd::seven}, {1, 1});",
        ),
    ],
)  # fmt: skip
def test_what_documents_may_write_becomes_cpp(code, text):
    assert rewritten(code) == text


def test_columns_lead_back_through_edits():
    piece = piece_of("x = 1;\nc = AOS.SampleDiscrete(tColour, {wrong, 2}) + bad;")
    line = piece.text.split("\n")[1]
    for word in ("wrong", "bad", "AOS"):
        column = line.index(word) + 1
        source = piece.snippet.code.split("\n")[1].index(word) + 1
        assert piece.locate(2, column) == Span("a.sd", 11, source)


def test_a_column_in_an_edit_leads_to_the_edited_place():
    piece = piece_of("c = AOS.SampleDiscrete(tColour, {1, 2});")
    assert piece.locate(1, piece.text.index("template") + 3) == Span("a.sd", 10, 9)
    assert piece.locate(1, piece.text.index("tColour") + 3) == Span("a.sd", 10, 26)
