"""The shelf of models: from a project revision to a running engine, while a mission goes on.

A revision is built and started in the background, and replays the mission's past there where it needs that.
At a decision boundary the mission takes the newest model that is ready on both sides, here and in the
middleware, and the belief moves over (takeover.py). No decision waits for a model.

A mission uses a quick build at once. A thorough one is made meanwhile, for the next start.
"""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path

from msgspec.structs import replace

from aos_language.findings import Findings
from aos_language.mission_parameters import ParameterLeaf, checked_values, usable_values
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import Constraint, MissionValue, Project
from aos_protocol.errors import AosError
from aos_protocol.messages import ProjectRevision
from aos_runtime.background import Background
from aos_runtime.clock import SystemClock
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project
from aos_solver.building.thorough_builds import ThoroughBuilds
from aos_solver.child.engine import Engine
from aos_solver.mission.models.past import Past
from aos_solver.mission.models.push_trial import faults_in_trial, goal_out_of_reach
from aos_solver.mission.models.takeover import RunningModel, Successor, Takeover

log = logging.getLogger(__name__)


class ModelShelf:
    """Holds the model that runs, and the newest one that may take over from it.

    `_shelf` is locked by whoever puts a model there, takes it, or decides whether to take it: nothing is
    replaced while the belief moves over. The shelf closes all engines, each once nobody asks it any more.
    """

    def __init__(
        self,
        cache_dir: Path,
        on_progress: Callable[[str], None],
        start_engine: Callable[[BuiltModel], Awaitable[Engine]],
        is_mapped: Callable[[int], bool],
        constraints: tuple[Constraint, ...] = (),
        mission_values: tuple[MissionValue, ...] = (),
    ) -> None:
        """The models are those of the documents with the mission's `constraints`, and run with its values.

        `is_mapped` says whether the middleware runs a revision too.
        """
        self._cache_dir = cache_dir
        self._on_progress = on_progress
        self._start_engine = start_engine
        self._is_mapped = is_mapped
        self._constraints = constraints
        self.values = MissionValues(mission_values)
        self._clock = SystemClock()
        self._running: RunningModel | None = None
        self._past = Past()
        self._ready: Successor | None = None
        self._fault: AosError | None = None
        self._shelf = asyncio.Condition()
        self._newest_revision = 0
        self._building = asyncio.Lock()
        self._thorough = ThoroughBuilds(cache_dir)
        self._ending = Background()
        self._is_closed = False
        self.on_ready: Callable[[], None] = lambda: None
        """The function that hears of a model that may take over."""

    @property
    def running(self) -> RunningModel | None:
        """The model that was taken last."""
        return self._running

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
            engine = await self._start_engine(built)
        except AosError as error:
            return await self._refuse(revision, error)
        model = RunningModel(revision.revision, engine, revision.project.skills)
        successor = Successor(model, self._clock)
        try:
            await self._put(successor)
        except AosError as error:
            await successor.close()
            return await self._refuse(revision, error)
        except BaseException:
            await successor.close()
            raise
        self._thorough.end()
        if not self._is_closed:
            self._thorough.begin(built.emitted)

    async def _refuse(self, revision: ProjectRevision, error: AosError) -> None:
        log.warning("revision %d is not used: %s", revision.revision, error)
        async with self._shelf:
            self._fault = error
            self._shelf.notify_all()

    async def _built(self, project: Project) -> BuiltModel:
        constrained = replace(project, constraints=self._constraints)
        built = await build_project(constrained, self._cache_dir, self._on_progress)
        values = self._values_in(built.emitted.parameters, project.environment.span)
        return replace(built, mission_values=values)

    def _values_in(self, leaves: Mapping[str, ParameterLeaf], span: Span | None = None) -> dict[str, str]:
        return self.values.in_model(leaves, span, is_first=self._running is None)

    async def _put(self, successor: Successor) -> None:
        """Puts a model on the shelf, in place of one that nobody has taken; its replay goes on there."""
        engine = successor.model.engine
        async with self._shelf:
            if self._is_closed:
                return self._end(successor)
            # The mission may have begun while the model was made.
            await engine.start_with(self._values_in(engine.parameters))
            outdated, self._ready, self._fault = self._ready, successor, None
            if outdated is not None:
                self._end(outdated)
            if self._running is not None:
                successor.follow(self._running, self._past, self.on_ready)
            self._shelf.notify_all()
        log.info("the model of revision %d is ready", successor.model.revision)
        self.on_ready()

    def _end(self, ended: Successor | Engine) -> None:
        """Closes what nobody asks any more, beside the mission."""
        self._ending.begin(ended.close())

    async def first(self) -> RunningModel:
        """The first model that runs; raises what kept it from running."""
        async with self._shelf:
            await self._shelf.wait_for(lambda: self._ready is not None or self._fault is not None)
            if self._ready is None:
                assert self._fault is not None
                raise self._fault
            usable_values(self.values.given, self._ready.model.engine.parameters)
            self._running, self._ready = self._ready.model, None
            self.values.kept = self._running.engine.description.mission_parameters
            return self._running

    async def made(self) -> None:
        """Returns when no revision that was announced is being made any more."""
        async with self._building:
            pass

    @property
    def is_unmapped(self) -> bool:
        """Says whether the model that may take over waits for the middleware alone."""
        return self._ready is not None and not self._is_mapped(self._ready.model.revision)

    async def newest(self, running: RunningModel, past: Past) -> Takeover | None:
        """The successor of the running model, with its belief; None where none is ready on both sides.

        Nothing is waited for: a model that is not ready yet may take over at a later call. One that cannot
        take the belief is given up. The engine of the model that ran is not asked any more.
        """
        self._running, self._past = running, past
        if self._ready is None:
            return None
        async with self._shelf:
            candidate = self._ready
            if candidate is None:
                return None
            is_mapped = self._is_mapped(candidate.model.revision)
            takeover = await self._taken(candidate, past) if is_mapped else None
            if takeover is None:
                if self._ready is not None:
                    candidate.follow(running, past, self.on_ready)
                return None
            self._ready, self._running = None, takeover.model
            self._end(running.engine)
        log.info(
            "revision %d takes over from revision %d by %s",
            takeover.model.revision,
            running.revision,
            takeover.row.by,
        )
        return takeover

    async def _taken(self, candidate: Successor, past: Past) -> Takeover | None:
        assert self._running is not None
        if not candidate.is_ready(self._running, past):
            return None
        try:
            return await candidate.take_over(self._running, past)
        except AosError as error:
            log.warning("revision %d is not used: %s", candidate.model.revision, error)
            self._ready = None
            self._end(candidate)
            return None

    async def replacement(self, running: RunningModel) -> RunningModel:
        """The newest model that is ready on both sides, whatever is believed; else the running one.

        The engine of the model that ran is not asked any more.
        """
        async with self._shelf:
            candidate = self._ready
            if candidate is None or not self._is_mapped(candidate.model.revision):
                return running
            await candidate.end_following()
            self._ready, self._running = None, candidate.model
            self._end(running.engine)
        return candidate.model

    async def turn_to(self, model: RunningModel, mission_values: tuple[MissionValue, ...]) -> None:
        """Lets a model run another mission, by an engine of its own that has the mission's values already.

        The model that ran is not asked any more. One that is to take over gets the mission's values, or is
        given up where it cannot have them.
        """
        async with self._shelf:
            before, self._running = self._running, model
            self.values.given = mission_values
            self.values.kept = model.engine.description.mission_parameters
            if before is not None and before.engine is not model.engine:
                self._end(before.engine)
            if self._ready is None:
                return
            await self._ready.end_following()
            engine = self._ready.model.engine
            try:
                await engine.start_with(self._values_in(engine.parameters, NOWHERE))
            except AosError as error:
                log.warning("revision %d is not used: %s", self._ready.model.revision, error)
                self._end(self._ready)
                self._ready = None

    async def check(self, project: Project, running: RunningModel | None) -> tuple[Diagnostic, ...]:
        """Returns what keeps these documents from being used now: mistakes, no belief for the mission that
        runs, or code that would end it. A goal that is out of reach is a warning."""
        span = project.environment.span
        try:
            built = await self._built(project)
        except AosError as error:
            return error.diagnostics or (
                Diagnostic(Severity.ERROR, error.code, error.message, span, error.hint),
            )
        if running is None:
            return ()
        try:
            engine = await self._start_engine(built)
        except AosError as error:
            place = error.diagnostics[0].span if error.diagnostics else span
            message = f"the new documents give the running mission no belief: {error.message}"
            hint = "Mend the initial belief, or end the mission and start it with the new documents"
            return (Diagnostic(Severity.ERROR, "AOS112", message, place, hint),)
        try:
            faults = await faults_in_trial(engine, span)
            return faults or await goal_out_of_reach(engine, project.environment)
        finally:
            await engine.close()  # It is stopped at once, also where nobody waits for its end.

    async def close(self) -> None:
        """Ends what is being built, and all engines."""
        self._is_closed = True
        self._thorough.end()
        async with self._shelf:
            unused, self._ready = self._ready, None
            running, self._running = self._running, None
        for each in (unused, running.engine if running is not None else None):
            if each is not None:
                self._end(each)
        await self.settled()

    async def settled(self) -> None:
        """Returns once all engines have ended that nobody asks any more."""
        while ending := self._ending.tasks | (self._thorough.tasks if self._is_closed else set()):
            await asyncio.wait(ending)


NOWHERE = Span("the documents")
"""The place of a value that nobody has set."""


class MissionValues:
    """The values that are `given` for a mission, and the `kept` ones, with which it began.

    The latter stay, whatever newer documents give by default.
    """

    def __init__(self, given: tuple[MissionValue, ...] = ()) -> None:
        self.given = given
        self.kept: Mapping[str, str] = {}

    def in_model(
        self, leaves: Mapping[str, ParameterLeaf], span: Span | None = None, *, is_first: bool
    ) -> dict[str, str]:
        """The mission's values for a model.

        DocumentError AOS146 where it cannot have one, at `span` or else where it was set. A parameter that
        nobody has set may be gone from newer documents. Before the first mission (`is_first`) more documents
        may come: the values that do not fit are told when it begins.
        """
        kept = (MissionValue(name, text, NOWHERE) for name, text in self.kept.items() if name in leaves)
        values = [replace(v, span=span or v.span) for v in (*kept, *self.given)]
        if is_first:
            return checked_values(values, leaves, Findings())
        return usable_values(values, leaves)
