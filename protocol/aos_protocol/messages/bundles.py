"""Documents on their way into the registry, and what it holds."""

from aos_protocol.diagnostics import Diagnostic
from aos_protocol.documents import Project
from aos_protocol.messages.base import Message


class PushBundle(Message, frozen=True):
    """A bundle for the registry: file names, relative and flat, with their bytes. `source` is for people."""

    files: dict[str, bytes]
    source: str = ""


class BundleReport(Message, frozen=True):
    """The result of a bundle. `revision` is the project's revision now; 0 if it was never accepted.

    A dropped bundle that is refused for what it lacks `is_waiting`: it is tried again when a project changes.
    """

    project: str
    is_accepted: bool
    revision: int
    diagnostics: tuple[Diagnostic, ...] = ()
    added: tuple[str, ...] = ()
    changed: tuple[str, ...] = ()
    source: str = ""
    removed: tuple[str, ...] = ()
    is_waiting: bool = False


class RemoveDocuments(Message, frozen=True):
    """Asks the registry to give up a skill of a project, or with no skill named the whole project.

    Answered by a BundleReport. A mission that runs keeps the model it has until a revision follows.
    """

    project: str
    skill: str = ""


class RevisionsQuery(Message, frozen=True):
    """Asks for all revisions of a project; an empty name asks for the only one there is."""

    project: str = ""


class RevisionEntry(Message, frozen=True):
    """One revision. The names of files tell it from the one before; a removed project has no skills.

    `versions` gives the version of each file that declares one.
    """

    revision: int
    digest: str
    stored_ns: int
    skills: tuple[str, ...]
    added: tuple[str, ...]
    changed: tuple[str, ...]
    removed: tuple[str, ...]
    versions: dict[str, str] = {}


class Revisions(Message, frozen=True):
    """A project's revisions, the oldest first."""

    project: str
    entries: tuple[RevisionEntry, ...]


class ProjectQuery(Message, frozen=True):
    """Asks for a revision of a project, 0 for the current one; an empty name asks for the only project.

    The answer has the source files too where they are asked for (`with_files`).
    """

    project: str = ""
    revision: int = 0
    with_files: bool = False


class ProjectRevision(Message, frozen=True):
    """The documents of a project as they stand, checked. `digest` is over the source files."""

    revision: int
    digest: str
    project: Project
    files: dict[str, bytes] = {}


class CatalogueQuery(Message, frozen=True):
    """Asks what the catalogue holds."""


class CatalogueEntry(Message, frozen=True):
    """One project of the catalogue."""

    project: str
    revision: int
    digest: str
    stored_ns: int
    skills: tuple[str, ...]


class Catalogue(Message, frozen=True):
    """The catalogue's projects, by name."""

    entries: tuple[CatalogueEntry, ...]
