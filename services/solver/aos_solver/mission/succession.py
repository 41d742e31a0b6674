"""The succession of missions in a system that stays: which model comes next, and with which belief.

Each mission has an engine of its own, started with the mission's seed: so it decides as the first mission of
a system that is started with this seed. What it keeps of the mission before is the belief alone.
"""

from collections.abc import Awaitable, Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from msgspec.structs import replace

from aos_language.mission_parameters import mission_value, usable_values
from aos_protocol.documents import MissionValue, Project
from aos_protocol.errors import PlanningError
from aos_protocol.messages import Activate, Outcome, StartMission
from aos_solver.child.answers.beliefs import ExportedBeliefs
from aos_solver.child.engine import Engine
from aos_solver.mission.conditions import built_with_conditions
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.model_shelf import ModelShelf
from aos_solver.mission.models.past import Beginning, Past
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.records.logbook import Logbooks
from aos_solver.mission.records.memory import MissionMemory, PastStep
from aos_solver.mission.rules.terms import Terms

KEEP = "keep"
"""The belief of a mission that begins with the last one of the mission before; all others begin with the
initial one."""

TermsOf = Callable[[str, int, int, RunningModel], Terms]
"""The terms of a mission by its name, seed and epoch, for a model."""


class Begun(NamedTuple):
    """An engine with the belief with which a mission begins, and how that came to be."""

    engine: Engine
    past: Past


class _Kept(NamedTuple):
    """The last belief of a mission, and how it came to be."""

    beliefs: ExportedBeliefs
    past: Past


class _Drawn(NamedTuple):
    """A mission's seed and its values of mission parameters."""

    seed: int
    values: dict[str, str]


