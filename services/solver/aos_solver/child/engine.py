"""The engine child of one model: started, asked, killed and started again.

The service survives whatever model code does: every question has a deadline; a crash, a hang and an exit
become a ModelError that names the document line; the next question starts a new child with the belief that
the old one had.
"""

from __future__ import annotations

import asyncio
import logging
import re
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, Self, TypedDict, TypeVar, Unpack

import msgspec

from aos_protocol.errors import AosError, ModelError
from aos_protocol.messages import BeliefSummary
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers import (
    BeliefCount,
    BeliefUpdate,
    EngineDescription,
    EngineFault,
    EngineStep,
    ExactValues,
    ExportedBelief,
    ExportedBeliefs,
    GoalReach,
    Listed,
    Plan,
    Prediction,
    Progress,
    Reach,
    Risks,
    SampleCount,
    Worlds,
    WorldStart,
    WorldState,
    WorldStep,
    WorldSteps,
    WrittenListing,
)
from aos_solver.child.command_line import command_line
from aos_solver.child.engine_child import (
    EngineChild,
    EngineStart,
    ImpossiblePolicy,
    KilledError,
    OverdueError,
)
from aos_solver.child.local_values import UnusableLocals, local_values_line
from aos_solver.child.observed_numbers import numbers_by_name, numbers_field
from aos_solver.child.replay import at_its_statement
from aos_solver.child.shared_memory import SharedMemory
from aos_solver.emission.emit import Bound
from aos_solver.emission.program import Observed

__all__ = ["Apart", "Engine", "ImpossiblePolicy", "Planner", "Stepping"]

Planner = Literal["pomcp", "despot", "sarsop", "auto"]

Stepping = Literal["code", "table"]
"""The ways to make steps: by the documents' code, or by a table of all steps, which POMCP has of small
models."""

log = logging.getLogger(__name__)

A = TypeVar("A")

_PARAMETER = re.compile(r"(\w+)=(\w+)")
"""A parameter in the name of an action, and the name of the state variable that is its value."""

ANSWER_DEADLINE_S = 30.0
PLANNING_DEADLINE_S = 120.0
"""The deadline of a search, beyond its budget in time. The first decision computes values before it
searches."""
LISTING_DEADLINE_S = 600.0
EXACT_TIME_S = 300.0
EXACT_BELIEF_BUDGET = 20_000_000


class Apart(TypedDict, total=False):
    """The restrictions of a decision.

    It is for none of the actions with the `barred` numbers, which nobody could carry out now. The skills
    `without` which it is made are not looked ahead with either. With `cautious` it is made for the belief in
    which nothing ran that was not observed.
    """

    barred: Sequence[int]
    without: Sequence[str]
    cautious: bool


class _Done(msgspec.Struct, frozen=True):
    """The answer that says nothing more."""


