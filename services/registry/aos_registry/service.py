"""The registry service: bundles come in by question or by folder, projects go out by answer and stream."""

import asyncio
import logging
from collections.abc import Mapping
from pathlib import Path

from msgspec.structs import replace

from aos_protocol import messages
from aos_protocol.diagnostics import Diagnostic, Severity, Span, render
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, DocumentError, NobodyAnswersError, StorageError
from aos_protocol.messages import Catalogue as CatalogueAnswer
from aos_protocol.spelling import did_you_mean, quoted
from aos_registry.catalogue import Catalogue
from aos_registry.drops import DroppedBundles
from aos_registry.intake import Intake
from aos_registry.settings import Settings
from aos_runtime.processes.lifecycle import Service

_log = logging.getLogger("aos.registry")


async def serve(service: Service[Settings]) -> None:
    """Takes bundles in and answers for them until it is stopped."""
    run_dir = Path(service.settings.run_dir)
    catalogue = Catalogue.open(Path(service.settings.catalogue or run_dir / "catalogue.db"))
    try:
        await _Registry(service, catalogue).run()
    finally:
        catalogue.close()


class _Registry:
    def __init__(self, service: Service[Settings], catalogue: Catalogue) -> None:
        self._service = service
        self._bus = service.bus
        self._keys = service.keys
        self._settings = service.settings
        self._catalogue = catalogue
        self._intake = Intake(catalogue, service.clock, self._check_model)
        self._turn = asyncio.Lock()
        folder = _made(Path(self._settings.watch or Path(self._settings.run_dir) / "drop"))
        self._dropped = DroppedBundles(
            folder, self._settings.quiet_s, self._take_in, self._tell_report, catalogue.has_held
        )

    async def run(self) -> None:
        for report in self._intake.recall():
            _log.error("the stored project %s cannot be used any more", report.project)
            _log_diagnostics(report)
        await self._bus.answer(self._keys.push_bundle, messages.PushBundle, self._answer_push)
        await self._bus.answer(self._keys.remove_bundle, messages.RemoveDocuments, self._answer_remove)
        await self._bus.answer(self._keys.bundle_history, messages.RevisionsQuery, self._answer_history)
        await self._bus.answer(self._keys.project, messages.ProjectQuery, self._answer_project)
        await self._bus.answer(self._keys.catalogue, messages.CatalogueQuery, self._answer_catalogue)
        await self._service.ready()
        for project in self._intake.revisions:
            # Who was there before, and found no registry, waits for this.
            self._announce(project)
        await self._dropped.follow()

    # --- answers ---

    async def _answer_push(self, bundle: messages.PushBundle, _: str) -> messages.BundleReport:
        report = await self._take_in(bundle.files, bundle.source)
        self._tell_report(report)
        return report

    async def _answer_remove(self, request: messages.RemoveDocuments, _: str) -> messages.BundleReport:
        async with self._turn:
            report, is_new = await self._intake.remove(request.project, request.skill)
            if is_new:
                self._announce(report.project)
        self._tell_report(report)
        return report

    async def _answer_project(self, query: messages.ProjectQuery, _: str) -> messages.ProjectRevision:
        project = self._named(query.project)
        current = self._intake.revisions[project]
        found = self._intake.past(project, query.revision) if query.revision else current
        if not query.with_files:
            return found
        stored = self._catalogue.revision(project, found.revision)
        return replace(found, files=stored.files if stored is not None else {})

    async def _answer_history(self, query: messages.RevisionsQuery, _: str) -> messages.Revisions:
        entries = self._catalogue.history(query.project)
        if not entries:  # A removed project still has a history, by its name.
            entries = self._catalogue.history(self._named(query.project))
        return messages.Revisions(query.project or self._named(""), entries)

    def _named(self, project: str) -> str:
        """The project of that name, or the only one there is; DocumentError says which there are."""
        revisions = self._intake.revisions
        if project in revisions:
            return project
        if not project and len(revisions) == 1:
            return next(iter(revisions))
        if not revisions:
            raise DocumentError("the catalogue is empty", code="AOS110", hint="Push a bundle")
        names = quoted(sorted(revisions))
        if not project:
            message = f"the catalogue holds {len(revisions)} projects"
            raise DocumentError(message, code="AOS110", hint=f"Name one of {names}")
        hint = did_you_mean(project, revisions) or f"It holds {names}"
        raise DocumentError(f"the catalogue holds no project {project}", code="AOS110", hint=hint)

    async def _answer_catalogue(self, _: messages.CatalogueQuery, __: str) -> CatalogueAnswer:
        return CatalogueAnswer(self._catalogue.entries())

    # --- intake ---

    def _tell_report(self, report: messages.BundleReport) -> None:
        """Whoever follows the registry hears of everything that was pushed, dropped or removed."""
        self._bus.tell(self._keys.bundle_report, report)
        _log_report(report)

    async def _take_in(self, files: Mapping[str, bytes], source: str) -> messages.BundleReport:
        async with self._turn:
            report, is_new = await self._intake.push(files, source)
            if is_new:
                self._announce(report.project)
        return report

    def _announce(self, project: str) -> None:
        self._bus.tell(self._keys.announced, self._intake.revisions[project])
        self._dropped.project_changed()

    async def _check_model(self, project: Project) -> tuple[Diagnostic, ...]:
        """Asks the solver what it says to a project; returns nothing when there is no solver yet.

        A solver that took the question and ended has not accepted the project.
        """
        try:
            answer = await self._bus.ask(
                self._keys.check_model,
                messages.CheckModel(project),
                messages.ModelCheck,
                timeout_s=self._settings.model_check_timeout_s,
            )
        except NobodyAnswersError:
            return ()
        except AosError as error:
            message = f"the solver could not check the model: {error.message}"
            return (Diagnostic(Severity.ERROR, error.code, message, Span(project.name), error.hint),)
        return answer.diagnostics


def _made(folder: Path) -> Path:
    """The folder, made if need be, without links in its path; StorageError where that is refused."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StorageError(f"the watched folder {folder} cannot be made: {error.strerror}") from error
    return folder.resolve()


def _log_report(report: messages.BundleReport) -> None:
    if not report.is_accepted:
        waits = "; it is tried again when a project changes" if report.is_waiting else ""
        _log.warning("a bundle of project %s is refused (%s)%s", report.project or "?", report.source, waits)
    else:
        removed = [f"{name} removed" for name in report.removed]
        new = ", ".join((*report.added, *report.changed, *removed)) or "nothing new"
        _log.info("project %s, revision %d: %s", report.project, report.revision, new)
    _log_diagnostics(report)


def _log_diagnostics(report: messages.BundleReport) -> None:
    for diagnostic in report.diagnostics:
        if diagnostic.is_error:
            _log.warning("%s", render(diagnostic))
