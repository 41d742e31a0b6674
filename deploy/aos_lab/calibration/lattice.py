"""All that a recorded mission may have been, by the documents that keep what was drawn.

A mission is a row of layers: the states in which the world may have been before the first step and after
each, and how likely one leads to another if all outcomes of draws are equally likely. The engine's exact
belief gives that, one state at a time.
"""

from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from aos_lab.calibration.records import RecordedMission, RecordedStep
from aos_protocol.errors import AosError, IntractableError
from aos_protocol.messages import BeliefSummary, WeightedStates
from aos_solver.child.engine import Engine

Numbers = npt.NDArray[np.float64]
Outcomes = npt.NDArray[np.int64]

_MAX_STATES = 5000
"""The limit for one layer. A mission of which so little is known says little about any draw."""


class Lattice(msgspec.Struct, frozen=True):
    """`drawn[t][i, k]` is the outcome of draw `k` in state `i` of layer `t`, from 1, or 0 without one.

    `start` are the odds of the states of the first layer, and `links[t][i, j]` those of the way from state
    `i` of layer `t` to state `j` of the next.
    """

    start: Numbers
    links: tuple[Numbers, ...]
    drawn: tuple[Outcomes, ...]
    remark: str = ""

    @property
    def steps(self) -> int:
        return len(self.links)


class _State(msgspec.Struct, frozen=True):
    """`values` are the texts of its variables, `drawn` the outcomes of the draws."""

    values: dict[str, str]
    drawn: tuple[int, ...]


class Layers:
    """Asks an engine for what each state leads to, and remembers it."""

    def __init__(self, engine: Engine, variables: Sequence[str]) -> None:
        self._engine = engine
        self._variables = tuple(variables)
        self._known: dict[tuple[str, str, str, str], list[tuple[str, float]]] = {}
        self._states: dict[str, _State] = {}
        self._initial: WeightedStates

    async def begin(self) -> list[tuple[str, float]]:
        """The initial states with their probabilities."""
        await self._engine.reset_belief()
        self._initial = await self._exported()
        return [(text, weight) for weight, text in self._initial.particles]

    async def after(self, state: str, step: RecordedStep) -> list[tuple[str, float]]:
        """The states that may follow with that response, each with its probability together with it."""
        key = (state, step.action, step.response, repr(step.numbers))
        if key not in self._known:
            single = replace(self._initial, particles=((1.0, state),))
            await self._engine.import_belief(single)
            update = await self._engine.update(step.action, step.response, numbers=step.numbers)
            found: list[tuple[str, float]] = []
            if not update.is_impossible:
                belief = await self._exported()
                found = [(text, weight * update.probability) for weight, text in belief.particles]
            self._known[key] = found
        return self._known[key]

    async def state(self, text: str) -> _State:
        """Returns the values of a state's variables."""
        if text not in self._states:
            single = replace(self._initial, particles=((1.0, text),))
            values = _values(await self._engine.import_belief(single))
            drawn = tuple(int(values.get(variable, "0")) for variable in self._variables)
            self._states[text] = _State(values, drawn)
        return self._states[text]

    async def _exported(self) -> WeightedStates:
        belief = await self._engine.export_belief()
        if belief.error_bound > 0:
            raise IntractableError(
                "these documents cannot be calibrated: their steps have outcomes that cannot be counted",
                hint="Draws of numbers, and loops that draw, have to be estimated by hand",
            )
        return belief


async def lattice_of(mission: RecordedMission, layers: Layers) -> Lattice:
    """Builds the lattice up to the first step that the documents cannot explain, whatever their numbers;
    the remark names it."""
    start = await layers.begin()
    layer = [text for text, _ in start]
    odds = np.array([weight for _, weight in start])
    drawn, links, remark = [await _drawn(layer, layers)], [], mission.ends_early
    for number, step in enumerate(mission.steps, 1):
        try:
            following, link = await _next(layer, step, layers)
        except AosError as error:
            if isinstance(error, IntractableError):
                raise
            remark = f"step {number}, {step.action} > {step.response}: {error.message}"
            break
        if not following:
            remark = f"step {number}, {step.action} > {step.response}, cannot be by the documents"
            break
        layer = following
        links.append(link)
        drawn.append(await _drawn(layer, layers))
    return _pruned(odds, links, drawn, f"{mission.name}: {remark}" if remark else "")


async def _next(layer: Sequence[str], step: RecordedStep, layers: Layers) -> tuple[list[str], Numbers]:
    numbers: dict[str, int] = {}
    entries: list[tuple[int, int, float]] = []
    for row, text in enumerate(layer):
        for following, probability in await layers.after(text, step):
            if _agrees((await layers.state(following)).values, step):
                entries.append((row, numbers.setdefault(following, len(numbers)), probability))
    if len(numbers) > _MAX_STATES:
        raise IntractableError(
            f"after {step.action} the world may be in {len(numbers)} states", hint="Record more of its truth"
        )
    link = np.zeros((len(layer), len(numbers)))
    for row, column, probability in entries:
        link[row, column] += probability
    return list(numbers), link


def _agrees(values: dict[str, str], step: RecordedStep) -> bool:
    return all(name not in values or values[name] == value for name, value in step.truth)


async def _drawn(layer: Sequence[str], layers: Layers) -> Outcomes:
    rows = [(await layers.state(text)).drawn for text in layer]
    return np.array(rows, dtype=np.int64).reshape(len(layer), -1)


def _pruned(odds: Numbers, links: list[Numbers], drawn: list[Outcomes], remark: str) -> Lattice:
    """Returns the lattice without the states from which no way leads to the last layer."""
    lives: list[npt.NDArray[np.bool_]] = [np.ones(len(layer), dtype=bool) for layer in drawn]
    for number in range(len(links) - 1, -1, -1):
        lives[number] = np.asarray((links[number][:, lives[number + 1]] > 0).any(axis=1))
    return Lattice(
        start=odds[lives[0]],
        links=tuple(link[lives[n]][:, lives[n + 1]] for n, link in enumerate(links)),
        drawn=tuple(layer[lives[n]] for n, layer in enumerate(drawn)),
        remark=remark,
    )


def _values(summary: BeliefSummary) -> dict[str, str]:
    return {marginal.variable: next(iter(marginal.values)) for marginal in summary.marginals}
