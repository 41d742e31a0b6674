"""Missions of the loop with a simulated world, whose rows are kept as a journal keeps them."""

from collections.abc import Awaitable, Callable, Mapping
from typing import NamedTuple

import msgspec
from models import built_project
from projects import files_project

from aos_deploy.places import cache_dir
from aos_protocol.documents import Project
from aos_protocol.errors import StorageError
from aos_protocol.messages import Activate, Message, MissionBegun, MissionState, Outcome
from aos_protocol.mission_rows import BEGUN
from aos_runtime.clock import SystemClock
from aos_runtime.disk.journal import JournalRow
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.past import Past
from aos_solver.mission.models.takeover import RunningModel, Successor, Takeover
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.rules.endings import Ending, MissionLimits
from aos_solver.mission.rules.terms import Terms
from aos_solver.settings import Settings
from aos_solver.study.recorded import RecordedMission, recorded
from aos_solver.study.replaying import ReplayedMission

Files = Mapping[str, bytes]

Steering = Callable[[Mission], None]
"""Is called with the mission at each state that it tells, and while it holds."""

Disturbance = Callable[[Engine, int], Awaitable[None]]
"""Is called with the mission's engine and the number of the step while a skill runs."""


class Beside(NamedTuple):
    """Those who are beside a mission."""

    disturbance: Disturbance | None = None
    steering: Steering | None = None


class Played(msgspec.Struct):
    """A mission that was played: its rows, settings, and documents by revision."""

    rows: list[JournalRow]
    settings: Settings
    revisions: list[Files]

    @property
    def mission(self) -> RecordedMission:
        return recorded(self.rows)

    def replay(self, mission: RecordedMission | None = None, *, decides: bool = False) -> ReplayedMission:
        return ReplayedMission(mission or self.mission, self, self.settings, decides=decides, niceness=0)

    async def revision(self, number: int) -> Project:
        """The documents of a revision, from 1; StorageError AOS702 if there is none."""
        if not 0 < number <= len(self.revisions):
            raise StorageError(f"there is no revision {number}", code="AOS702")
        return files_project(self.revisions[number - 1])

    # As a source of studies:

    async def recorded(self, mission: str) -> RecordedMission:
        return self.mission

    async def files(self, revision: int) -> dict[str, bytes]:
        return dict(self.revisions[revision - 1])


_NOBODY = Beside()


class _World(QuietPorts):
    """A world that an engine of its own plays, and the journal of what happens there."""

    keeps_beliefs = True

    def __init__(self, world: Engine, beside: Beside):
        self.clock = SystemClock()
        self._world = world
        self._disturbance, self._steering = beside
        self.mission: Mission | None = None
        self._places = {action.name: index for index, action in enumerate(world.description.actions)}
        self.rows: list[JournalRow] = []
        self.engine: Engine | None = None
        self.next: tuple[int, Successor] | None = None
        self.steps = 0

    def journal(self, kind: str, payload: Message):
        text = msgspec.json.encode(payload).decode()
        self.rows.append(JournalRow(len(self.rows) + 1, 0, kind, text))

    def publish_state(self, state: MissionState):
        if self._steering is not None and self.mission is not None:
            self._steering(self.mission)

    async def until_changed(self, timeout_s: float):
        assert self._steering is not None
        assert self.mission is not None
        self._steering(self.mission)

    async def activate(self, request: Activate, action: str) -> Outcome:
        self.steps += 1
        assert self.engine is not None
        if self._disturbance is not None:
            await self._disturbance(self.engine, self.steps)
        step = await self._world.step_world(self._places[action])
        self.world_ending = Ending(step.ending) if step.ending else None
        monitors = await self._world.monitor_world()
        return Outcome(
            request.id, request.skill, "observed", step.response, numbers=step.numbers, monitors=monitors
        )

    async def newest_model(self, running: RunningModel, past: Past) -> Takeover | None:
        if self.next is None or self.steps < self.next[0]:
            return None
        takeover = await self.next[1].take_over(running, past)
        if takeover is not None:
            self.next, self.engine = None, takeover.model.engine
            await running.engine.close()
        return takeover


async def play(
    files: Files,
    *,
    seed: int = 1,
    steps: int = 8,
    then: tuple[int, Files] | None = None,
    beside: Beside = _NOBODY,
    **budget: object,
) -> Played:
    """Plays a mission of so many steps at most; the world is that of the documents.

    With `then` other documents take over after so many steps. `budget` are settings of the search.
    """
    settings = Settings(
        robot="r",
        service="solver",
        endpoint="",
        run_dir="",
        project="p",
        cache_dir=str(cache_dir()),
        seed=seed,
        step_limit=steps,
        **budget,
    )
    project = files_project(files)
    built = await built_project(project)
    engine = await Engine.start(built, seed=seed)
    world = await Engine.start(built, seed=seed + 1000)
    around = _World(world, beside)
    around.engine = engine
    try:
        await world.reset_world(seed)
        running = RunningModel(1, engine)
        parameters = engine.description.mission_parameters
        around.journal(BEGUN, MissionBegun("m", 1, seed, 1, running.digest, parameters))
        if then is not None:
            other = await built_project(files_project(then[1]))
            model = RunningModel(2, await Engine.start(other, seed=seed))
            around.next = (then[0], Successor(model, around.clock))
        search = msgspec.structs.replace(msgspec.convert(settings, Search, from_attributes=True), seed=seed)
        limits = msgspec.convert(settings, MissionLimits, from_attributes=True)
        mission = Mission(Terms(name="m", search=search, limits=limits), running, around)
        around.mission = mission
        await mission.run_or_raise()
    finally:
        if around.next is not None:
            await around.next[1].close()
        await around.engine.close()
        await world.close()
    return Played(around.rows, settings, [files] if then is None else [files, then[1]])
