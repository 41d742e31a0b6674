"""Bundles in: a directory or a set of files, read, put together and checked in one run.

A pushed document replaces the one of its kind and name. Nothing raises for what a user wrote; the diagnostics
hold all of it.
"""

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_language.archive import is_archive_name, read_archive
from aos_language.assembly import Assembly, assemble
from aos_language.borrowed_imports import borrow_imports
from aos_language.check import check
from aos_language.check.models.bare_names import check_bare_names
from aos_language.findings import Findings
from aos_language.reading.document import Document, DocumentKind, is_higher
from aos_language.reading.files import (
    MAX_BUNDLE_BYTES,
    MAX_BUNDLE_FILES,
    KnownFiles,
    is_document_name,
    left_out,
    read_documents,
)
from aos_language.reading.picture_file import PICTURE
from aos_language.reading.source import open_source
from aos_protocol.diagnostics import Diagnostic, Severity, Span, has_errors
from aos_protocol.documents import Project
from aos_protocol.spelling import did_you_mean_path

_IN_CODE = frozenset({"AOS110", "AOS116", "AOS122", "AOS123", "AOS128", "AOS138", "AOS143"})
"""Errors in a model's code that leave its declarations whole, so that the compiler can tell of the rest."""
_READ_ALL_THE_SAME = frozenset({"AOS102", "AOS104"})
"""Errors that leave all whole where they have a mend: what was meant is read."""


class LoadedBundle(msgspec.Struct, frozen=True):
    """`project` is there when no diagnostic is an error. `files` gives the digest of each document's file,
    `versions` the version of each that declares one. `draft` is a project with errors of mappings and of
    single lines of model code alone, of which a compiler tells more; skills with others are not in it."""

    project: Project | None
    diagnostics: tuple[Diagnostic, ...]
    digest: str
    files: dict[str, str]
    versions: dict[str, str] = {}
    draft: Project | None = None

    @property
    def has_errors(self) -> bool:
        return has_errors(self.diagnostics)


def load_bundle(path: Path) -> LoadedBundle:
    """The bundle in a directory or an archive.

    Folders in a directory and hidden files are not part of it; a link to a file elsewhere is an error.
    """
    files, remarks = read_bundle_files(path)
    return load_files(files, name=path.name or str(path), remarks=remarks)


def load_files(
    files: Mapping[str, bytes],
    *,
    name: str = "bundle",
    remarks: Iterable[Diagnostic] = (),
    known: KnownFiles | None = None,
) -> LoadedBundle:
    """The bundle of these files, by plain file names. `name` is the place of what has no file.

    Files that are in `known` are not read again.
    """
    remarks = tuple(remarks)
    if has_errors(remarks):
        return LoadedBundle(None, remarks, "", {})
    findings = Findings()
    documents = read_documents(files, findings, known) if files else {}
    has_unread_files = findings.has_errors and any(
        is_document_name(file) and file not in documents and file != PICTURE for file in files
    )
    assembly = assemble(documents, findings, bundle=name, has_unread_files=has_unread_files)
    borrow_imports(assembly, findings)
    check(assembly, findings)
    errors = [found for found in findings.sorted() if found.is_error]
    project = None if errors else assembly.project()
    draft = _draft(documents, assembly, errors) if errors else None
    if errors:
        check_bare_names(assembly, draft, findings)
    kept = [*documents, *([PICTURE] if PICTURE in files else [])]
    digests = {file: hashlib.sha256(files[file]).hexdigest() for file in kept}
    versions = {
        file: document.version.text for file, document in documents.items() if document.version is not None
    }
    digest = bundle_digest(files, kept)
    return LoadedBundle(project, (*remarks, *findings.sorted()), digest, digests, versions, draft)


