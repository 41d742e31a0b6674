"""The intake of a push: read, merged, checked, stored. Nothing is stored unless all of it is accepted."""

from collections.abc import Awaitable, Callable, Mapping

import msgspec

from aos_language.findings import Findings
from aos_language.load import LoadedBundle, changed_skills, load_files, merge, pushed_project, with_excerpts
from aos_language.reading.document import DocumentKind
from aos_language.reading.files import KnownFiles, read_documents
from aos_protocol.codec import encode
from aos_protocol.diagnostics import Diagnostic, Severity, Span, has_errors
from aos_protocol.documents import Project
from aos_protocol.errors import BusError, DocumentError
from aos_protocol.messages import BundleReport, ProjectRevision
from aos_protocol.spelling import did_you_mean, quoted
from aos_registry.catalogue import Catalogue, Revision
from aos_runtime.clock import Clock

ModelCheckPort = Callable[[Project], Awaitable[tuple[Diagnostic, ...]]]
"""Asks the solver whether it can use a project; no diagnostics when there is no solver to ask."""


class Intake:
    """The projects of a catalogue, as typed documents. Pushes come one after another."""

    def __init__(self, catalogue: Catalogue, clock: Clock, check_model: ModelCheckPort) -> None:
        self._catalogue = catalogue
        self._clock = clock
        self._check_model = check_model
        self.revisions: dict[str, ProjectRevision] = {}
        self._told: dict[str, tuple[Diagnostic, ...]] = {}
        """The findings that were told about each project's revision."""

    def recall(self) -> list[BundleReport]:
        """Takes in what the catalogue holds; a report for each project that does not pass today's checks."""
        refused = []
        for entry in self._catalogue.entries():
            stored = self._catalogue.current(entry.project)
            loaded = load_files(stored.files if stored else {}, name=entry.project)
            if loaded.project is None:
                refused.append(BundleReport(entry.project, False, entry.revision, loaded.diagnostics))
            else:
                revision = ProjectRevision(entry.revision, entry.digest, loaded.project)
                self.revisions[entry.project] = revision
        return refused

    async def push(self, files: Mapping[str, bytes], source: str) -> tuple[BundleReport, bool]:
        """Takes files in; returns what became of them, and whether there is a new revision. AosError if it
        cannot be stored.

        A warning or a remark on a file that stays as it was is told once.
        """
        known: KnownFiles = {}
        project = pushed_project(files, known)
        current = self._catalogue.current(project)
        report, is_new = await self._taken(files, source, known, current)
        before = current.files.items() if current else ()
        same = {name for name, data in before if files.get(name, data) == data}
        old = {each for each in self._told.get(report.project, ()) if each.span.file in same}
        if is_new:
            self._told[report.project] = report.diagnostics
        news = tuple(each for each in report.diagnostics if each.is_error or each not in old)
        return msgspec.structs.replace(report, diagnostics=news), is_new

    async def _taken(
        self, files: Mapping[str, bytes], source: str, known: KnownFiles, current: Revision | None
    ) -> tuple[BundleReport, bool]:
        """Takes files in, as `push`, after the `current` revision; the report has all findings."""
        project = pushed_project(files, known)
        merged = merge(current.files if current else {}, files, known)
        loaded = load_files(merged.files, name=source or "bundle", known=known)
        number = current.number if current else 0
        unknown = () if current else self._unknown_project(project, files, known)
        diagnostics = (*unknown, *merged.diagnostics, *loaded.diagnostics)
        if loaded.project is None or has_errors(diagnostics):
            return BundleReport(project, False, number, diagnostics, source=source), False
        if current is not None and current.digest == loaded.digest and project in self.revisions:
            return BundleReport(project, True, number, diagnostics, source=source), False
        if too_large := _too_large_for_the_bus(loaded.project):
            return BundleReport(project, False, number, (*diagnostics, too_large), source=source), False
        findings = with_excerpts(await self._check_model(loaded.project), merged.files)
        diagnostics += findings
        if has_errors(findings):
            return BundleReport(project, False, number, diagnostics, source=source), False
        before = self.revisions.get(project)
        added, changed = changed_skills(before.project if before else None, loaded.project)
        number = self._stored(project, loaded, merged.files)
        return BundleReport(project, True, number, diagnostics, added, changed, source), True

    async def remove(self, project: str, skill: str) -> tuple[BundleReport, bool]:
        """Gives up a skill, or with none named the project; returns what became of it, and whether there is a
        new revision.

        As for a push, what is left has to pass the checks, else nothing changes.
        """
        current = self._catalogue.current(project)
        known = self.revisions.get(project)
        if current is None:
            hint = did_you_mean(project, self.revisions) or f"It holds {quoted(sorted(self.revisions))}"
            for name, each in self.revisions.items():
                if project in (item.name for item in each.project.skills):
                    hint = f"It is a skill of {name}: `aos bundle rm {name} {project}`"
            raise DocumentError(f"the catalogue holds no project {project}", code="AOS110", hint=hint)
        names = [item.name for item in known.project.skills] if known is not None else []
        if not skill:
            number = self._catalogue.remove(project, self._clock.now_ns())
            self.revisions.pop(project, None)
            return BundleReport(project, True, number, removed=tuple(names)), False
        if known is None or skill not in names:
            hint = did_you_mean(skill, names) or f"It has {quoted(names)}"
            raise DocumentError(f"{project} has no skill {skill}", code="AOS110", hint=hint)
        if names == [skill]:
            hint = f"`aos bundle rm {project}` takes the whole project out"
            raise DocumentError(f"{project} has no other skill than {skill}", code="AOS105", hint=hint)
        gone = next(item for item in known.project.skills if item.name == skill)
        homes = {gone.model.span.file, gone.mapping.span.file}
        files = {name: data for name, data in current.files.items() if name not in homes}
        loaded = load_files(files, name=project)
        diagnostics = loaded.diagnostics
        if loaded.project is not None:
            diagnostics += with_excerpts(await self._check_model(loaded.project), files)
        if loaded.project is None or has_errors(diagnostics):
            return BundleReport(project, False, current.number, diagnostics), False
        number = self._stored(project, loaded, files)
        told, self._told[project] = self._told.get(project, ()), diagnostics
        news = tuple(each for each in diagnostics if each not in told)
        return BundleReport(project, True, number, news, removed=(skill,)), True

    def past(self, project: str, number: int) -> ProjectRevision:
        """A revision as it was stored; DocumentError where there is none that passes the checks."""
        stored = self._catalogue.revision(project, number)
        loaded = load_files(stored.files, name=project) if stored is not None else None
        if loaded is None or loaded.project is None:
            message = f"the catalogue holds no usable revision {number} of {project}"
            hint = "`aos bundle history` lists them"
            found = loaded.diagnostics if loaded is not None else ()
            raise DocumentError(message, code="AOS110", hint=hint, diagnostics=found)
        return ProjectRevision(number, loaded.digest, loaded.project)

    def _stored(self, project: str, loaded: LoadedBundle, files: Mapping[str, bytes]) -> int:
        """Stores a checked project as its next revision, whose number is returned."""
        assert loaded.project is not None
        names = tuple(skill.name for skill in loaded.project.skills)
        documents = {name: files[name] for name in loaded.files}
        number = self._catalogue.store(
            project, loaded.digest, documents, names, self._clock.now_ns(), loaded.versions
        )
        self.revisions[project] = ProjectRevision(number, loaded.digest, loaded.project)
        return number

    def _unknown_project(
        self, project: str, files: Mapping[str, bytes], known: KnownFiles
    ) -> tuple[Diagnostic, ...]:
        """The error for documents that extend a project which is not there; a misspelt name, most likely."""
        documents = read_documents(files, Findings(), known).values()
        if not project or not self.revisions or any(d.kind is DocumentKind.ENVIRONMENT for d in documents):
            return ()
        hint = did_you_mean(project, self.revisions) or f"It holds {quoted(sorted(self.revisions))}"
        span = next((document.span for document in documents), Span("bundle"))
        message = f"the catalogue holds no project `{project}` that these documents could extend"
        return (Diagnostic(Severity.ERROR, "AOS113", message, span, hint),)


def _too_large_for_the_bus(project: Project) -> Diagnostic | None:
    """Returns why a project could be stored and then not be told to anybody."""
    try:
        encode(ProjectRevision(0, "", project), sender="registry", stamp_ns=0)
    except BusError as error:
        hint = f"{error.hint}; split the project"
        return Diagnostic(Severity.ERROR, "AOS120", error.message, Span(project.name), hint)
    return None
