"""A push of some files over the files a project has: a document replaces the one of its kind and name."""

from collections.abc import Mapping

import msgspec

from aos_language.findings import Findings
from aos_language.reading.document import Document, DocumentKind, is_higher
from aos_language.reading.files import KnownFiles, is_document_name, read_documents
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import Project


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
