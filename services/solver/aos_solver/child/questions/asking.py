"""The child process of one model behind its questions: started, asked, killed and started again.

The service survives whatever model code does: every question has a deadline; a crash, a hang and an exit
become a ModelError that names the document line; the next question starts a new child with the belief that
the old one had.
"""

import asyncio
import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Self, TypeVar

import msgspec
from msgspec.structs import replace

from aos_language.mission_parameters import ParameterLeaf
from aos_protocol.errors import AosError, ModelError
from aos_protocol.messages import BeliefSummary
from aos_runtime.background import Closing
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers.beliefs import BeliefUpdate, Believed, Conditioned
from aos_solver.child.answers.models import EngineDescription, EngineFault, Progress
from aos_solver.child.blame.replay import at_its_statement
from aos_solver.child.lines.belief_draws import BeliefDraws
from aos_solver.child.lines.command_line import command_line, numbers_of, with_change
from aos_solver.child.process.engine_child import (
    EngineChild,
    EngineStart,
    ImpossiblePolicy,
    KilledError,
    OverdueError,
)
from aos_solver.child.process.shared_memory import SharedMemory
from aos_solver.emission.emit import Bound
from aos_solver.emission.program import Observed

log = logging.getLogger(__name__)

A = TypeVar("A")
B = TypeVar("B", BeliefSummary, BeliefUpdate, Conditioned, Believed)

ANSWER_DEADLINE_S = 30.0

_KILLED_TIMES = 4
"""A child may be killed so often over one question, also while it is started anew."""

_FIRST_MONITOR = 1 << 24


class Done(msgspec.Struct, frozen=True):
    """The answer that says nothing more."""


