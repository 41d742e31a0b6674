import asyncio
from pathlib import Path

import pytest
from hostile.counters import counting
from texts import encoded

from aos_deploy.printing import print_fault
from aos_gateway.runs.uploads import files_of_upload, keep_project
from aos_language.cpp import tree
from aos_language.cpp.snippets import read_cpp
from aos_language.findings import MAX_OF_A_SEVERITY, Findings
from aos_language.load import LoadedBundle, load_files
from aos_protocol.diagnostics import Diagnostic, Severity, Span, render
from aos_protocol.errors import DeployError, DocumentError, StorageError
from aos_registry.drops import watch_for_bundles
from aos_runtime.processes.lifecycle import root_cause


def loaded(code: str = "", **replaced: str) -> LoadedBundle:
    files = counting("lamp", "press", code=code, steps="3")
    for before, after in replaced.items():
        files = {name: text.replace(before, after) for name, text in files.items()}
    return load_files(encoded(files))


@pytest.mark.parametrize("sign", ["(", "{", "[", "#a\n", '"\n'])
def test_a_mistake_at_each_character_is_told_a_thousand_times(sign):
    found = loaded(sign * 50_000).diagnostics
    assert MAX_OF_A_SEVERITY < len(found) < MAX_OF_A_SEVERITY + 20
    assert any("the rest is not told" in one.message for one in found)
    assert {one.span.file for one in found} == {"press.sd"}


def test_many_warnings_hide_no_error():
    findings = Findings()
    for column in range(3000):
        findings.warning("AOS127", "odd", Span("a.sd", 1, column))
    findings.error("AOS106", "wrong", Span("a.sd", 2))
    assert findings.has_errors
    assert findings.sorted()[-1].message == "wrong"


def test_raw_strings_that_are_never_closed_are_one_mistake():
    (fault,) = read_cpp('R"x(' * 100_000).faults
    assert "never closed" in fault.message
    assert not read_cpp('state.name = R"x(a " ( { )y" )x";').faults


def test_code_that_takes_the_parser_long_is_a_mistake(monkeypatch):
    monkeypatch.setattr(tree, "MAX_CPU_S", 0.05)
    code = "".join(f"foo{number}: 1\n" for number in range(5000))
    (fault,) = read_cpp(code).faults
    assert fault.message == "this code takes too long to read"
    assert not read_cpp("__reward = 1;\n" * 1000).faults


@pytest.mark.parametrize("horizon", ["0", "1e300", "10001", "1.5", "9" * 5000])
def test_a_horizon_that_no_search_has_is_refused_at_its_line(horizon):
    (found,) = [one for one in loaded(**{"horizon: 2": f"horizon: {horizon}"}).diagnostics if one.is_error]
    assert (found.code, found.span.file, found.span.line) == ("AOS106", "lamp.ef", 2)


@pytest.mark.parametrize("name", ["a\n.zip", "a\x1b[2J.sd", "a\0.zip", "é" * 190 + ".zip", "\u202e.sd"])
def test_an_upload_with_a_name_that_no_file_has_is_refused(name):
    with pytest.raises(DocumentError, match="a name that no document has") as caught:
        files_of_upload(name, b"project: p\n")
    assert caught.value.message.isprintable()


def test_projects_whose_names_look_alike_are_kept_apart(tmp_path):
    names = ["éé", "öö", "--", "..", "x" * 100, "x" * 101]
    kept = {keep_project(tmp_path, name, {}).deploy_file for name in names}
    assert len(kept) == len(names)
    assert all(Path(file).resolve().is_relative_to(tmp_path.resolve() / "projects") for file in kept)
    assert keep_project(tmp_path, "errand", {}).project == "errand"


def test_what_commands_a_terminal_is_spelt_out_in_messages(capsys):
    found = Diagnostic(
        Severity.ERROR,
        "AOS110",
        "no \x1b[2J name\na.sd:1:1: all is well",
        Span("a.sd", 1, 1),
        excerpt="x\x1b[2J",
    )
    assert render(found).splitlines() == [
        "a.sd:1:1: error[AOS110]: no \\x1b[2J name",
        "    a.sd:1:1: all is well",
        "  1 | x\ufffd[2J",
        "    | ^",
    ]
    print_fault("aos", DeployError("no \x1b]0;x\x07 file", code="AOS801", diagnostics=(found,) * 300))
    said = capsys.readouterr().err
    assert "\x1b" not in said
    assert "and 100 more" in said


async def test_a_watched_folder_that_cannot_be_looked_into_is_told(tmp_path):
    async def take(_: Path):
        raise AssertionError

    with pytest.raises(BaseExceptionGroup) as caught:
        await watch_for_bundles(tmp_path / "none", take, asyncio.Queue(), quiet_s=0.1)
    cause = root_cause(caught.value)
    assert isinstance(cause, StorageError)
    assert "none cannot be watched" in cause.message