class Succession:
    """Makes the engines with which missions begin, or are taken up.

    `terms` are those of each mission, `documents` are those of a revision. `mission_values` are set for
    missions that set no others.
    """

    def __init__(
        self,
        books: Logbooks,
        terms: TermsOf,
        documents: Callable[[int], Awaitable[Project]],
        cache_dir: Path,
        mission_values: tuple[MissionValue, ...] = (),
    ) -> None:
        self._books = books
        self._terms = terms
        self._documents = documents
        self._cache_dir = cache_dir
        self._mission_values = mission_values

    def values(self, start: StartMission | None) -> tuple[MissionValue, ...]:
        """The values of mission parameters that are set for a mission; the last one for each counts."""
        own = start.values if start is not None else {}
        return (*self._mission_values, *(mission_value(name, text) for name, text in own.items()))

    async def model(
        self, shelf: ModelShelf, running: RunningModel, start: StartMission, last: Mission | None
    ) -> RunningModel:
        """The newest model that is ready on both sides, for a mission that follows the `last` one so."""
        if start.belief != KEEP:
            return await shelf.replacement(running)
        takeover = await shelf.newest(running, last.past) if last is not None else None
        return takeover.model if takeover is not None else running

    async def next(self, running: RunningModel, start: StartMission, last: Mission | None) -> Begun:
        """The beginning of the next mission; errors are those of `begin_with`.

        `last` is the mission before, if it has run in this process: the running engine has its last belief.
        """
        values = usable_values(self.values(start), running.engine.parameters)
        kept = await self._kept(running, start, last)
        return await self._begun(running, start, _Drawn(self._books.next_seed, values), kept)

    async def at_start_of(self, running: RunningModel, number: int) -> Begun:
        """The beginning of a mission that began before.

        What was believed before it, where it kept that, is the fold of the missions before it.
        """
        first = number
        while first > 1 and self._start_of(self._books.memory_of(first)).belief == KEEP:
            first -= 1
        kept = None
        for earlier in range(first, number):
            memory = self._books.memory_of(earlier)
            kept = await self._at_the_end(running, await self._begun_before(running, memory, kept), memory)
        return await self._begun_before(running, self._books.memory_of(number), kept)

    async def _kept(self, running: RunningModel, start: StartMission, last: Mission | None) -> _Kept | None:
        if start.belief != KEEP:
            return None
        book = self._books.newest
        if book is None:
            message = "there is no mission before this one whose belief it could keep"
            raise PlanningError(message, code="AOS516", hint="Begin with `--belief initial`")
        if last is not None:
            return _Kept(await running.engine.export_beliefs(), last.past)
        begun = await self.at_start_of(running, book.number)
        return await self._at_the_end(running, begun, self._books.memory_of(book.number))

    async def _begun_before(self, running: RunningModel, memory: MissionMemory, kept: _Kept | None) -> Begun:
        assert memory.begun is not None
        start, parameters = self._start_of(memory), running.engine.parameters
        values = {name: text for name, text in memory.mission_parameters.items() if name in parameters}
        drawn = _Drawn(memory.begun.seed, values)
        return await self._begun(running, start, drawn, kept if start.belief == KEEP else None)

    async def _begun(
        self, running: RunningModel, start: StartMission, drawn: _Drawn, kept: _Kept | None
    ) -> Begun:
        engine = await running.engine.anew(drawn.seed, drawn.values)
        past = Past(self._terms("", drawn.seed, 1, running).limits.refuted_below)
        conditioned = partial(self._conditioned, running, start, drawn)
        try:
            beliefs = kept.beliefs if kept is not None else None
            await begin_with(engine, start, beliefs, conditioned, past.refuted_below)
        except BaseException:
            await engine.close()
            raise
        if kept is not None:
            past.steps += kept.past.steps
        if kept is not None or start.idle or start.given:
            past.steps.append(Beginning(start.idle, start.given))
        return Begun(engine, past)

    async def _conditioned(self, running: RunningModel, start: StartMission, drawn: _Drawn) -> Engine:
        documents = await self._documents(running.revision)
        built = await built_with_conditions(documents, start.given, self._cache_dir)
        built = replace(built, mission_values=drawn.values)
        return await Engine.start(built, seed=drawn.seed)

    async def _at_the_end(self, running: RunningModel, begun: Begun, memory: MissionMemory) -> _Kept:
        """Returns what is believed after a mission that is over, and closes its engine."""
        assert memory.begun is not None
        steps = memory.steps
        if memory.pending is not None and memory.pending.outcome is not None:
            # It ended before it could take this outcome.
            steps = (*steps, PastStep(memory.pending.decision, memory.pending.outcome, 0))
        terms = self._terms(memory.begun.mission, memory.begun.seed, memory.epoch, running)
        memory = replace(memory, steps=steps, pending=None, state=None)
        model = RunningModel(running.revision, begun.engine)
        mission = Mission(terms, model, _Over(), memory, begun.past)
        try:
            await mission.replay()
            return _Kept(await begun.engine.export_beliefs(), mission.past)
        finally:
            await begun.engine.close()

    @staticmethod
    def _start_of(memory: MissionMemory) -> StartMission:
        return (memory.begun.start if memory.begun is not None else None) or StartMission()


class _Over(QuietPorts):
    """The surroundings of a mission that is over: nothing moves."""

    async def activate(self, request: Activate, action: str) -> Outcome:
        """Is not called."""
        raise AssertionError("a mission that is over has no step to bring to its end")


async def begin_with(
    engine: Engine,
    start: StartMission,
    kept: ExportedBeliefs | None,
    conditioned: Callable[[], Awaitable[Engine]],
    refuted_below: float,
) -> None:
    """Brings an engine that is on its initial belief to the belief with which a mission begins.

    `kept` is the last belief of the mission before, None where the mission begins with the initial one.
    `conditioned` starts an engine of the same seed whose constraints are what is given. PlanningError AOS516
    where that has probability 0; what is believed is then of no use.
    """
    if not start.given:
        await _begin(engine, start, kept)
        return
    async with await conditioned() as aside:
        await _begin(aside, start, kept)
        answer = await aside.condition(refuted_below)
        if answer.probability <= 0:
            given = " and ".join(f"`{text}`" for text in start.given)
            raise PlanningError(
                f"{given} has probability 0 in the {'last' if kept else 'initial'} belief",
                code="AOS516",
                hint="See `aos decisions` for what is believed, or begin with `--belief initial`"
                if kept
                else "See the initial belief in the environment document",
            )
        await engine.import_beliefs(await aside.export_beliefs())


async def _begin(engine: Engine, start: StartMission, kept: ExportedBeliefs | None) -> None:
    if kept is not None:
        await engine.import_beliefs(kept)
    if kept is not None or start.idle:
        await engine.begin_mission(start.idle)
