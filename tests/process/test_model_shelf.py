"""Models that become ready while the mission takes one: which it gets, with which belief, who closes what."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from mappings import mapping_text

from aos_language.load import load_files
from aos_protocol.errors import ModelError
from aos_protocol.messages import BeliefSummary, ProjectRevision
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers import ExportedBeliefs
from aos_solver.child.engine import Engine
from aos_solver.mission.hot_plug import ModelShelf, RunningModel

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
    "look.am": mapping_text("light: True", "dark: True", project="lamp", skill="look"),
}


def lamp(revision: int) -> ProjectRevision:
    """Documents that differ in a cost, so that each revision is a model of its own."""
    files = {name: text.replace("COST", str(revision)).encode() for name, text in LAMP.items()}
    project = load_files(files).project
    assert project is not None
    return ProjectRevision(revision, "", project)


class Workshop:
    """A shelf whose engines are real and remembered, and a middleware that answers when the test lets it."""

    def __init__(self, cache_dir: Path) -> None:
        self.engines: list[Engine] = []
        self.middleware_is_asked = asyncio.Event()
        self.middleware_may_answer = asyncio.Event()
        self.shelf = ModelShelf(cache_dir, lambda remark: None, self._start, self._mapping_revision)

    async def _start(self, built: BuiltModel) -> Engine:
        self.engines.append(await Engine.start(built, seed=1))
        return self.engines[-1]

    async def _mapping_revision(self) -> int:
        self.middleware_is_asked.set()
        await self.middleware_may_answer.wait()
        return 100

    @property
    def living(self) -> list[Engine]:
        """Those with a child process."""
        return [engine for engine in self.engines if engine.pid is not None]


@asynccontextmanager
async def workshop(cache_dir: Path) -> AsyncIterator[Workshop]:
    """Gives a workshop and leaves nobody's child behind."""
    made = Workshop(cache_dir)
    try:
        yield made
    finally:
        await made.shelf.close()
        for engine in made.engines:
            await engine.close()


async def running_lamp(made: Workshop) -> RunningModel:
    """Revision 1 in a mission that has seen light."""
    await made.shelf.make(lamp(1))
    running = await made.shelf.first()
    await running.engine.update("look", "light")
    return running


async def test_a_revision_that_is_ready_while_an_older_one_is_taken_is_neither_lost_nor_left_running(
    cache_dir: Path,
) -> None:
    async with workshop(cache_dir) as made:
        running = await running_lamp(made)
        belief = await running.engine.export_belief()
        assert len(belief.particles) == 1
        await made.shelf.make(lamp(2))
        async with asyncio.TaskGroup() as tasks:
            taking = tasks.create_task(made.shelf.newest(running))
            await made.middleware_is_asked.wait()
            making = tasks.create_task(made.shelf.make(lamp(3)))
            # Revision 3 has its engine and wants its place on the shelf while revision 2 is being taken.
            while len(made.engines) < 3:
                await asyncio.wait({making}, timeout=0.01)
            await asyncio.wait({making}, timeout=0.05)
            made.middleware_may_answer.set()
        model = taking.result()
        assert model.engine.pid is not None, "the mission got an engine that was closed"
        newest = await made.shelf.newest(model)
        assert newest.revision == 3
        assert (await newest.engine.export_belief()).particles == belief.particles
        assert made.living == [newest.engine]


async def test_a_revision_that_nobody_took_is_closed_when_the_next_is_ready(cache_dir: Path) -> None:
    async with workshop(cache_dir) as made:
        for revision in (1, 2):
            await made.shelf.make(lamp(revision))
        assert len(made.engines) == 2
        assert (await made.shelf.first()).revision == 2
        assert made.living == made.engines[1:]


async def test_a_revision_that_cannot_take_the_belief_is_given_up_and_the_mission_goes_on(
    cache_dir: Path,
) -> None:
    async with workshop(cache_dir) as made:
        made.middleware_may_answer.set()
        running = await running_lamp(made)
        await made.shelf.make(lamp(2))
        made.engines[1].import_beliefs = refuse  # type: ignore[method-assign]
        assert await made.shelf.newest(running) is running
        assert await made.shelf.newest(running) is running
        assert made.living == [running.engine]


async def refuse(_: ExportedBeliefs) -> BeliefSummary:
    raise ModelError("the state does not fit")


async def test_a_shelf_that_ends_while_a_revision_waits_for_its_place_leaves_no_engine(
    cache_dir: Path,
) -> None:
    async with workshop(cache_dir) as made:
        running = await running_lamp(made)
        await made.shelf.make(lamp(2))
        taking = asyncio.create_task(made.shelf.newest(running))
        await made.middleware_is_asked.wait()
        making = asyncio.create_task(made.shelf.make(lamp(3)))
        while len(made.engines) < 3:
            await asyncio.wait({making}, timeout=0.01)
        for task in (making, taking):
            task.cancel()
            await asyncio.wait({task})
        await made.shelf.close()
        assert made.living == [running.engine]
