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

from aos_protocol.errors import AosError, BusError
from aos_protocol.messages import (
    Activate,
    CheckModel,
    DecisionRecord,
    History,
    HistoryQuery,
    MappingQuery,
    MappingState,
    Message,
    MissionBegun,
    MissionQuery,
    MissionState,
    ModelCheck,
    Outcome,
    ProjectQuery,
    ProjectRevision,
    ResumeMission,
    StartMission,
)
from aos_runtime.asking import ask_until_answered
from aos_runtime.journal import Journal
from aos_runtime.lifecycle import Service
from aos_runtime.reported_state import state_when
from aos_runtime.subscription import merged
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers import Progress
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.endings import Ending, MissionLimits
from aos_solver.mission.failures import FailureRules
from aos_solver.mission.history import history_page
from aos_solver.mission.hot_plug import ModelShelf
from aos_solver.mission.loop import Mission
from aos_solver.mission.memory import BEGUN, MissionMemory, folded
from aos_solver.mission.past import Past
from aos_solver.mission.takeover import RunningModel, Takeover
from aos_solver.mission.terms import Terms
from aos_solver.offline.following import following
from aos_solver.settings import Settings

__all__ = ["serve"]

log = logging.getLogger(__name__)

T = TypeVar("T")

ASK_TIMEOUT_S = 5.0
MAPPING_DEADLINE_S = 20.0
ACTIVATION_MARGIN_S = 5.0
"""An answer may take this much longer than the activation itself."""


