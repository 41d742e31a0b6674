import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from projects import files_project

from aos_deploy.places import cache_dir
from aos_protocol.errors import ModelError
from aos_protocol.messages import BeliefSummary, ProjectRevision
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers.beliefs import ExportedBeliefs
from aos_solver.child.engine import Engine
from aos_solver.mission.models.model_shelf import ModelShelf
from aos_solver.mission.models.past import Evidence, Past, updated
from aos_solver.mission.models.takeover import RunningModel

LAMP = {
    "lamp.ef": """project: lamp
horizon: 3
state_variable: bool is_on
initial_belief:
state.is_on = AOS.Bernoulli(0.5);
reward_code:
if (state.is_on) __reward = 1;
""",
    "look.sd": """project: lamp
dynamic_model:
__moduleResponse = state.is_on ? light : dark;
__reward = -COST;
""",
}

LIGHT = Evidence("look", "look", "light")


def lamp(revision: int) -> ProjectRevision:
    files = {name: text.replace("COST", str(revision)).encode() for name, text in LAMP.items()}
    return ProjectRevision(revision, "", files_project(files))


class Workshop:
    """A shelf whose engines are real and remembered, and a middleware that has what the test says."""

    def __init__(self):
        self.engines: list[Engine] = []
        self.mapped = {1, 2, 3}
        self.past = Past()
        self.shelf = ModelShelf(
            cache_dir(), lambda remark: None, self._start, lambda revision: revision in self.mapped
        )

    async def _start(self, built: BuiltModel) -> Engine:
        self.engines.append(await Engine.start(built, seed=1))
        return self.engines[-1]

    async def taken(self, running: RunningModel) -> RunningModel:
        takeover = await self.shelf.newest(running, self.past)
        return running if takeover is None else takeover.model

    @property
    def living(self) -> list[Engine]:
        return [engine for engine in self.engines if engine.pid is not None]


@asynccontextmanager
async def workshop() -> AsyncIterator[Workshop]:
    """Gives a workshop, of which nobody's child is left."""
    made = Workshop()
    try:
        yield made
        await made.shelf.close()
        assert made.living == []
    finally:
        for engine in made.engines:
            await engine.close()


async def running_lamp(made: Workshop) -> RunningModel:
    await made.shelf.make(lamp(1))
    running = await made.shelf.first()
    made.past.steps.append(LIGHT)
    await updated(running.engine, LIGHT, 0.01)
    return running


class Slowed:
    """An engine's import that waits until the test lets it go on."""

    def __init__(self, engine: Engine):
        self.begun, self.may_go_on = asyncio.Event(), asyncio.Event()
        self._import = engine.import_beliefs
        engine.import_beliefs = self

    async def __call__(self, beliefs: ExportedBeliefs) -> BeliefSummary:
        self.begun.set()
        await self.may_go_on.wait()
        return await self._import(beliefs)


async def test_a_revision_that_is_ready_while_an_older_one_is_taken_is_neither_lost_nor_left_running():
    async with workshop() as made:
        running = await running_lamp(made)
        belief = await running.engine.export_belief()
        assert len(belief.particles) == 1
        await made.shelf.make(lamp(2))
        slowed = Slowed(made.engines[1])
        async with asyncio.TaskGroup() as tasks:
            taking = tasks.create_task(made.taken(running))
            await slowed.begun.wait()
            making = tasks.create_task(made.shelf.make(lamp(3)))
            # Revision 3 has its engine and wants its place on the shelf while revision 2 is being taken.
            while len(made.engines) < 3:
                await asyncio.wait({making}, timeout=0.01)
            slowed.may_go_on.set()
        model = taking.result()
        assert model.revision == 2
        assert model.engine.pid is not None, "the mission got an engine that was closed"
        newest = await made.taken(model)
        assert newest.revision == 3
        assert (await newest.engine.export_belief()).particles == belief.particles


async def test_a_revision_that_nobody_took_is_closed_when_the_next_is_ready():
    async with workshop() as made:
        for revision in (1, 2):
            await made.shelf.make(lamp(revision))
        assert len(made.engines) == 2
        assert (await made.shelf.first()).revision == 2
        await made.shelf.settled()
        assert made.living == made.engines[1:]


async def test_a_revision_that_the_middleware_does_not_run_is_not_waited_for():
    async with workshop() as made:
        made.mapped.remove(2)
        running = await running_lamp(made)
        await made.shelf.make(lamp(2))
        assert await made.taken(running) is running
        made.mapped.add(2)
        assert (await made.taken(running)).revision == 2


async def test_a_revision_that_cannot_import_the_belief_replays_the_mission_instead():
    async with workshop() as made:
        running = await running_lamp(made)
        await made.shelf.make(lamp(2))
        made.engines[1].import_beliefs = refuse
        assert await made.taken(running) is running
        takeover = None
        while takeover is None:
            await asyncio.wait({asyncio.create_task(running.engine.summary())})
            takeover = await made.shelf.newest(running, made.past)
        assert (takeover.row.by, takeover.row.steps, takeover.row.why) == (
            "replay",
            1,
            "AOS201: the state does not fit",
        )


async def refuse(_: ExportedBeliefs) -> BeliefSummary:
    raise ModelError("the state does not fit")


async def test_a_shelf_that_ends_while_a_revision_waits_for_its_place_leaves_no_engine():
    async with workshop() as made:
        running = await running_lamp(made)
        await made.shelf.make(lamp(2))
        slowed = Slowed(made.engines[1])
        taking = asyncio.create_task(made.taken(running))
        await slowed.begun.wait()
        making = asyncio.create_task(made.shelf.make(lamp(3)))
        while len(made.engines) < 3:
            await asyncio.wait({making}, timeout=0.01)
        for task in (making, taking):
            task.cancel()
            await asyncio.wait({task})
