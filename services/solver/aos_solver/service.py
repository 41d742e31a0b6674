"""The solver service: wires documents, models, the mission and the bus.

Start-up: the service is ready as soon as it can be asked. It takes the project from the registry when it
is there, builds it, and waits for the start of the mission; from then on newer revisions are built in the
background. Whoever starts the mission is told about a model that cannot be built.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from pathlib import Path
from typing import TypeVar

import msgspec

from aos_protocol.documents import Project
from aos_protocol.errors import AosError, MissionRunsError
from aos_protocol.messages import (
    Activate,
    CheckModel,
    DecisionRecord,
    History,
    HistoryQuery,
    Message,
    MissionBegun,
    MissionQuery,
    Missions,
    MissionsQuery,
    MissionState,
    ModelCheck,
    Outcome,
    ProjectQuery,
    ProjectRevision,
    ResumeMission,
    StartMission,
    StopMission,
)
from aos_runtime.asking import ask_until_answered
from aos_runtime.failpoints import reach
from aos_runtime.lifecycle import Service
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers import Progress
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mapping_watch import MAPPING_DEADLINE_S, MappingWatch
from aos_solver.mission.endings import Ending, MissionLimits
from aos_solver.mission.failures import FailureRules
from aos_solver.mission.history import history_page
from aos_solver.mission.logbook import Logbook, Logbooks
from aos_solver.mission.loop import Mission
from aos_solver.mission.memory import BEGUN, MissionMemory
from aos_solver.mission.model_shelf import ModelShelf
from aos_solver.mission.past import Past
from aos_solver.mission.succession import Succession
from aos_solver.mission.takeover import RunningModel, Takeover
from aos_solver.mission.terms import Terms
from aos_solver.offline.following import following
from aos_solver.settings import Settings
from aos_solver.stopping import until_stopped

__all__ = ["serve"]

log = logging.getLogger(__name__)

T = TypeVar("T")

ASK_TIMEOUT_S = 5.0
ACTIVATION_MARGIN_S = 5.0
"""An answer may take this much longer than the activation itself."""


async def serve(service: Service[Settings]) -> None:
    """Run one mission, or one after the other, and stay until stopped, so that histories can be asked for."""
    solver = _Solver(service)
    try:
        await solver.run()
    finally:
        await solver.close()


class _Solver:
    """The mission's ports on the real bus and disk, and the queries the service answers."""

    world_ending: Ending | None = None

    def __init__(self, service: Service[Settings]) -> None:
        settings = service.settings
        self.clock = service.clock
        self._service = service
        self._bus = service.bus
        self._keys = service.keys
        self._settings = settings
        self._books = Logbooks(Path(settings.run_dir), settings.seed, stay=settings.stay)
        if self._books.newest is not None and self._books.newest.memory.has_ended:
            self._books.newest.forget_steps()
        self._changed = asyncio.Event()
        self._mappings = MappingWatch(service.bus, service.keys, self._changed.set)
        self._shelf = ModelShelf(
            Path(settings.cache_dir),
            self._report_progress,
            self._start_engine,
            self._mappings.is_mapped,
            settings.constraints,
            settings.mission_values,
        )
        self._shelf.on_ready = self._changed.set
        if self._books.newest is not None and not self._books.newest.memory.has_ended:
            self._shelf.values.kept = self._books.newest.memory.mission_parameters
        self._mission: Mission | None = None
        self._starting = asyncio.Lock()
        self._started = asyncio.Event()
        self._ended = asyncio.Event()
        self._succession = Succession(
            self._books, self._terms, self._documents, Path(settings.cache_dir), settings.mission_values
        )

    async def run(self) -> None:
        bus, keys = self._bus, self._keys
        async with asyncio.TaskGroup() as tasks, bus.listen(keys.announced, ProjectRevision) as announced:
            await bus.answer(keys.start_mission, StartMission, self._start)
            await bus.answer(keys.mission_state, MissionQuery, self._answer_state)
            await bus.answer(keys.decision_history, HistoryQuery, self._answer_history)
            await bus.answer(keys.check_model, CheckModel, self._check)
            await bus.answer(keys.resume_mission, ResumeMission, self._resume)
            await bus.answer(keys.stop_mission, StopMission, self._stop)
            await bus.answer(keys.missions, MissionsQuery, self._answer_missions)
            await self._service.ready()
            tasks.create_task(self._follow_registry())
            if self._is_interrupted:
                tasks.create_task(self._go_on())  # It goes on without being told.
            tasks.create_task(self._run_missions())
            tasks.create_task(self._mappings.follow())
            async for _, revision in announced:
                if revision.project.name == self._settings.project:
                    tasks.create_task(self._make(revision))

    async def close(self) -> None:
        """Leaves the journal as it is: why the solver was stopped, whoever stopped it knows."""
        await self._shelf.close()
        self._books.close()

    def _settings_as(self, kind: type[T]) -> T:
        """The part of the settings that has the fields of this kind."""
        return msgspec.convert(self._settings, kind, from_attributes=True)

    # --- answers -------------------------------------------------------------------------------------

    async def _start(self, start: StartMission, _: str) -> MissionState:
        """Starts the mission once its model runs; tells the caller why if it cannot."""
        if start.request and start.request == self._books.last_request:
            return self._state()  # It is asked for again.
        if (self._runs or self._starting.locked()) and (start.request or self._settings.stay):
            raise self._busy()
        async with self._starting:
            if self._settings.stay:
                await self._begin_next(start)
            elif start.request:
                raise MissionRunsError(
                    f"the system of {self._books.name} has one mission",
                    hint="Start the system with `aos-up --stay`",
                )
            elif self._mission is None and not self._has_ended:
                await self._begin_only()
        return self._state()

    @property
    def _is_interrupted(self) -> bool:
        """True where the newest mission had begun when its solver ended, and has not ended."""
        book = self._books.newest
        return book is not None and book.memory.epoch > 0 and not book.memory.has_ended

    @property
    def _has_ended(self) -> bool:
        book = self._books.newest
        return self._mission is None and book is not None and book.memory.has_ended

    @property
    def _runs(self) -> bool:
        """Says whether a mission runs, or one that has begun is to be taken up."""
        if self._mission is not None:
            return self._mission.state.phase != "ended"
        return self._is_interrupted

    def _busy(self) -> AosError:
        hint = "Wait for its end, or end it with `aos mission stop`"
        return MissionRunsError(f"the mission {self._books.name} runs", hint=hint)

    async def _begin_only(self) -> None:
        """Begins the only mission of a system that ends with it, or takes it up."""
        assert self._books.newest is not None
        self._begin(self._books.newest, await self._first_model(), None)

    async def _begin_next(self, start: StartMission) -> None:
        """Begins the next mission of a system that stays; nothing has changed where that fails."""
        await self._first_model()
        await self._until_accepted_documents_are_ready()
        running = await self._succession.model(self._shelf, await self._first_model(), start, self._mission)
        begun = await self._succession.next(running, start, self._mission)
        running = RunningModel(running.revision, begun.engine)
        await self._shelf.turn_to(running, self._succession.values(start))
        self._begin(self._books.open_next(), running, start, begun.past)

    async def _until_accepted_documents_are_ready(self) -> None:
        """Waits for what the registry has accepted before the start of a mission, here and in the
        middleware."""
        await self._make_current()
        await self._shelf.made()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(MAPPING_DEADLINE_S):
                while self._shelf.is_unmapped:
                    await self.until_changed(1.0)

    async def _go_on(self) -> None:
        """Takes up the mission that had begun when the solver before this one ended."""
        async with self._starting:
            book = self._books.newest
            if self._mission is not None or book is None:
                return  # Whoever has started the system was quicker.
            running, past = await self._first_model(), None
            if book.number:
                begun = await self._succession.at_start_of(running, book.number)
                running, past = RunningModel(running.revision, begun.engine), begun.past
                await self._shelf.turn_to(running, self._succession.values(book.start))
            self._begin(book, running, book.start, past)

    async def _first_model(self) -> RunningModel:
        return self._shelf.running or await self._shelf.first()

    def _begin(
        self, book: Logbook, running: RunningModel, start: StartMission | None, past: Past | None = None
    ) -> None:
        """Begins a mission or takes it up; that it begins is in the journal."""
        terms = self._terms(book.name, book.seed, book.memory.epoch + 1, running)
        begun = MissionBegun(
            book.name,
            terms.epoch,
            book.seed,
            running.revision,
            running.digest,
            running.engine.description.mission_parameters,
            start,
        )
        book.append(BEGUN, begun)
        memory, book.memory = book.memory, MissionMemory()
        self._mission = Mission(terms, running, self, memory, past)
        self._ended.clear()
        self._started.set()

    async def _stop(self, stop: StopMission, _: str) -> MissionState:
        """Ends the mission that runs, and returns when it has ended."""
        mission = self._mission
        if mission is None or stop.mission not in ("", mission.state.mission):
            return self._state()
        mission.stop(stop.reason)
        self._changed.set()
        await until_stopped(mission, stop.reason, self._ended, self._bus, self._keys)
        return mission.state

    async def _answer_missions(self, _: MissionsQuery, __: str) -> Missions:
        return Missions(await asyncio.to_thread(self._books.entries), self._settings.stay)

    async def _resume(self, _: ResumeMission, __: str) -> MissionState:
        if self._mission is not None:
            self._mission.resume()
            self._changed.set()
        return self._state()

    async def _answer_state(self, _: MissionQuery, __: str) -> MissionState:
        return self._state()

    async def _answer_history(self, query: HistoryQuery, _: str) -> History:
        if self._books.newest is None:
            return History(self._books.name, ())
        book, name = self._books.path_of(query.mission), query.mission or self._books.name
        return await asyncio.to_thread(history_page, book, name, query)

    async def _check(self, question: CheckModel, _: str) -> ModelCheck:
        return ModelCheck(await self._shelf.check(question.project, self._shelf.running))

    def _state(self) -> MissionState:
        if self._mission is not None:
            return self._mission.state
        book = self._books.newest
        if book is not None and book.memory.has_ended and book.memory.state is not None:
            return book.memory.state
        return MissionState(self._books.name, "waiting", 0, 0.0)

    # --- models --------------------------------------------------------------------------------------

    async def _follow_registry(self) -> None:
        """Asks for the documents, and again when the registry comes: what it told meanwhile is lost."""
        await self._make_current()
        async with self._bus.presence(self._keys.live("registry")) as presence:
            async for _, is_there in presence:
                if is_there:
                    await self._make_current()

    async def _make_current(self) -> None:
        """Builds what the registry holds already. Where it holds nothing, an announcement will come."""
        try:
            revision = await self._bus.ask(
                self._keys.project,
                ProjectQuery(self._settings.project),
                ProjectRevision,
                timeout_s=ASK_TIMEOUT_S,
            )
        except AosError as error:
            log.info("no documents yet: %s", error)
            return
        await self._shelf.make(revision)

    async def _make(self, revision: ProjectRevision) -> None:
        """Builds a revision, and asks whether the middleware has it: what it told may be lost."""
        await self._shelf.make(revision)
        if self._mission is not None:
            await self._mappings.until_dealt_with(revision.revision)

    async def _start_engine(self, built: BuiltModel) -> Engine:
        reach("solver.engine.before")
        engine = await Engine.start(
            built,
            seed=self._settings.seed,
            impossible_observation=self._settings.impossible_observation,
        )
        reach("solver.engine.after")
        engine.on_progress = self._report_planning
        return engine

    async def _documents(self, revision: int) -> Project:
        """The documents of a revision."""
        answer = await self._bus.ask(
            self._keys.project,
            ProjectQuery(self._settings.project, revision),
            ProjectRevision,
            timeout_s=ASK_TIMEOUT_S,
        )
        return answer.project

    def _report_progress(self, remark: str) -> None:
        log.info("%s", remark)
        if self._mission is None:
            self.publish_state(MissionState(self._books.name, "building", 0, 0.0, remark=remark))

    def _report_planning(self, progress: Progress) -> None:
        """Tells people how far a decision is that takes long. The journal has only the decision."""
        if self._mission is not None and self._mission.state.phase == "planning":
            self.publish_state(msgspec.structs.replace(self._mission.state, remark=progress.text))

    # --- the mission and its ports -------------------------------------------------------------------

    async def _run_missions(self) -> None:
        if self._has_ended and not self._settings.stay:
            return
        is_last = False
        while not is_last:
            await self._started.wait()
            self._started.clear()
            mission = self._mission
            assert mission is not None
            await self._mappings.until_dealt_with(mission.state.revision)
            state = await mission.run()
            self._ended.set()
            log.info("the mission ended: %s, %s", state.ending, state.remark)
            is_last = not self._settings.stay

    def _terms(self, name: str, seed: int, epoch: int, running: RunningModel) -> Terms:
        """The terms of a mission."""
        search = msgspec.structs.replace(self._settings_as(Search), seed=seed)
        policy = Path(self._settings.policy) if self._settings.policy else None
        return Terms(
            name=name,
            epoch=epoch,
            limits=self._settings_as(MissionLimits),
            search=following(search, policy, engine=running.engine),
            failures=self._settings_as(FailureRules),
            activation_timeout_s=self._settings.activation_timeout_s,
            hold_s=self._settings.hold_s,
        )

    @property
    def unavailable(self) -> dict[str, str]:
        return self._mappings.unavailable

    @property
    def announced(self) -> dict[str, int]:
        return self._mappings.announced

    async def until_changed(self, timeout_s: float) -> None:
        self._changed.clear()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(timeout_s):
                await self._changed.wait()

    def journal(self, kind: str, payload: Message) -> None:
        assert self._books.newest is not None
        self._books.newest.append(kind, payload)

    def publish_record(self, record: DecisionRecord) -> None:
        self._bus.tell(self._keys.decisions, record)

    def publish_state(self, state: MissionState) -> None:
        self._bus.tell(self._keys.mission_state, state)

    async def activate(self, request: Activate, action: str) -> Outcome:
        return await ask_until_answered(
            self._bus,
            self._keys.activate(request.skill),
            request,
            Outcome,
            server=self._keys.live("middleware"),
            timeout_s=request.deadline_s + ACTIVATION_MARGIN_S,
        )

    async def newest_model(self, running: RunningModel, past: Past) -> Takeover | None:
        return await self._shelf.newest(running, past)