class Asking(Closing):
    """Owns the child process of one built model. Questions are asked one at a time."""

    def __init__(
        self, built: BuiltModel, seed: int, impossible_observation: ImpossiblePolicy, niceness: int = 0
    ) -> None:
        self._built = built
        self._seed = seed
        self._policy = impossible_observation
        self._niceness = niceness
        self._child: EngineChild | None = None
        self._beliefs: SharedMemory | None = None
        self._listing: SharedMemory | None = None
        self._changes = 0
        self._starts = 0
        self._draws = BeliefDraws(seed)
        self._correction_faults: dict[EngineFault, AosError] = {}
        self._world: list[str] = []
        self._asking = asyncio.Lock()
        self.on_progress: Callable[[Progress], None] | None = None
        """The function that hears how far the work on an answer is, some times a second where it takes
        long."""
        self.description: EngineDescription

    @classmethod
    async def start(
        cls,
        built: BuiltModel,
        *,
        seed: int,
        impossible_observation: ImpossiblePolicy = "widen",
        keeps_belief: bool = True,
        niceness: int = 0,
    ) -> Self:
        """Starts the child on the initial belief; ModelError if the model cannot even begin.

        A child that is started again gets the belief, of which each child keeps a copy in our memory. Without
        `keeps_belief` it gets the initial belief. The `niceness` is added to this process's own.
        """
        engine = cls(built, seed, impossible_observation, niceness)
        if keeps_belief:
            engine._beliefs = SharedMemory.create("aos-beliefs")
        engine._listing = SharedMemory.create("aos-listing")
        try:
            await engine._begin_child()
        except BaseException:
            await engine.close()
            raise
        return engine

    async def start_with(self, mission_values: Mapping[str, str]) -> None:
        """Has these values of mission parameters, and the defaults of all others, from now on.

        The values are in their canonical spelling; those of parts that the model does not have are left out.
        Where they are other ones the child is started anew, on the initial belief: all that was computed with
        the old ones is gone. Nothing is compiled.
        """
        built = self._built_with(mission_values)
        if built.mission_values == self._built.mission_values:
            return
        async with self._asking:
            self._built = built
            self._changes = 0
            self._draws = BeliefDraws(self._seed)
            self._world = []
            await self._drop_child()
            await self._begin_child()

    async def anew(self, seed: int, mission_values: Mapping[str, str]) -> Self:
        """Starts another engine of the same model, on its initial belief; errors are those of `start`.

        The values are as in `start_with`.
        """
        other = await self.start(
            self._built_with(mission_values), seed=seed, impossible_observation=self._policy
        )
        other.on_progress = self.on_progress
        return other

    def _built_with(self, mission_values: Mapping[str, str]) -> BuiltModel:
        values = {name: text for name, text in mission_values.items() if name in self.parameters}
        return replace(self._built, mission_values=values)

    async def forget(self) -> None:
        """Starts the child anew with what is believed, as after a crash: searches begin without a tree."""
        async with self._asking:
            await self._restart_child()

    async def close(self) -> None:
        """Ends the child; closing twice does nothing. A closed engine is not asked again."""
        await self._drop_child()
        for memory in (self._beliefs, self._listing):
            if memory is not None:
                memory.close()
        self._beliefs = self._listing = None

    @property
    def model_digest(self) -> str:
        return self._built.emitted.digest

    @property
    def state_digest(self) -> str:
        """The digest of the state's layout: engines with the same one can exchange beliefs."""
        return self._built.emitted.state_digest

    @property
    def observed(self) -> Mapping[str, tuple[Observed, ...]]:
        """The numbers that skills report beside their responses, for those that do."""
        return self._built.emitted.observed

    @property
    def bounds(self) -> tuple[Bound, ...]:
        """The mission's constraints."""
        return self._built.emitted.bounds

    @property
    def parameters(self) -> Mapping[str, ParameterLeaf]:
        """The parts of mission parameters, by name; their values are in the description."""
        return self._built.emitted.parameters

    @property
    def starts(self) -> int:
        """The number of times that the child was started. A new child has the belief, and no search tree."""
        return self._starts

    @property
    def build_digest(self) -> str:
        """The digest of the model's text, the engine's headers, the compiler and its flags."""
        return self._built.digest

    @property
    def pid(self) -> int | None:
        """The guarded child's process id; None while there is no child."""
        return self._child.pid if self._child else None

    def variables_of(self, action: str) -> dict[str, str]:
        """The state variables that parameters of the action stand for; computed parameters stand for none."""
        grounded = self.description.actions[self.index_of(action)]
        return grounded.arguments if grounded.skill in self._built.emitted.choosing_skills else {}

    def has_action(self, action: str) -> bool:
        """Returns whether the model has a grounded action of this name."""
        return any(grounded.name == action for grounded in self.description.actions)

    def index_of(self, action: str) -> int:
        """Returns the number of a grounded action; ModelError AOS501 where there is none of this name."""
        for index, grounded in enumerate(self.description.actions):
            if grounded.name == action:
                return index
        raise ModelError(f"there is no action {action}", code="AOS501")

    def _index_of_monitor(self, monitor: str) -> int:
        """The number that stands for a monitor where an action is asked for; see step.hpp."""
        return _FIRST_MONITOR + self.description.monitors.index(monitor)

    async def _change_belief(self, command: str, kind: type[B]) -> B:
        answer = await self._ask(with_change(command, self._changes + 1), kind)
        self._changes += 1
        return answer

    async def _ask(self, command: str, kind: type[A], *, deadline_s: float = ANSWER_DEADLINE_S) -> A:
        async with self._asking:
            for again in range(_KILLED_TIMES + 1):
                try:
                    return await self._asked(command, kind, deadline_s)
                except KilledError as error:
                    if again == _KILLED_TIMES:
                        raise
                    log.warning("asking again: %s", error)
            raise AssertionError

    async def _asked(self, command: str, kind: type[A], deadline_s: float) -> A:
        """The answer of the child, or of another one that is started with the same belief."""
        if self._child is None or not self._child.is_running:
            await self._restart_child()
        assert self._child is not None
        try:
            return await self._child.ask(command, kind, deadline_s, self.on_progress)
        except (KilledError, OverdueError):
            raise
        except asyncio.CancelledError:
            # Its answer would be taken for that of the next question.
            await self._drop_child()
            raise
        except AosError as error:
            raise await self._at_its_statement(error, self._changes, [*self._world, command]) from None

    async def _at_its_statement(self, fault: AosError, changes: int, commands: Sequence[str]) -> AosError:
        """The fault at its statement, if a replay of the commands finds it after so many changes."""
        commands = [*self._restoration(changes), *commands]
        return await at_its_statement(fault, self._built, self._start, commands)

    async def _begin_child(self) -> None:
        """Starts a child on the initial belief, and another one where it is killed meanwhile."""
        for again in range(_KILLED_TIMES + 1):
            try:
                return await self._start_child()
            except KilledError as error:
                if again == _KILLED_TIMES:
                    raise
                log.warning("starting again: %s", error)

    async def _start_child(self) -> None:
        try:
            self._child = await EngineChild.start(self._built, self._start)
        except AosError as error:
            raise await at_its_statement(error, self._built, self._start, []) from None
        self.description = self._child.description
        self._starts += 1

    @property
    def _start(self) -> EngineStart:
        values = parameter_arguments(self._built.emitted.parameters, self._built.mission_values)
        return EngineStart(self._seed, self._policy, self._beliefs, self._listing, values, self._niceness)

    async def _restart_child(self) -> None:
        await self._drop_child()
        await self._start_child()
        assert self._child is not None
        try:
            for command in [*self._restoration(self._changes), *self._world]:
                await self._child.ask(command, Done, ANSWER_DEADLINE_S)
        except AosError:
            await self._drop_child()
            raise

    def _restoration(self, changes: int) -> list[str]:
        """Returns the commands that bring a new child to the belief after so many changes, the last or the
        one before it."""
        is_kept = changes > 0 and self._beliefs is not None
        return [command_line("restore_belief", change=changes)] if is_kept else []

    async def _drop_child(self) -> None:
        child, self._child = self._child, None
        if child is not None:
            await child.close()


def parameter_arguments(leaves: Mapping[str, ParameterLeaf], values: Mapping[str, str]) -> tuple[str, ...]:
    """The values, each that of a leaf in its canonical spelling, as a child's start takes them: `name=value`
    with the value as `StateReader` in state_text.hpp reads it."""
    return tuple(
        f"{name}={' '.join(map(str, numbers_of(_value(leaves[name], text))))}"
        for name, text in values.items()
    )


def _value(leaf: ParameterLeaf, text: str) -> int | float | str:
    if leaf.values:
        return leaf.values.index(text)
    if leaf.type == "bool":
        return text == "true"
    if leaf.type == "string":
        return text
    return float(text) if leaf.type in ("float", "double") else int(text)
