from collections import Counter

import pytest
from places import DATA

from aos_language.load import read_bundle_files
from aos_language.reading import files as reading
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import Project
from aos_protocol.errors import DocumentError
from aos_registry import intake as intake_module
from aos_registry.catalogue import Catalogue
from aos_registry.intake import Intake
from aos_runtime.clock import SystemClock


@pytest.fixture
def files() -> dict[str, bytes]:
    return read_bundle_files(DATA / "bundles/fetch")[0]


@pytest.fixture
def catalogue(tmp_path) -> Catalogue:
    return Catalogue.open(tmp_path / "catalogue.db")


async def test_a_push_reads_each_file_once(files: dict[str, bytes], catalogue: Catalogue, monkeypatch):
    read: Counter[str] = Counter()
    plain = reading._read

    def counted(name: str, *rest: object) -> object:
        read[name] += 1
        return plain(name, *rest)

    async def no_solver(_: Project) -> tuple[Diagnostic, ...]:
        return ()

    monkeypatch.setattr(reading, "_read", counted)
    intake = Intake(catalogue, SystemClock(), no_solver)
    report, is_new = await intake.push(files, "test")
    assert report.is_accepted
    assert is_new
    assert set(read.values()) == {1}
    name = next(name for name in files if name.endswith(".sd"))
    read.clear()
    report, _ = await intake.push({name: files[name] + b"\n"}, "test")
    assert report.is_accepted
    assert read == Counter(dict.fromkeys(files, 1)) + Counter([name])  # As it was, and as it is now.


async def test_a_finding_about_documents_that_stay_as_they_are_is_told_once(files, catalogue: Catalogue):
    async def unused(_: Project) -> tuple[Diagnostic, ...]:
        return (Diagnostic(Severity.WARNING, "AOS133", "no code uses it", Span("fetch.ef", 9)),)

    intake = Intake(catalogue, SystemClock(), unused)
    spoken = b"project: fetch\n\ndynamic_model:\n__moduleResponse = spoken;\n"
    whole, _ = await intake.push({**files, "speak.sd": spoken}, "test")
    assert [found.code for found in whole.diagnostics] == ["AOS114", "AOS133"]
    sung = {"sing.sd": spoken.replace(b"spoken", b"sung")}
    added, _ = await intake.push(sung, "test")
    assert [(found.code, found.span.file) for found in added.diagnostics] == [("AOS114", "sing.sd")]
    louder = {"sing.sd": sung["sing.sd"] + b"__reward = -1;\n"}
    changed, _ = await intake.push(louder, "test")
    assert [(found.code, found.span.file) for found in changed.diagnostics] == [("AOS114", "sing.sd")]
    mistaken = {"sing.sd": spoken.replace(b"__module", b"state__.")}
    wrong, _ = await intake.push(mistaken, "test")
    again, _ = await intake.push(mistaken, "test")
    assert wrong.diagnostics == again.diagnostics != ()
    removed, _ = await intake.remove("fetch", "sing")
    assert (removed.removed, removed.diagnostics) == (("sing",), ())
    for skill in ("speak", "look"):
        await intake.remove("fetch", skill)
    with pytest.raises(DocumentError, match="fetch has no other skill than take"):
        await intake.remove("fetch", "take")


async def test_a_project_that_is_too_large_is_refused_before_it_is_compiled(
    files: dict[str, bytes], catalogue: Catalogue, monkeypatch
):
    too_large = Diagnostic(Severity.ERROR, "AOS120", "too large", Span("doors"))
    monkeypatch.setattr(intake_module, "_too_large_for_the_bus", lambda _: too_large)
    asked: list[Project] = []

    async def compile_it(project: Project) -> tuple[Diagnostic, ...]:
        asked.append(project)
        return ()

    report, is_new = await Intake(catalogue, SystemClock(), compile_it).push(files, "test")
    assert not is_new
    assert [finding.code for finding in report.diagnostics if finding.is_error] == ["AOS120"]
    assert asked == []
