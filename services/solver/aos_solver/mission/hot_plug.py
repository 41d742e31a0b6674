"""Models in the making: from a project revision to a running engine, while a mission goes on.

A revision is built and started in the background. At a decision boundary the mission takes the newest
model that is ready on both sides, here and in the middleware, and the belief moves over. That works
between models with the same state layout; others are refused before they are stored (AOS112).

A mission uses a quick build at once. A thorough build is made meanwhile for the next start: within a mission
it would win less than is lost with the search tree, which does not move over.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import msgspec

from aos_protocol.diagnostics import Diagnostic, Severity, has_errors
from aos_protocol.documents import Constraint, Project
from aos_protocol.errors import AosError, ModelError
from aos_protocol.messages import ProjectRevision
from aos_solver.building.build import BuildKind, BuiltModel, build
from aos_solver.child.engine import Engine
from aos_solver.emission.emit import EmittedModel, emit
from aos_solver.emission.lower import lower
from aos_solver.emission.program import Program

__all__ = ["ModelShelf", "RunningModel", "build_project", "emitted_model", "lowered"]

log = logging.getLogger(__name__)

_LAST = 19
"""The niceness of what nobody waits for: of all that wants a processor it is served last."""

_UNHURRIED_DEADLINE_S = 1800.0

_PATIENCE_S = 1.0
"""A decision waits this long for a revision that is on its way. The revision was compiled when it was
checked, so that only its engine and the middleware's module have to start."""

_ASK_AGAIN_S = 0.02


class RunningModel(msgspec.Struct, frozen=True):
    """A compiled model with its engine child."""

    revision: int
    engine: Engine

    @property
    def digest(self) -> str:
        return self.engine.model_digest


async def build_project(
    project: Project,
    cache_dir: Path,
    on_progress: Callable[[str], None],
    *,
    kind: BuildKind = "quick",
) -> BuiltModel:
    """Lower, emit and compile; ModelError with all diagnostics if the documents have mistakes."""
    return await build(emitted_model(project), cache_dir=cache_dir, on_progress=on_progress, kind=kind)


@lru_cache(maxsize=8)
def lowered(project: Project) -> tuple[Program | None, tuple[Diagnostic, ...]]:
    """Lowers a project and remembers the result: whoever checks documents builds them as well."""
    return lower(project)


@lru_cache(maxsize=8)
def emitted_model(project: Project) -> EmittedModel:
    """The C++ of a project; ModelError as from `build_project`.

    The result is remembered: documents are checked before they are used, and a change may be taken back.
    """
    program, diagnostics = lowered(project)
    if program is None or has_errors(diagnostics):
        raise ModelError(
            f"the documents of {project.name} have mistakes",
            hint="Mend the places named above",
            diagnostics=tuple(diagnostics),
        )
    return emit(program)


