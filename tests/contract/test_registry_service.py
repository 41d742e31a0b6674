import asyncio
import shutil
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import msgspec
import pytest
import pytest_asyncio
from places import BUNDLES
from processes import HANG_S
from starting import until_present

from aos_protocol import messages
from aos_protocol.diagnostics import Diagnostic, Severity, Span, render
from aos_protocol.errors import DocumentError
from aos_protocol.keys import Keys
from aos_registry.settings import Settings
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.children import Child


def written_settings(settings: Settings) -> Path:
    path = Path(settings.run_dir) / "registry.json"
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(msgspec.json.encode(settings))
    return path


@asynccontextmanager
async def running_registry(
    run_dir: Path, endpoint: str, bus: Bus, keys: Keys, *, quiet_s: float = 0.1
) -> AsyncIterator[Child]:
    settings = Settings(
        robot="test", service="registry", endpoint=endpoint, run_dir=str(run_dir), quiet_s=quiet_s
    )
    path = written_settings(settings)
    async with until_present(bus, keys.live("registry")):
        child = await Child.start(
            [sys.executable, "-m", "aos_registry", str(path)], env={"AOS_LOG": "CRITICAL"}
        )
    try:
        yield child
    finally:
        await child.stop(5.0)


@pytest_asyncio.fixture
async def registry(tmp_path, endpoint: str, bus: Bus, keys: Keys) -> AsyncIterator[Path]:
    async with running_registry(tmp_path / "run", endpoint, bus, keys):
        yield tmp_path / "run"


async def push(bus: Bus, keys: Keys, files: dict[str, bytes]) -> messages.BundleReport:
    return await bus.ask(
        keys.push_bundle, messages.PushBundle(files, "test"), messages.BundleReport, timeout_s=HANG_S
    )


def errors(report: messages.BundleReport) -> list[Diagnostic]:
    return [diagnostic for diagnostic in report.diagnostics if diagnostic.is_error]


def codes(report: messages.BundleReport) -> set[str]:
    return {error.code for error in errors(report)}


def drop(registry: Path, name: str, files: dict[str, bytes]):
    folder = registry / name
    folder.mkdir()
    for file, data in files.items():
        (folder / file).write_bytes(data)
    folder.rename(registry / "drop" / name)


async def current(bus: Bus, keys: Keys, project: str = "armadillo") -> messages.ProjectRevision:
    return await bus.ask(
        keys.project, messages.ProjectQuery(project), messages.ProjectRevision, timeout_s=HANG_S
    )


async def test_a_pushed_bundle_is_announced_listed_and_given_to_whoever_asks(
    registry: Path, bus: Bus, keys: Keys, finer: dict[str, bytes]
):
    async with asyncio.timeout(HANG_S), bus.listen(keys.announced, messages.ProjectRevision) as announced:
        report = await push(bus, keys, finer)
        assert report.is_accepted
        assert report.revision == 1
        assert set(report.added) == {name[:-3] for name in finer if name.endswith(".sd")}
        async for _, revision in announced:
            assert revision == await current(bus, keys)
            assert revision == await current(bus, keys, project="")
            break
    catalogue = await bus.ask(keys.catalogue, messages.CatalogueQuery(), messages.Catalogue, timeout_s=HANG_S)
    (entry,) = catalogue.entries
    assert (entry.project, entry.revision, entry.skills) == ("armadillo", 1, tuple(sorted(report.added)))


async def test_a_skill_can_be_pushed_on_its_own_and_a_better_document_replaces_the_old_one(
    registry: Path, bus: Bus, keys: Keys, finer: dict[str, bytes]
):
    observe = {name: finer.pop(name) for name in list(finer) if name.startswith("observe_holding")}
    await push(bus, keys, finer)
    report = await push(bus, keys, observe)
    assert (report.is_accepted, report.revision, report.added) == (True, 2, ("observe_holding",))
    rough_pick = (BUNDLES / "armadillo-rough" / "pick.sd").read_bytes()
    report = await push(bus, keys, {"pick.sd": rough_pick})
    assert (report.revision, report.added, report.changed) == (3, (), ("pick",))
    assert len((await current(bus, keys)).project.skills) == 5


async def test_a_bad_bundle_changes_nothing_and_says_where(
    registry: Path, bus: Bus, keys: Keys, finer: dict[str, bytes]
):
    await push(bus, keys, finer)
    before = await current(bus, keys)
    broken = finer["pick.sd"].replace(b"__reward = -2;", b"__reward = (-2;")
    report = await push(bus, keys, {"pick.sd": broken})
    assert (report.is_accepted, report.revision) == (False, 1)
    (error,) = errors(report)
    assert str(error.span) == "pick.sd:28:12"
    assert await current(bus, keys) == before
    files = {name: finer[name].replace(b"armadillo", b"armadilo") for name in ("pick.sd", "pick.am")}
    report = await push(bus, keys, files)
    assert not report.is_accepted
    assert any("Did you mean `armadillo`?" in diagnostic.hint for diagnostic in report.diagnostics)


