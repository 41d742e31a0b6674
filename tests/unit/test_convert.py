from pathlib import Path

import pytest
from commands import aos
from dialects import converted, say_the_same
from hypothesis import given, settings
from hypothesis import strategies as st
from places import BUNDLES, ROOT
from texts import encoded

from aos_language.convert import Dialect, convert
from aos_language.load import load_files, read_bundle_files

CORPUS = [
    "armadillo-finer", "armadillo-rough", "paper-example-json", "paper-example-sdl", "sampling-rate",
    "sarsop-simple", "tic-tac-toe-json", "tic-tac-toe-sdl", "turtlebot-visit", "wildfire",
]  # fmt: skip
ENVIRONMENT = b"project: p\nhorizon: 3\nstate_variable: bool done\n"


@pytest.mark.corpus
@pytest.mark.parametrize("name", CORPUS)
def test_an_original_bundle_says_the_same_in_both_dialects(corpus: Path, name):
    say_the_same(read_bundle_files(corpus / name)[0])


def test_a_shipped_bundle_says_the_same_in_both_dialects():
    say_the_same(read_bundle_files(BUNDLES / "armadillo-finer")[0])


@pytest.mark.parametrize("dialect", ["sdl", "json"])
def test_the_language_pages_examples_say_the_same_in_both_dialects(dialect):
    say_the_same(read_bundle_files(ROOT / "docs" / "examples" / f"kettle-{dialect}")[0])


def test_file_names_come_from_the_documents_not_from_the_files():
    files, _ = read_bundle_files(ROOT / "docs" / "examples" / "kettle-json")
    sdl = converted(files, Dialect.SDL)
    assert sorted(sdl) == ["environment.ef", "environment.lf", "pour.am", "pour.sd"]
    names = [f"{name}.json" for name in sorted(sdl)]
    assert sorted(converted(files, Dialect.JSON)) == names


def test_versions_stay():
    files = {"p.ef": ENVIRONMENT.replace(b"horizon", b"version: 1.4\nhorizon")}
    assert b"version: 1.4\n" in converted(converted(files, Dialect.JSON), Dialect.SDL)["environment.ef"]


def test_a_default_that_ends_in_a_number_is_not_taken_for_a_scale():
    json = b"""{"PlpMain": {"Project": "p", "Name": "e", "Type": "Environment"},
        "EnvironmentGeneral": {"Horizon": 3, "Discount": 0.9},
        "GlobalVariableTypes": [{"TypeName": "T", "Type": "compound",
            "Variables": [{"Name": "n", "Type": "int", "Default": "2 + 5"}]}]}"""
    back = converted(converted({"e.json": json}, Dialect.SDL), Dialect.JSON)
    assert b'"Default": "2 + 5"' in back["environment.ef.json"]


def test_what_the_other_dialect_cannot_say_is_refused_where_it_stands():
    skill = b"""{"PlpMain": {"Project": "p", "Name": "s", "Type": "PLP"}, "DynamicModel":
        {"NextStateAssignments": [{"AssignmentCode": ["goto precondition;", "precondition:", "x();"]}]}}"""
    texts, findings = convert({"s.json": skill}, Dialect.SDL)
    assert texts == {}
    (error,) = [finding for finding in findings if finding.is_error]
    assert error.code == "AOS130"
    assert "s.sd" in error.message
    assert error.span.file == "s.json"


def test_a_document_with_mistakes_is_not_converted():
    texts, findings = convert({"p.ef": b"project: p\nhorizon: many\n"}, Dialect.JSON)
    assert texts == {}
    assert [finding.code for finding in findings] == ["AOS106"]


LINES = st.lists(
    st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cs", "Zl", "Zp")), max_size=40),
    max_size=6,
)


@settings(max_examples=60, deadline=None)
@given(lines=LINES)
def test_any_code_stays_as_it_is_or_is_refused(lines: list[str]):
    text = "\n".join(lines)
    texts, findings = convert({"p.ef": ENVIRONMENT + f"initial_belief:\n{text}\n".encode()}, Dialect.JSON)
    if texts:
        back, refusals = convert(encoded(texts), Dialect.SDL)
        assert back or {finding.code for finding in refusals} == {"AOS130"}
    else:
        assert any(finding.is_error for finding in findings)


def test_the_command_writes_a_new_directory_and_nothing_over_an_old_one(tmp_path):
    out = tmp_path / "json"
    arguments = ["convert", str(BUNDLES / "armadillo-finer"), "--to", "json", "--out", str(out)]
    result = aos(*arguments)
    assert result.exit_code == 0
    assert f"{out}: 11 documents" in result.stdout
    assert load_files({file.name: file.read_bytes() for file in out.iterdir()}).project is not None
    again = aos(*arguments)
    assert "is not empty" in str(again.exception)