class ModelShelf:
    """Holds the newest model that is ready to run, at most one besides the mission's own.

    `_shelf` is locked by whoever puts a model there, takes it, or decides whether to take it: nothing is
    replaced while the belief moves over. A model's engine is closed by the shelf until somebody has it.
    """

    def __init__(
        self,
        cache_dir: Path,
        on_progress: Callable[[str], None],
        start_engine: Callable[[BuiltModel], Awaitable[Engine]],
        mapping_revision: Callable[[], Awaitable[int]],
        constraints: tuple[Constraint, ...] = (),
    ) -> None:
        """The models are those of the documents with the mission's `constraints`."""
        self._cache_dir = cache_dir
        self._on_progress = on_progress
        self._start_engine = start_engine
        self._mapping_revision = mapping_revision
        self._constraints = constraints
        self._ready: RunningModel | None = None
        self._fault: AosError | None = None
        self._shelf = asyncio.Condition()
        self._newest_revision = 0
        self._unmapped_revision = 0
        self._building = asyncio.Lock()
        self._thorough: asyncio.Task[None] | None = None

    async def make(self, revision: ProjectRevision) -> None:
        """Build a revision and start its engine; a fault is kept for `first` and changes nothing else."""
        if revision.revision <= self._newest_revision:
            return
        self._newest_revision = revision.revision
        async with self._building:
            if revision.revision == self._newest_revision:
                await self._make(revision)

    async def _make(self, revision: ProjectRevision) -> None:
        try:
            built = await self._built(revision.project)
            model = RunningModel(revision.revision, await self._start_engine(built))
        except AosError as error:
            log.warning("revision %d is not used: %s", revision.revision, error)
            async with self._shelf:
                self._fault = error
                self._shelf.notify_all()
            return
        await self._put(model)
        await self._end_thorough_build()
        self._thorough = asyncio.create_task(self._build_thoroughly(built.emitted))

    async def _built(self, project: Project) -> BuiltModel:
        constrained = msgspec.structs.replace(project, constraints=self._constraints)
        return await build_project(constrained, self._cache_dir, self._on_progress)

    async def _put(self, model: RunningModel) -> None:
        """Puts a model on the shelf, in place of one that nobody has taken."""
        try:
            async with self._shelf:
                outdated, self._ready, self._fault = self._ready, model, None
                self._shelf.notify_all()
        except asyncio.CancelledError:
            await model.engine.close()
            raise
        if outdated is not None:
            await outdated.engine.close()

    async def _build_thoroughly(self, emitted: EmittedModel) -> None:
        """Builds into the cache. Nobody waits for it: all other work goes first, and a fault is logged."""
        try:
            await build(
                emitted,
                cache_dir=self._cache_dir,
                kind="thorough",
                niceness=_LAST,
                deadline_s=_UNHURRIED_DEADLINE_S,
            )
        except AosError as error:
            log.warning("%s was not built thoroughly: %s", emitted.project, error)
        except Exception:
            log.exception("%s was not built thoroughly", emitted.project)

    async def _end_thorough_build(self) -> None:
        task, self._thorough = self._thorough, None
        if task is not None:
            task.cancel()
            await asyncio.wait({task})

    async def first(self) -> RunningModel:
        """The first model that runs; raises what kept it from running."""
        async with self._shelf:
            await self._shelf.wait_for(lambda: self._ready is not None or self._fault is not None)
            if self._ready is None:
                assert self._fault is not None
                raise self._fault
            model, self._ready = self._ready, None
            return model

    async def newest(self, running: RunningModel) -> RunningModel:
        """The running model, or its successor with the belief carried over and the old engine closed.

        A successor on its way is waited for, but not long. One that cannot take the belief is given up.
        """
        await self._until_made()
        async with self._shelf:
            candidate = self._ready
            if candidate is None or not await self._is_mapped(candidate.revision):
                return running
            if candidate.engine.state_digest != running.engine.state_digest:
                log.warning("revision %d changes the state and waits for a new mission", candidate.revision)
                return running
            beliefs = await running.engine.export_beliefs()
            try:
                await candidate.engine.import_beliefs(beliefs)
            except AosError as error:
                log.warning("revision %d cannot take the belief: %s", candidate.revision, error)
                self._ready = None
                await candidate.engine.close()
                return running
            self._ready = None
        await running.engine.close()
        log.info("revision %d takes over from revision %d", candidate.revision, running.revision)
        return candidate

    async def _until_made(self) -> None:
        if self._building.locked():
            with suppress(TimeoutError):
                async with asyncio.timeout(_PATIENCE_S), self._building:
                    pass

    async def _is_mapped(self, revision: int) -> bool:
        """Waits for the middleware, once for a revision; returns whether it runs the revision too."""
        with suppress(TimeoutError):
            async with asyncio.timeout(_PATIENCE_S):
                while await self._mapping_revision() < revision:
                    if revision == self._unmapped_revision:
                        return False
                    await asyncio.sleep(_ASK_AGAIN_S)
                return True
        self._unmapped_revision = revision
        return False

    async def check(self, project: Project, running: RunningModel | None) -> tuple[Diagnostic, ...]:
        """Returns what keeps these documents from being used now: compile errors, or another state layout."""
        try:
            built = await self._built(project)
        except AosError as error:
            if error.diagnostics:
                return error.diagnostics
            span = project.environment.span
            return (Diagnostic(Severity.ERROR, error.code, error.message, span, error.hint),)
        if running is not None and built.emitted.state_digest != running.engine.state_digest:
            message = (
                "the state variables differ from the running mission's, whose belief cannot be carried over"
            )
            hint = (
                "Keep the state variables as they are, or end the mission and start it with the new documents"
            )
            return (Diagnostic(Severity.ERROR, "AOS112", message, project.environment.span, hint),)
        return ()

    async def close(self) -> None:
        """Ends what is being built, and the engine that nobody has taken."""
        await self._end_thorough_build()
        async with self._shelf:
            unused, self._ready = self._ready, None
        if unused is not None:
            await unused.engine.close()