async def test_the_solver_is_asked_and_its_complaint_refuses_the_bundle(
    registry: Path, bus: Bus, other: Bus, keys: Keys, finer: dict[str, bytes]
):
    complaint = Diagnostic(Severity.ERROR, "AOS201", "no such function", Span("pick.sd", 28, 1))

    async def refuse(question: messages.CheckModel, key: str) -> messages.ModelCheck:
        assert question.project.name == "armadillo"
        return messages.ModelCheck((complaint,))

    await other.answer(keys.check_model, messages.CheckModel, refuse)
    report = await push(bus, keys, finer)
    assert not report.is_accepted
    assert [render(error) for error in errors(report)] == [
        "pick.sd:28:1: error[AOS201]: no such function\n  28 | __reward = -2;\n     | ^"
    ]
    with pytest.raises(DocumentError, match="the catalogue is empty"):
        await current(bus, keys)


async def test_documents_that_a_dying_solver_was_asked_about_are_not_accepted_unchecked(
    registry: Path, bus: Bus, endpoint: str, keys: Keys, finer: dict[str, bytes]
):
    solver = await Bus.open(endpoint, sender="solver")

    async def never(_: messages.CheckModel, __: str) -> messages.ModelCheck:
        leaving.append(asyncio.create_task(solver.close()))
        await asyncio.Event().wait()
        return messages.ModelCheck(())

    leaving: list[asyncio.Task[None]] = []
    await solver.answer(keys.check_model, messages.CheckModel, never)
    report = await push(bus, keys, finer)
    await leaving[0]
    assert not report.is_accepted
    assert codes(report) == {"AOS607"}


async def test_a_dropped_folder_is_taken_in_once_it_is_complete(
    tmp_path, endpoint: str, bus: Bus, keys: Keys
):
    registry = tmp_path / "run"
    async with (
        asyncio.timeout(HANG_S),
        # A copy pauses on a busy machine.
        running_registry(registry, endpoint, bus, keys, quiet_s=0.5),
        bus.listen(keys.bundle_report, messages.BundleReport) as reports,
    ):
        shutil.copytree(BUNDLES / "armadillo-finer", registry / "drop" / "armadillo")
        async for _, report in reports:
            if report.is_waiting:
                continue  # It has paused for longer.
            assert (report.is_accepted, report.revision, report.source) == (True, 1, "armadillo")
            break
        (registry / "drop" / "armadillo" / "pick.sd").write_text(
            "project: armadillo\nprecondition:\nx = (;\n"
        )
        async for _, report in reports:
            assert (report.is_accepted, report.revision) == (False, 1)
            assert codes(report) == {"AOS105", "AOS108"}
            break


async def test_a_drop_that_waits_is_told_again_only_when_the_answer_is_new(
    registry: Path, bus: Bus, other: Bus, keys: Keys, finer: dict[str, bytes]
):
    pick = {name: finer.pop(name) for name in list(finer) if name.startswith("pick")}
    async with asyncio.timeout(HANG_S), other.listen(keys.bundle_report, messages.BundleReport) as reports:
        sequence = aiter(reports)
        drop(registry, "half", {"pick.am": pick["pick.am"]})
        waits = (await anext(sequence))[1]  # for an environment
        assert (waits.is_accepted, waits.is_waiting, waits.source) == (False, True, "half")
        assert "AOS115" in codes(waits)
        pushed = await push(bus, keys, finer)
        second = (await anext(sequence))[1], (await anext(sequence))[1]
        assert (second[0], second[1].source, second[1].is_waiting) == (pushed, "half", True)
        assert codes(second[1]) == {"AOS114"}  # its skill document
        request = messages.RemoveDocuments("armadillo", "serve")
        removed = await bus.ask(keys.remove_bundle, request, messages.BundleReport, timeout_s=HANG_S)
        await push(bus, keys, pick)
        rest = [(await anext(sequence))[1] for _ in range(3)]
        assert (rest[0], removed.removed) == (removed, ("serve",))
        assert [(report.source, report.is_accepted) for report in rest[1:]] == [
            ("test", True),
            ("half", True),
        ]
        assert (await current(bus, keys)).revision == rest[2].revision