def _draft(
    documents: Mapping[str, Document], assembly: Assembly, errors: Iterable[Diagnostic]
) -> Project | None:
    """The project without the skills whose declarations are wrong, and without mappings of monitors that are
    not there; None where other declarations are wrong."""
    wrong = set()
    for file in {found.span.file for found in errors if not _leaves_declarations(found)}:
        document = documents.get(file)
        if document is None or document.kind in (DocumentKind.ENVIRONMENT, DocumentKind.LOW_LEVEL):
            return None
        if document.kind is DocumentKind.SKILL:
            wrong.add(document.name)
    models = {name: model for name, model in assembly.models.items() if name not in wrong}
    mappings = {name: mapping for name, mapping in assembly.mappings.items() if name in models}
    known = {model.name for model in assembly.environment.monitors} if assembly.environment else ()
    monitors = {name: mapping for name, mapping in assembly.monitors.items() if mapping.monitor in known}
    draft = replace(assembly, models=models, mappings=mappings, monitors=monitors)
    return draft.project()


def _leaves_declarations(found: Diagnostic) -> bool:
    return found.code in _IN_CODE or (found.code in _READ_ALL_THE_SAME and found.mend is not None)


def bundle_digest(files: Mapping[str, bytes], documents: Iterable[str]) -> str:
    """One digest over the documents' names and bytes, whatever the order."""
    whole = hashlib.sha256()
    for file in sorted(documents):
        whole.update(f"{len(file)}:{file}:{len(files[file])}:".encode())
        whole.update(files[file])
    return whole.hexdigest()


def with_excerpts(diagnostics: Iterable[Diagnostic], files: Mapping[str, bytes]) -> tuple[Diagnostic, ...]:
    """Diagnostics of another service with the source lines they are about."""
    diagnostics = tuple(diagnostics)
    findings = Findings()
    for name in {diagnostic.span.file for diagnostic in diagnostics} & files.keys():
        source = open_source(name, files[name], Findings())
        if source is not None:
            findings.add_source(name, source.lines)
    for diagnostic in diagnostics:
        findings.add(diagnostic)
    return findings.sorted()


def read_bundle_files(path: Path) -> tuple[dict[str, bytes], list[Diagnostic]]:
    """The files of a directory or an archive, and a remark for each thing in it that is left out."""
    if is_archive_name(path.name) and path.is_file():
        return read_archive(path)
    files: dict[str, bytes] = {}
    remarks: list[Diagnostic] = []
    try:
        entries = sorted(path.iterdir())
    except OSError as error:
        reason = error.strerror or "cannot be read"
        hint = "A bundle is a directory with .ef, .sd, .am, .lf or .json files, or an archive of one"
        if close := did_you_mean_path(path):
            hint = close
        elif path.suffix.lower() in (".pomdp", ".pomdpx"):
            hint += f". Such a file is for `aos solve {path}`"
        elif path.suffix in (".yaml", ".yml"):
            hint += f". {path.name} may name some under `bundles:`"
        elif is_document_name(path.name) and path.is_file():
            hint += f". That of {path.name} is {path.parent}"
        return {}, [Diagnostic(Severity.ERROR, "AOS101", reason, Span(str(path)), hint)]
    total = 0
    for entry in entries:
        if entry.name.startswith("."):
            continue
        if entry.is_symlink() and not entry.resolve().is_relative_to(path.resolve()):
            hint = "Put the file itself into the bundle"
            message = "this link leads out of the bundle"
            remarks.append(Diagnostic(Severity.ERROR, "AOS120", message, Span(entry.name), hint))
            continue
        if entry.is_dir():
            message, span = "a folder inside a bundle", Span(entry.name)
            remarks.append(Diagnostic(Severity.REMARK, "AOS107", message, span, "It is left out"))
            continue
        if not is_document_name(entry.name) or not entry.is_file():
            remarks.append(left_out(entry.name))
            continue
        try:
            total += entry.stat().st_size
            if total > MAX_BUNDLE_BYTES or len(files) >= MAX_BUNDLE_FILES:
                message = f"more than {MAX_BUNDLE_FILES} files or {MAX_BUNDLE_BYTES} bytes"
                remarks.append(Diagnostic(Severity.ERROR, "AOS120", message, Span(entry.name)))
                break
            files[entry.name] = entry.read_bytes()
        except OSError as error:
            reason = error.strerror or "cannot be read"
            remarks.append(Diagnostic(Severity.ERROR, "AOS101", reason, Span(entry.name)))
    return files, remarks


