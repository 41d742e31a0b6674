"""The documents of a mission: the files of each revision, and the lines that a step is about."""

import asyncio
import sqlite3
from contextlib import closing
from typing import Annotated

import msgspec

from aos_gateway.runs.run import KeptRun, Run
from aos_gateway.shared import Gateway
from aos_language.load import load_files
from aos_language.reading.picture_file import PICTURE
from aos_protocol.documents import Project, Snippet
from aos_protocol.errors import AosError, GatewayError, StorageError
from aos_protocol.messages import Catalogue, CatalogueEntry
from aos_registry.catalogue import Catalogue as KeptCatalogue
from aos_runtime.disk.journal import require_plain_tables


class DocumentFile(msgspec.Struct, frozen=True):
    """One file of a project."""

    name: str
    text: str


class Lines(msgspec.Struct, frozen=True):
    """Lines of a file, from `first` to `last`, that say something of a skill: `what` is `model`, `mapping`,
    or `rule RESPONSE`."""

    file: str
    first: int
    last: int
    what: str


class Documents(msgspec.Struct, frozen=True):
    """The files of a revision, and for each skill the lines that are its own."""

    project: str
    revision: int
    files: tuple[DocumentFile, ...]
    skills: dict[str, tuple[Lines, ...]]


class OfDocuments(msgspec.Struct, frozen=True):
    """The revision that is wanted; 0 is the newest."""

    revision: Annotated[int, msgspec.Meta(ge=0, le=2**31 - 1)] = 0


async def bundles(gateway: Gateway, run: str) -> Catalogue:
    """The projects of a run's registry, with their skills and revisions."""
    found = gateway.shelf.run(run)
    if not isinstance(found, KeptRun):
        async with found.asking() as client:
            return await client.catalogue()
    return Catalogue(await asyncio.to_thread(_entries, found))


async def documents(gateway: Gateway, mission: str, query: OfDocuments) -> Documents:
    """The documents of a mission's project, with the lines of each skill."""
    found: Run = await gateway.shelf.run_of_mission(mission)
    if not isinstance(found, KeptRun):
        raise GatewayError(f"the documents of {mission} are not on this machine")
    return await asyncio.to_thread(_documents, found, query.revision)


def _catalogue(run: KeptRun) -> KeptCatalogue:
    path = run.directory.path / "catalogue.db"
    if not path.is_file():
        raise GatewayError(f"the run {run.name} has no documents")
    try:
        connection = sqlite3.connect(path, isolation_level=None)
        connection.execute("PRAGMA query_only = ON")
        require_plain_tables(connection)
    except sqlite3.Error as error:
        raise StorageError(f"the catalogue {path}: {error}", code="AOS702") from error
    return KeptCatalogue(connection)


def picture_of(run: KeptRun, number: int) -> str | None:
    """The `picture.py` of a revision; None where its documents have none."""
    with closing(_catalogue(run)) as catalogue:
        for entry in catalogue.entries():
            found = catalogue.revision(entry.project, number)
            if found is not None:
                data = found.files.get(PICTURE)
                return data.decode("utf-8", "replace") if data is not None else None
    return None


def draws_state(run: KeptRun, number: int) -> bool:
    """Says whether a revision has a `picture.py`; False where its documents cannot be read."""
    try:
        return picture_of(run, number) is not None
    except (AosError, sqlite3.Error):
        return False


def _entries(run: KeptRun) -> tuple[CatalogueEntry, ...]:
    with closing(_catalogue(run)) as catalogue:
        return catalogue.entries()


def _documents(run: KeptRun, number: int) -> Documents:
    with closing(_catalogue(run)) as catalogue:
        names = [entry.project for entry in catalogue.entries()]
        if not names:
            raise GatewayError(f"the run {run.name} has no documents")
        found = catalogue.revision(names[0], number) if number else catalogue.current(names[0])
    if found is None:
        raise GatewayError(f"{names[0]} has no revision {number}")
    project = load_files(found.files, name=found.project).project
    files = tuple(
        DocumentFile(name, data.decode("utf-8", "replace")) for name, data in sorted(found.files.items())
    )
    skills = _lines_of(project, {file.name: file.text.count("\n") + 1 for file in files}) if project else {}
    return Documents(found.project, found.number, files, skills)


def _lines_of(project: Project, lengths: dict[str, int]) -> dict[str, tuple[Lines, ...]]:
    told = {}
    for skill in project.skills:
        model, mapping = skill.model, skill.mapping
        lines = [_of_model(model.span.file, lengths, [part.span.line for part in model.dynamic_model])]
        if not mapping.is_derived:
            lines += [
                Lines(
                    rule.span.file,
                    rule.span.line,
                    _end_of_rule(rule.span.line, rule.condition),
                    f"rule {rule.response}",
                )
                for rule in mapping.rules
            ]
        told[skill.name] = tuple(each for each in lines if each.first)
    return told


def _of_model(file: str, lengths: dict[str, int], starts: list[int]) -> Lines:
    first = min(starts, default=1)
    return Lines(file, first, lengths.get(file, first), "model")


def _end_of_rule(line: int, condition: Snippet | None) -> int:
    return max([line, *(origin.line for origin in condition.origins)]) if condition is not None else line