async def test_of_a_folder_from_before_nothing_is_told_before_the_project_and_an_archive_is_taken_in(
    tmp_path, endpoint: str, bus: Bus, keys: Keys, finer: dict[str, bytes]
):
    drops = tmp_path / "run" / "drop"
    drops.mkdir(parents=True)
    drop(drops.parent, "half", {"sing.am": finer["pick.am"]})
    async with (
        asyncio.timeout(HANG_S),
        bus.listen(keys.bundle_report, messages.BundleReport) as reports,
        running_registry(drops.parent, endpoint, bus, keys),
    ):
        shutil.make_archive(str(drops / "whole"), "zip", BUNDLES / "armadillo-finer")
        told = [(await anext(aiter(reports)))[1] for _ in range(2)]
    assert [(report.source, report.revision, report.is_waiting) for report in told] == [
        *(("whole.zip", 1, False), ("half", 1, True))
    ]


async def test_documents_beside_the_bundles_of_the_watched_folder_are_one_bundle(
    registry: Path, bus: Bus, other: Bus, keys: Keys, finer: dict[str, bytes]
):
    without_pick = {name: content for name, content in finer.items() if not name.startswith("pick")}
    async with asyncio.timeout(HANG_S), other.listen(keys.bundle_report, messages.BundleReport) as reports:
        drop(registry, "armadillo", without_pick)
        first = (await anext(aiter(reports)))[1]
        (registry / "drop" / "pick.am").write_bytes(finer["pick.am"])
        alone = (await anext(aiter(reports)))[1]
        (registry / "drop" / "pick.sd").write_bytes(finer["pick.sd"])
        both = (await anext(aiter(reports)))[1]
    assert [(told.source, told.revision, told.is_waiting) for told in (first, alone, both)] == [
        *(("armadillo", 1, False), ("drop", 1, True), ("drop", 2, False))
    ]
    assert (codes(alone), both.added) == ({"AOS114"}, ("pick",))


async def test_a_document_left_in_the_watched_folder_does_not_undo_what_was_pushed_or_removed_later(
    tmp_path, endpoint: str, bus: Bus, other: Bus, keys: Keys, finer: dict[str, bytes]
):
    run_dir = tmp_path / "run"

    def put(name: str, content: bytes):
        (run_dir / name).write_bytes(content)
        (run_dir / name).rename(run_dir / "drop" / name)

    holding = finer["observe_holding.sd"] + b"\n"
    removal = messages.RemoveDocuments("armadillo", "observe_holding")
    async with asyncio.timeout(HANG_S), other.listen(keys.bundle_report, messages.BundleReport) as reports:
        told = aiter(reports)
        async with running_registry(run_dir, endpoint, bus, keys):
            drop(run_dir, "whole", finer)
            await anext(told)
            put("observe_holding.sd", holding)
            await anext(told)
            await bus.ask(keys.remove_bundle, removal, messages.BundleReport, timeout_s=HANG_S)
            await anext(told)
            put("pick.sd", finer["pick.sd"] + b"\n")
            beside = (await anext(told))[1]
        holding_again = {name: finer[name] for name in finer if name.startswith("observe_holding")}
        drop(run_dir, "meanwhile", holding_again | {"observe_holding.sd": holding + b"\n"})
        async with running_registry(run_dir, endpoint, bus, keys):
            meanwhile = (await anext(told))[1]
            stored = (await current(bus, keys)).project.skills
            assert "observe_holding.am" in {skill.mapping.span.file for skill in stored}
            put("serve.sd", finer["serve.sd"] + b"\n")
            after_restart = (await anext(told))[1]
            put("observe_holding.sd", holding)
            anew = (await anext(told))[1]
    reports_of_all = (beside, meanwhile, after_restart, anew)
    assert [(report.source, report.added, report.revision) for report in reports_of_all] == [
        ("drop", (), 4),
        ("meanwhile", ("observe_holding",), 5),
        ("drop", (), 6),
        ("drop", (), 7),
    ]


@pytest.mark.parametrize("name", ["outer", "outer.tar"])
async def test_a_dropped_bundle_without_documents_is_told(registry: Path, other: Bus, keys: Keys, name: str):
    (registry / "outer" / "inner").mkdir(parents=True)
    (registry / "outer" / "inner" / "notes.txt").write_text("none")
    if name == "outer.tar":
        shutil.make_archive(str(registry / "outer"), "tar", registry / "outer")
    async with asyncio.timeout(HANG_S), other.listen(keys.bundle_report, messages.BundleReport) as reports:
        (registry / name).rename(registry / "drop" / name)
        told = (await anext(aiter(reports)))[1]
    assert (told.source, told.is_accepted, codes(told)) == (name, False, {"AOS120"})