async def serve(service: Service[Settings]) -> None:
    """Run one mission and stay until stopped, so that its history can be asked for."""
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
        self._journal_path = Path(settings.run_dir) / "journal.db"
        self._journal = Journal.open(self._journal_path)
        self._memory = folded(self._journal.walk())
        if self._memory.has_ended:
            self._memory = msgspec.structs.replace(self._memory, steps=())
        self._shelf = ModelShelf(
            Path(settings.cache_dir),
            self._report_progress,
            self._start_engine,
            lambda revision: revision in self._mapped,
            settings.constraints,
            settings.mission_values,
        )
        self._shelf.on_ready = lambda: self._changed.set()
        self._shelf.kept = self._memory.mission_parameters
        self._name = Path(settings.run_dir).name
        self._mapped: tuple[int, ...] = ()
        self._search = self._settings_as(Search)
        self._mission: Mission | None = None
        self._starting = asyncio.Lock()
        self._started = asyncio.Event()
        self._changed = asyncio.Event()
        self.unavailable: dict[str, str] = {}
        self.announced: dict[str, int] = {}

    async def run(self) -> None:
        bus, keys = self._bus, self._keys
        async with asyncio.TaskGroup() as tasks, bus.listen(keys.announced, ProjectRevision) as announced:
            await bus.answer(keys.start_mission, StartMission, self._start)
            await bus.answer(keys.mission_state, MissionQuery, self._answer_state)
            await bus.answer(keys.decision_history, HistoryQuery, self._answer_history)
            await bus.answer(keys.check_model, CheckModel, self._check)
            await bus.answer(keys.resume_mission, ResumeMission, self._resume)
            await self._service.ready()
            tasks.create_task(self._follow_registry())
            if self._memory.epoch and not self._memory.has_ended:
                tasks.create_task(self._start(StartMission(), ""))  # It goes on without being told.
            tasks.create_task(self._run_mission())
            tasks.create_task(self._follow_mappings())
            async for _, revision in announced:
                if revision.project.name == self._settings.project:
                    tasks.create_task(self._make(revision))

    async def close(self) -> None:
        """Leaves the journal as it is: why the solver was stopped, whoever stopped it knows."""
        await self._shelf.close()
        self._journal.close()

    def _settings_as(self, kind: type[T]) -> T:
        """The part of the settings that has the fields of this kind."""
        return msgspec.convert(self._settings, kind, from_attributes=True)

    # --- answers -------------------------------------------------------------------------------------

    async def _start(self, _: StartMission, __: str) -> MissionState:
        """Starts the mission once its model runs; tells the caller why if it cannot."""
        async with self._starting:
            running = self._shelf.running or await self._shelf.first()
            policy = Path(self._settings.policy) if self._settings.policy else None
            self._search = following(self._settings_as(Search), policy, engine=running.engine)
        self._started.set()
        return self._state()

    async def _resume(self, _: ResumeMission, __: str) -> MissionState:
        if self._mission is not None:
            self._mission.resume()
            self._changed.set()
        return self._state()

    async def _answer_state(self, _: MissionQuery, __: str) -> MissionState:
        return self._state()

    async def _answer_history(self, query: HistoryQuery, _: str) -> History:
        return await asyncio.to_thread(history_page, self._journal_path, self._name, query)

    async def _check(self, question: CheckModel, _: str) -> ModelCheck:
        return ModelCheck(await self._shelf.check(question.project, self._shelf.running))

    def _state(self) -> MissionState:
        if self._mission is not None:
            return self._mission.state
        if self._memory.has_ended and self._memory.state is not None:
            return self._memory.state
        return MissionState(self._name, "waiting", 0, 0.0)

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
            await self._await_mappings(revision.revision)

    async def _start_engine(self, built: BuiltModel) -> Engine:
        engine = await Engine.start(
            built,
            seed=self._settings.seed,
            impossible_observation=self._settings.impossible_observation,
        )
        engine.on_progress = self._report_planning
        return engine

    async def _ask_mapping_state(self) -> MappingState:
        return await self._bus.ask(
            self._keys.mapping_state, MappingQuery(), MappingState, timeout_s=ASK_TIMEOUT_S
        )

    def _report_progress(self, remark: str) -> None:
        log.info("%s", remark)
        if self._mission is None:
            self.publish_state(MissionState(self._name, "building", 0, 0.0, remark=remark))

    def _report_planning(self, progress: Progress) -> None:
        """Tells people how far a decision is that takes long. The journal has only the decision."""
        if self._mission is not None and self._mission.state.phase == "planning":
            self.publish_state(msgspec.structs.replace(self._mission.state, remark=progress.text))

    # --- the mission and its ports -------------------------------------------------------------------

    async def _run_mission(self) -> None:
        if self._memory.has_ended:
            return
        await self._started.wait()
        running = self._shelf.running
        assert running is not None
        self._mission = self._begun(running, self._memory)
        # The steps are needed once: a long mission has many.
        self._memory = MissionMemory()
        await self._await_mappings(running.revision)
        state = await self._mission.run()
        log.info("the mission ended: %s, %s", state.ending, state.remark)

    def _begun(self, running: RunningModel, memory: MissionMemory) -> Mission:
        """The mission of this solver, with what the journal has of it; that it begins is in the journal."""
        begun = MissionBegun(
            self._name,
            memory.epoch + 1,
            self._settings.seed,
            running.revision,
            running.digest,
            running.engine.description.mission_parameters,
        )
        self.journal(BEGUN, begun)
        terms = Terms(
            name=self._name,
            epoch=begun.epoch,
            limits=self._settings_as(MissionLimits),
            search=self._search,
            failures=self._settings_as(FailureRules),
            activation_timeout_s=self._settings.activation_timeout_s,
            hold_s=self._settings.hold_s,
        )
        return Mission(terms, running, self, memory)

    async def _await_mappings(self, revision: int) -> None:
        """Waits until the middleware has dealt with a revision. After the deadline activations tell of it."""
        try:
            state = await state_when(
                self._bus,
                self._keys.mapping_state,
                MappingQuery(),
                MappingState,
                lambda state: max(state.revision, state.refused) >= revision,
                timeout_s=MAPPING_DEADLINE_S,
            )
            self._take_mapping_state(state)
        except AosError as error:
            log.warning("the middleware has no mappings of revision %d: %s", revision, error)

    async def _follow_mappings(self) -> None:
        """Follows which skills can be run, as the middleware tells it."""
        told = self._bus.listen(self._keys.mapping_state, MappingState)
        async with merged(told, self._bus.presence(self._keys.live("middleware"))) as events:
            async for _, event in events:
                if isinstance(event, MappingState):
                    self._take_mapping_state(event)
                elif event:
                    # What it told while it, or the router, was away is lost.
                    with contextlib.suppress(BusError):
                        self._take_mapping_state(await self._ask_mapping_state())

    def _take_mapping_state(self, state: MappingState) -> None:
        if state.unavailable != self.unavailable:
            log.info("unavailable skills: %s", state.unavailable or "none")
        self.unavailable, self.announced = state.unavailable, state.announced
        self._mapped = state.revisions
        self._changed.set()

    async def until_changed(self, timeout_s: float) -> None:
        self._changed.clear()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(timeout_s):
                await self._changed.wait()

    def journal(self, kind: str, payload: Message) -> None:
        self._journal.append(kind, payload)

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