class Engine:
    """Owns the child process of one built model. Questions are asked one at a time."""

    def __init__(self, built: BuiltModel, seed: int, impossible_observation: ImpossiblePolicy) -> None:
        self._built = built
        self._seed = seed
        self._policy = impossible_observation
        self._child: EngineChild | None = None
        self._beliefs: SharedMemory | None = None
        self._changes = 0
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
    ) -> Self:
        """Starts the child on the initial belief; ModelError if the model cannot even begin.

        A child that is started again gets the belief, of which each child keeps a copy in our memory. Without
        `keeps_belief` it gets the initial belief.
        """
        engine = cls(built, seed, impossible_observation)
        if keeps_belief:
            engine._beliefs = SharedMemory.create("aos-beliefs")
        try:
            await engine._start_child()
        except BaseException:
            await engine.close()
            raise
        return engine

    async def close(self) -> None:
        """Ends the child. A closed engine is not asked again."""
        await self._drop_child()
        if self._beliefs is not None:
            self._beliefs.close()
            self._beliefs = None

    @property
    def model_digest(self) -> str:
        """The digest of the model that is asked."""
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
    def pid(self) -> int | None:
        """The guarded child's process id; None while there is no child."""
        return self._child.pid if self._child else None

    # --- questions -----------------------------------------------------------------------------------

    async def summary(self) -> BeliefSummary:
        return await self._ask("summary", BeliefSummary)

    async def reset_belief(self) -> BeliefSummary:
        """Goes back to the initial belief."""
        return await self._change_belief("reset_belief", BeliefSummary)

    async def plan(
        self,
        *,
        seed: int,
        simulations: int | None = None,
        time_s: float | None = None,
        horizon: int | None = None,
        planner: Planner = "pomcp",
        threads: int = 1,
        **apart: Unpack[Apart],
    ) -> Plan:
        """Searches from the current belief within the budget; `horizon` None takes the document's.

        With the planner `auto` the model's size decides, and the plan says why. POMCP can use
        several threads.
        """
        command = command_line(
            "plan",
            apart.get("barred", ()),
            simulations=simulations or 0,
            seconds=time_s or 0,
            seed=seed,
            horizon=horizon or 0,
            planner=planner,
            threads=threads,
            without=",".join(apart.get("without", ())) or None,
            cautious=apart.get("cautious") or None,
        )
        return await self._ask(command, Plan, deadline_s=PLANNING_DEADLINE_S + (time_s or 0))

    async def ponder(self, index: int, *, seed: int, time_s: float, threads: int = 1) -> None:
        """Begins to search below an action that is carried out now, so that the next plan starts with that.

        Returns at once. The search goes on for `time_s`, or until something else is asked.
        """
        budget = {"simulations": 0, "seconds": time_s, "threads": threads}
        await self._ask(command_line("ponder", action=index, seed=seed, **budget), _Done)

    async def count_processor_time(self, counts: bool) -> None:
        """Sets whether this child's budgets in seconds are of processor time, for measurements."""
        await self._ask(command_line("count_processor_time", counts=counts), _Done)

    async def tell_progress(self, every_s: float) -> None:
        """Has `on_progress` told that often at most, for measurements and tests; until then every 0.25 s."""
        await self._ask(command_line("tell_progress", between_ms=round(every_s * 1000)), _Done)

    async def exact(self, horizon: int | None = None) -> ExactValues:
        """Finite-horizon values by enumeration; IntractableError where that is not possible, and why."""
        command = command_line(
            "exact", horizon=horizon or 0, beliefs=EXACT_BELIEF_BUDGET, seconds=EXACT_TIME_S
        )
        return await self._ask(command, ExactValues, deadline_s=EXACT_TIME_S + ANSWER_DEADLINE_S)

    async def reach(self, seconds: float, max_seconds: float) -> Reach:
        """Looks for so much processor time at the states that the actions can lead to from the current
        belief.

        OverdueError where the last of many steps goes beyond `max_seconds`, here and in `rate`.
        """
        return await self._ask(command_line("reach", seconds=seconds, max_seconds=max_seconds), Reach)

    async def may_reach_goal(
        self, *, without: Sequence[str] = (), cautious: bool = False, seconds: float = 1.0, seed: int = 0
    ) -> GoalReach:
        """Looks for so much processor time whether actions lead to a goal without these skills."""
        command = command_line(
            "may_reach_goal",
            without=",".join(without) or None,
            cautious=cautious or None,
            seconds=seconds,
            seed=seed,
            horizon=0,
        )
        return await self._ask(command, GoalReach)

    async def list_states(self, max_states: int = 0) -> Listed:
        """Lists what one more decision leads to: from the current belief on where `max_states` is given, else
        from where the last call has ended. IntractableError where outcomes or states are too many."""
        return await self._ask(
            command_line("list", max_states=max_states), Listed, deadline_s=LISTING_DEADLINE_S
        )

    async def write_listing(self, model: Path, states: Path) -> WrittenListing:
        """Writes what is listed (`cpp/point_based/flat_file.hpp`), and the texts of states, one a line."""
        command = command_line("write_listing", model=model, states=states)
        return await self._ask(command, WrittenListing, deadline_s=LISTING_DEADLINE_S)

    async def risks(self, seed: int) -> Risks:
        """Returns what each action risks of the mission's constraints; the seed is for what has to be
        sampled."""
        return await self._ask(command_line("risks", seed=seed), Risks)

    async def predict(self, index: int, *, cautious: bool = False) -> Prediction:
        """Returns the responses that may be observed after an action."""
        return await self._ask(command_line("predict", action=index, cautious=cautious or None), Prediction)

    async def update(
        self,
        action: str,
        response: str,
        local_variables: Mapping[str, str] | None = None,
        numbers: Mapping[str, Any] | None = None,
        refuted_below: float = 0.01,
    ) -> BeliefUpdate:
        """Bayes' rule after an action and its observation: a response, and the numbers reported beside it.

        The local variables of a real outcome, as text, correct the belief where the skill's documents say so.
        The update's remark says why numbers or local variables could not be used. The cautious belief is
        given up once all that was observed since it began is less probable in it by this factor.
        """
        index = self._index(action)
        skill = self.description.actions[index].skill
        observed = self.observed.get(skill, ())
        question = {
            "action": index,
            "response": response,
            "numbers": numbers_field(observed, numbers or {}),
            "refuted_below": refuted_below,
        }
        update = await self._corrected(action, question, local_variables)
        if not update.has_other_numbers:
            return update
        given = {**(numbers or {}), **(local_variables or {})}
        given_text = ", ".join(f"{number.name} = {given.get(number.name, 'nothing')}" for number in observed)
        remark = (
            f"the numbers of {action} do not count ({given_text}): "
            f"the model reports others with the response {response}"
        )
        log.warning("%s", remark)
        remark = f"{remark}; {update.remark}" if update.remark else remark
        return msgspec.structs.replace(update, remark=remark)

    async def _corrected(
        self, action: str, question: Mapping[str, Any], local_variables: Mapping[str, str] | None
    ) -> BeliefUpdate:
        """The answer to an update, with the local variables where the skill's documents want them."""
        wanted = self._built.emitted.locals.get(self.description.actions[self._index(action)].skill)
        command = command_line("update", **question)
        if wanted is None or local_variables is None:
            return await self._change_belief(command, BeliefUpdate)
        try:
            command = command_line("update", **question, locals=local_values_line(wanted, local_variables))
        except UnusableLocals as reason:
            update, why = await self._change_belief(command, BeliefUpdate), str(reason)
        else:
            before = self._changes
            update = await self._change_belief(command, BeliefUpdate)
            if update.uncorrected is None:
                return update
            why = (await self._correction_fault(update.uncorrected, command, before)).message
        remark = f"the local variables of {action} do not correct the belief: {why}"
        log.warning("%s", remark)
        return msgspec.structs.replace(update, remark=remark)

    async def _correction_fault(self, fault: EngineFault, command: str, before: int) -> AosError:
        """Returns why local variables did not correct the belief that was there after so many changes.

        The statement is looked for once: the mission waits for it, and meets the fault at every outcome.
        """
        if fault not in self._correction_faults:
            assert self._child is not None
            error = self._child.fault(fault.code, fault.text, fault.piece)
            commands = [*self._restoration(before), command]
            found = await at_its_statement(error, self._built, self._start, commands)
            self._correction_faults[fault] = found
        return self._correction_faults[fault]

    async def update_without_observation(self, action: str, *, ran_probability: float) -> BeliefUpdate:
        """The mixture of "it ran" and "it did not", with one cause for all such ends in a row of a skill."""
        index = self._index(action)
        command = command_line("update_without_observation", action=index, ran_probability=ran_probability)
        return await self._change_belief(command, BeliefUpdate)

    async def export_belief(
        self, *, is_whole: bool = True, cautious: bool = False, number: int | None = None
    ) -> ExportedBelief:
        """The whole belief, however many pieces it takes; nobody changes it meanwhile.

        Without `is_whole` states are told without what does not matter. A `number` is that of one of all
        beliefs, see `export_beliefs`.
        """
        fields = {"is_whole": is_whole, "cautious": cautious or None, "number": number}
        belief = await self._ask(command_line("export_belief", first=0, **fields), ExportedBelief)
        particles = list(belief.particles)
        while len(particles) < belief.states:
            command = command_line("export_belief", first=len(particles), **fields)
            particles += (await self._ask(command, ExportedBelief)).particles
        return msgspec.structs.replace(belief, particles=tuple(particles))

    async def export_beliefs(self) -> ExportedBeliefs:
        """All that is believed: the belief of each hypothesis, and the cautious one; see hypotheses.hpp."""
        count = await self._ask("describe_beliefs", BeliefCount)
        beliefs = [await self.export_belief(number=number) for number in range(count.beliefs)]
        return ExportedBeliefs(count.words, tuple(beliefs))

    async def draw_belief(self) -> BeliefSummary:
        """Goes back to the initial belief, as particles even where it could be enumerated."""
        return await self._change_belief("draw_belief", BeliefSummary)

    async def import_belief(self, belief: ExportedBelief) -> BeliefSummary:
        """Takes over the belief of an engine whose model has the same state layout (`state_digest`)."""
        return await self._change_belief(belief.command, BeliefSummary)

    async def import_beliefs(self, beliefs: ExportedBeliefs) -> BeliefSummary:
        """Takes over all that an engine believes whose model has the same state layout."""
        *first, last = beliefs.commands
        for command in first:
            await self._ask(command, _Done)
        return await self._change_belief(last, BeliefSummary)

    async def reset_world(self, seed: int) -> WorldStart:
        """Starts a hidden state, drawn from the initial belief, for missions without a robot."""
        command = command_line("reset_world", seed=seed)
        start = await self._ask(command, WorldStart)
        self._world = [command]
        return start

    async def step_world(self, index: int) -> WorldStep:
        """Runs an action on the hidden state, by the model."""
        command = command_line("step_world", action=index)
        step = await self._ask(command, EngineStep)
        self._world.append(command)
        observed = self.observed.get(self.description.actions[index].skill, ())
        numbers = numbers_by_name(observed, step.numbers)
        return WorldStep(step.reward, step.response, step.ending, numbers, step.violations)

    async def world_state(self) -> str:
        """The hidden state as text for people."""
        return (await self._ask("show_world", WorldState)).state

    async def reset_worlds(self, seeds: Sequence[int]) -> Worlds:
        """Starts a hidden state for each seed, to be acted in side by side."""
        return await self._ask(command_line("reset_worlds", seeds), Worlds)

    async def step_worlds(self, indices: bytes) -> WorldSteps:
        """Runs an action in each world, by the bytes of an int32 for each; -1 starts a world anew."""
        return await self._ask(command_line("step_worlds", actions=b64encode(indices).decode()), WorldSteps)

    async def rate(
        self, seconds: float, seed: int, stepping: Stepping = "code", max_seconds: float | None = None
    ) -> SampleCount:
        """Draws samples with random actions for so long; by a table none where searches use no table."""
        name = "rate" if stepping == "code" else "rate_by_table"
        command = command_line(name, seconds=seconds, seed=seed, max_seconds=max_seconds)
        return await self._ask(command, SampleCount, deadline_s=seconds + ANSWER_DEADLINE_S)

    def variables_of(self, action: str) -> dict[str, str]:
        """The state variables that parameters of the action stand for; computed parameters stand for none."""
        skill = self.description.actions[self._index(action)].skill
        return dict(_PARAMETER.findall(action)) if skill in self._built.emitted.choosing_skills else {}

    # --- the child -----------------------------------------------------------------------------------

    def _index(self, action: str) -> int:
        for index, grounded in enumerate(self.description.actions):
            if grounded.name == action:
                return index
        raise ModelError(f"there is no action {action}", code="AOS501")

    async def _change_belief(self, command: str, kind: type[A]) -> A:
        answer = await self._ask(command, kind)
        self._changes += 1
        return answer

    async def _ask(self, command: str, kind: type[A], *, deadline_s: float = ANSWER_DEADLINE_S) -> A:
        async with self._asking:
            if self._child is None or not self._child.is_running:
                await self._restart_child()
            assert self._child is not None
            try:
                return await self._child.ask(command, kind, deadline_s, self.on_progress)
            except KilledError as error:
                log.warning("asking again: %s", error)
                await self._restart_child()
                return await self._child.ask(command, kind, deadline_s, self.on_progress)
            except OverdueError:
                raise
            except AosError as error:
                raise await self._located(error, command) from None

    async def _located(self, fault: AosError, command: str) -> AosError:
        """The fault at its statement, if a replay of the command finds it."""
        commands = [*self._restoration(self._changes), *self._world, command]
        return await at_its_statement(fault, self._built, self._start, commands)

    async def _start_child(self) -> None:
        try:
            self._child = await EngineChild.start(self._built, self._start)
        except AosError as error:
            raise await at_its_statement(error, self._built, self._start, []) from None
        self.description = self._child.description

    @property
    def _start(self) -> EngineStart:
        return EngineStart(self._seed, self._policy, "" if self._beliefs is None else self._beliefs.path)

    async def _restart_child(self) -> None:
        await self._drop_child()
        await self._start_child()
        assert self._child is not None
        try:
            for command in [*self._restoration(self._changes), *self._world]:
                await self._child.ask(command, _Done, ANSWER_DEADLINE_S)
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
