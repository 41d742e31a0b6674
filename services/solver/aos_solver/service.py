"""The solver service: wires documents, models, missions and the bus, and answers.

Start-up: the service is ready as soon as it can be asked. It takes the project from the registry when it
is there, builds it, and waits for the start of the mission; from then on newer revisions are built in the
background. Whoever starts the mission is told about a model that cannot be built.
"""

import asyncio
import logging
from pathlib import Path

from msgspec.structs import replace

from aos_protocol import messages
from aos_runtime.failpoints import reach
from aos_runtime.parties.registry_watch import RegistryWatch
from aos_runtime.processes.lifecycle import Service
from aos_solver.building.build import BuiltModel
from aos_solver.bus_ports import BusPorts
from aos_solver.child.answers.models import Progress
from aos_solver.child.engine import Engine
from aos_solver.mapping_watch import MappingWatch
from aos_solver.mission.models.model_shelf import ModelShelf
from aos_solver.mission.records.history import HistoryReader
from aos_solver.mission.records.logbook import Logbooks
from aos_solver.mission_runner import MissionRunner
from aos_solver.settings import Settings
from aos_solver.steering_desk import SteeringDesk
from aos_solver.study_desk import StudyDesk

log = logging.getLogger(__name__)


async def serve(service: Service[Settings]) -> None:
    """Run one mission, or one after the other, and stay until stopped, so that histories can be asked for."""
    solver = _Solver(service)
    try:
        await solver.run()
    finally:
        await solver.close()


class _Solver:
    """The parts of the solver, wired, and the queries the service answers."""

    def __init__(self, service: Service[Settings]) -> None:
        settings = service.settings
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
        self._shelf.on_ready = self._note_ready
        if self._books.newest is not None and not self._books.newest.memory.has_ended:
            self._shelf.values.kept = self._books.newest.memory.mission_parameters
        self._registry = RegistryWatch(service.bus, service.keys, settings.project, self._shelf.make)
        self._history = HistoryReader()
        self._studies = StudyDesk(settings, self._books, self._registry)
        self._ports = BusPorts(service, self._books, self._mappings, self._shelf, self._changed)
        self._missions = MissionRunner(
            settings, self._books, self._shelf, self._mappings, self._registry, self._ports
        )
        self._steering = SteeringDesk(self._missions, self._changed.set, service.bus, service.keys)

    async def run(self) -> None:
        bus, keys = self._bus, self._keys
        async with (
            asyncio.TaskGroup() as tasks,
            bus.listen(keys.announced, messages.ProjectRevision) as announced,
        ):
            await bus.answer(keys.start_mission, messages.StartMission, self._start)
            await bus.answer(keys.mission_state, messages.MissionQuery, self._answer_state)
            await bus.answer(keys.decision_history, messages.HistoryQuery, self._answer_history)
            await bus.answer(keys.check_model, messages.CheckModel, self._check)
            await bus.answer(keys.resume_mission, messages.ResumeMission, self._resume)
            await bus.answer(keys.steer_mission, messages.Steer, self._steer)
            await bus.answer(keys.stop_mission, messages.StopMission, self._stop)
            await bus.answer(keys.missions, messages.MissionsQuery, self._answer_missions)
            await self._studies.answer(bus, keys)
            await self._service.ready()
            tasks.create_task(self._registry.follow())
            if self._missions.is_interrupted:
                tasks.create_task(self._missions.go_on())  # It goes on without being told.
            tasks.create_task(self._missions.run())
            tasks.create_task(self._mappings.follow())
            async for _, revision in announced:
                if revision.project.name == self._settings.project:
                    tasks.create_task(self._make(revision))

    async def close(self) -> None:
        """Leaves the journal as it is: why the solver was stopped, whoever stopped it knows."""
        await self._studies.close()
        await self._shelf.close()
        self._history.close()
        self._books.close()

    async def _start(self, start: messages.StartMission, _: str) -> messages.MissionState:
        """Starts a mission once its model runs; tells the caller why if it cannot."""
        await self._missions.start(start)
        return self._missions.state

    async def _stop(self, stop: messages.StopMission, _: str) -> messages.MissionState:
        return await self._steering.stop(stop)

    async def _answer_missions(self, _: messages.MissionsQuery, __: str) -> messages.Missions:
        return messages.Missions(await asyncio.to_thread(self._books.entries), self._settings.stay)

    async def _resume(self, resume: messages.ResumeMission, _: str) -> messages.MissionState:
        mission = self._missions.mission
        if mission is not None and mission.state.phase == "holding":
            await self._steering.take(messages.Steer("resume", by=resume.by))
        return self._missions.state

    async def _steer(self, steer: messages.Steer, _: str) -> messages.MissionState:
        return await self._steering.take(steer)

    async def _answer_state(self, _: messages.MissionQuery, __: str) -> messages.MissionState:
        return self._missions.state

    async def _answer_history(self, query: messages.HistoryQuery, _: str) -> messages.History:
        if self._books.newest is None:
            return messages.History(self._books.name, ())
        book, name = self._books.path_of(query.mission), query.mission or self._books.name
        return await self._history.page(book, name, query)

    async def _check(self, question: messages.CheckModel, _: str) -> messages.ModelCheck:
        return messages.ModelCheck(await self._shelf.check(question.project, self._shelf.running))

    async def _make(self, revision: messages.ProjectRevision) -> None:
        """Builds a revision, and asks whether the middleware has it: what it told may be lost."""
        await self._shelf.make(revision)
        if self._missions.mission is not None:
            await self._mappings.until_dealt_with(revision.revision)

    async def _start_engine(self, built: BuiltModel) -> Engine:
        reach("solver.engine.before")
        engine = await Engine.start(
            built, seed=self._settings.seed, impossible_observation=self._settings.impossible_observation
        )
        reach("solver.engine.after")
        engine.on_progress = self._report_planning
        return engine

    def _report_progress(self, remark: str) -> None:
        log.info("%s", remark)
        self._tell_compiling(remark)

    def _note_ready(self) -> None:
        self._changed.set()
        self._tell_compiling("")

    def _tell_compiling(self, remark: str) -> None:
        """Tells people that the first mission waits for the compiler, or does so no more."""
        if self._missions.mission is None and self._missions.compiling != remark:
            self._missions.compiling = remark
            if (state := self._missions.state).phase != "ended":
                self._ports.publish_state(state)

    def _report_planning(self, progress: Progress) -> None:
        """Tells people how far a decision is that takes long. The journal has only the decision."""
        mission = self._missions.mission
        if mission is not None and mission.state.phase == "planning":
            self._ports.publish_state(replace(mission.state, remark=progress.text))