class MergedFiles(msgspec.Struct, frozen=True):
    """The files a project has after a push, before they are checked."""

    files: dict[str, bytes]
    diagnostics: tuple[Diagnostic, ...] = ()


def pushed_project(files: Mapping[str, bytes], known: KnownFiles | None = None) -> str:
    """The project that files belong to: the environment's, else the first named; empty where none is."""
    documents = [
        document for document in read_documents(files, Findings(), known).values() if document.project
    ]
    leading = [d for d in documents if d.kind is DocumentKind.ENVIRONMENT] or documents
    return leading[0].project if leading else ""


def merge(
    current: Mapping[str, bytes], new: Mapping[str, bytes], known: KnownFiles | None = None
) -> MergedFiles:
    """`new` over `current`. A file that is new under the name of another document is refused.

    Files that are no documents are left out; documents that cannot be read are kept, so that checking the
    result reports them.
    """
    current_documents = read_documents(current, Findings(), known) if current else {}
    new_documents = read_documents(new, Findings(), known) if new else {}
    identities = {document.identity for document in new_documents.values() if _has_name(document)}
    kept = {
        name: data
        for name, data in current.items()
        if name not in current_documents or current_documents[name].identity not in identities
    }
    in_both = [name for name in new if name in kept and name in new_documents]
    diagnostics = [_name_taken(name, current_documents[name]) for name in sorted(in_both)]
    stored = {document.identity: (name, document) for name, document in current_documents.items()}
    for name, document in new_documents.items():
        old_name, old = stored.get(document.identity, ("", None))
        if old is not None and _has_name(document) and current[old_name] != new[name]:
            diagnostics += _not_higher(document, old)
    files = kept | {name: data for name, data in new.items() if is_document_name(name)}
    return MergedFiles(files, tuple(diagnostics))


def changed_skills(before: Project | None, after: Project) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names of the skills that are new, and of those that say something else than before.

    Among the latter `the environment` stands for all documents that are of no skill.
    """
    old = {skill.name: skill for skill in before.skills} if before is not None else {}
    added = tuple(skill.name for skill in after.skills if skill.name not in old)
    changed = tuple(skill.name for skill in after.skills if skill.name in old and old[skill.name] != skill)
    if before is not None and _shared(before) != _shared(after):
        changed = ("the environment", *changed)
    return added, changed


def _shared(project: Project) -> tuple[object, ...]:
    return project.environment, project.low_level, project.monitors


def _has_name(document: Document) -> bool:
    return bool(document.identity[1]) or document.kind in (DocumentKind.ENVIRONMENT, DocumentKind.LOW_LEVEL)


def _not_higher(new: Document, old: Document) -> list[Diagnostic]:
    """The error for a changed document whose declared version does not say that it is newer.

    Where the stored document declares none, its revisions are numbered by the catalogue, and a push counts
    as newer.
    """
    if old.version is None or (new.version and is_higher(new.version.text, old.version.text)):
        return []
    title = f"the {new.kind.value} {new.name}"
    stored = old.version.text
    if new.version is None:
        message, span = f"{title} declares no version, the stored one {stored}", new.span
    else:
        message, span = (
            f"{title} has changed, and version {new.version.text} is not above {stored}",
            new.version.span,
        )
    return [Diagnostic(Severity.ERROR, "AOS129", message, span, f"Declare a version above {stored}")]


def _name_taken(name: str, document: Document) -> Diagnostic:
    title = f"{document.kind.value} {document.name}"
    message = f"a file of this name holds the {title} already"
    return Diagnostic(Severity.ERROR, "AOS111", message, Span(name), "Give the new file another name")
