"""The hidden worlds of a bundle's model in its engine child, for callers that are not asynchronous.

Numbers are what learning programs take, and a model lists the responses of its skills; so an observation is
a number. Text observations have no list. They are given as their bytes, in an array of fixed length: what is
alike in two texts stays alike, which numbers in the order of appearance would lose. Where skills report
numbers beside their responses, an observation is a dict of both. Reported numbers stand in a row. Names of
all skills share it: a name has one column, or as many as there is room for where it is an array.
"""

import asyncio
from collections.abc import Coroutine, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, InvalidAction
from numpy.typing import NDArray

from aos_deploy.bundles.files import project_at
from aos_deploy.deployment.mission_values import values_of_mapping, with_values
from aos_deploy.places import cache_dir
from aos_protocol.diagnostics import Span
from aos_protocol.documents import MissionValue
from aos_solver.building.project_build import build_project
from aos_solver.child.answers.worlds import WorldSteps
from aos_solver.child.engine import Engine
from aos_solver.emission.program import Observed

_INDEX_BITS = 16


class Numbers(NamedTuple):
    """A row for each world; what was not reported is 0 in both arrays."""

    values: NDArray[np.float64]
    is_reported: NDArray[np.int8]


class NumberColumns:
    """`names` are those of the columns: `depth_m`, `echoes_m[0]`, `echoes_m[1]`, ..."""

    def __init__(
        self, skills: Sequence[str], observed: Mapping[str, tuple[Observed, ...]], array_room: int
    ) -> None:
        """`skills` are those of the actions, in their order."""
        widths: dict[str, int] = {}
        for number in (number for numbers in observed.values() for number in numbers):
            width = array_room if number.is_array else 1
            widths[number.name] = max(width, widths.get(number.name, 0))
        self.names: tuple[str, ...] = ()
        first: dict[str, int] = {}
        for name, width in sorted(widths.items()):
            first[name] = len(self.names)
            self.names += (name,) if width == 1 else tuple(f"{name}[{index}]" for index in range(width))
        most = max((len(numbers) for numbers in observed.values()), default=0)
        self._first = np.zeros((len(skills), most), np.int64)
        self._width = np.ones((len(skills), most), np.int64)
        for action, skill in enumerate(skills):
            for place, number in enumerate(observed.get(skill, ())):
                self._first[action, place] = first[number.name]
                self._width[action, place] = widths[number.name]

    def rows(self, actions: NDArray[np.int32], steps: WorldSteps) -> Numbers:
        """Returns the numbers observed in each world after an action in each; elements without a column
        are left out."""
        shape = (len(actions), len(self.names))
        numbers = Numbers(np.zeros(shape), np.zeros(shape, np.int8))
        worlds = np.frombuffer(steps.number_worlds, np.int32)
        keys = np.frombuffer(steps.number_keys, np.uint32).astype(np.int64)
        values = np.frombuffer(steps.number_values, np.float64)
        place, index = keys >> _INDEX_BITS, keys & ((1 << _INDEX_BITS) - 1)
        if not len(keys):
            return numbers
        has_column = index < self._width[actions[worlds], place]
        column = self._first[actions[worlds], place] + index
        at = worlds[has_column], column[has_column]
        numbers.values[at] = values[has_column]
        numbers.is_reported[at] = 1
        return numbers


ENDINGS = ("", "goal", "failure", "over")
"""The endings of an episode, by number."""

TEXT_BYTES = 62
"""A text observation has room for this many bytes; shorter ones end in zeros."""

ValuesToSet = Mapping[str, Any] | Sequence[MissionValue] | None
"""The values of mission parameters: a mapping from a program, or the values of options, which know where
they stand."""

T = TypeVar("T")


def check_at_least_one(name: str, number: int | None) -> None:
    """Raises ValueError if a number is below 1; None is no limit."""
    if number is not None and number < 1:
        raise ValueError(f"{name} needs to be at least 1, and is {number}")


class Steps(NamedTuple):
    """One step of all worlds, an entry for each; `endings` are places in ENDINGS."""

    observations: NDArray[np.int64]
    texts: list[str]
    rewards: NDArray[np.float64]
    endings: NDArray[np.uint8]
    numbers: Numbers


class HiddenWorlds:
    """Owns an engine child and the event loop that talks to it; to be used in the thread that made it.

    `actions` and `responses` are names by number; response 0 means that nothing is told, as at a start.
    `number_names` are those of the numbers that are reported beside responses, of an array `array_room`.
    """

    def __init__(self, bundle: Path, array_room: int, mission_values: ValuesToSet = None) -> None:
        self._loop = asyncio.new_event_loop()
        try:
            self._engine = self._run(_start(bundle, mission_values))
            reset = self._run(self._engine.reset_worlds([0]))
        except BaseException:
            self._loop.close()
            raise
        actions = self._engine.description.actions
        self.actions = tuple(action.name for action in actions)
        self._columns = NumberColumns([action.skill for action in actions], self._engine.observed, array_room)
        self.number_names = self._columns.names
        self.responses = reset.observations
        self.has_texts = reset.has_texts
        self.discount = self._engine.description.discount

    def start(self, seeds: Sequence[int]) -> None:
        """One new world for each seed."""
        self._run(self._engine.reset_worlds(seeds))

    def nothing_observed(self, worlds: int) -> tuple[NDArray[np.int64], list[str], Numbers]:
        """Responses, texts and numbers as so many worlds have them at a start."""
        shape = (worlds, len(self.number_names))
        numbers = Numbers(np.zeros(shape), np.zeros(shape, np.int8))
        return np.zeros(worlds, np.int64), [""] * worlds, numbers

    def step(self, actions: NDArray[Any]) -> Steps:
        """One action in each world; -1 starts it anew."""
        numbered = actions.astype(np.int32)
        done = self._run(self._engine.step_worlds(numbered.tobytes()))
        return Steps(
            np.frombuffer(done.observations, np.int32).astype(np.int64),
            done.texts,
            np.frombuffer(done.rewards, np.float64).copy(),
            np.frombuffer(done.endings, np.uint8),
            self._columns.rows(numbered, done),
        )

    def numbers_of(
        self, actions: Any, worlds: int, is_ignored: NDArray[np.bool_] | None = None
    ) -> NDArray[np.int64]:
        """The action of each world, as `step` takes them: -1 where what was given is ignored.

        Gymnasium's InvalidAction for what is no array of so many numbers of actions.
        """
        numbers = np.asarray(actions)
        if numbers.shape != (worlds,) or numbers.dtype.kind not in "iu":
            raise InvalidAction(
                f"{worlds} whole numbers are needed, one for each world, and not {actions!r:.200}"
            )
        ignored = np.zeros(worlds, np.bool_) if is_ignored is None else is_ignored
        wrong = ((numbers < 0) | (numbers >= len(self.actions))) & ~ignored
        if wrong.any():
            raise InvalidAction(
                f"there is no action {numbers[wrong][0]}: they are numbered from 0 to {len(self.actions) - 1}"
            )
        return np.where(ignored, -1, numbers).astype(np.int64)

    def close(self) -> None:
        """Ends the child. Closing twice does nothing."""
        if not self._loop.is_closed():
            self._run(self._engine.close())
            self._loop.close()

    def _run(self, work: Coroutine[Any, Any, T]) -> T:
        if self._loop.is_closed():
            work.close()
            raise ClosedEnvironmentError("the environment is closed")
        return self._loop.run_until_complete(work)


async def _start(bundle: Path, mission_values: ValuesToSet) -> Engine:
    planned, project, _ = project_at(bundle, hint=f"See aos lint {bundle}")
    if isinstance(mission_values, Mapping):
        mission_values = values_of_mapping(mission_values, Span("mission_values"))
    values = (*planned.values, *(mission_values or ()))
    project = with_values(project, values, planned.sources)
    return await Engine.start(await build_project(project, cache_dir()), seed=1)


def as_bytes(texts: Sequence[str]) -> NDArray[np.uint8]:
    """Texts as rows of `TEXT_BYTES` bytes, in UTF-8, cut where they are longer."""
    cut = np.array([text.encode()[:TEXT_BYTES] for text in texts], dtype=f"S{TEXT_BYTES}")
    return cut.view(np.uint8).reshape(len(texts), TEXT_BYTES)


Observation = np.int64 | NDArray[np.uint8] | dict[str, Any]


def observation_space(worlds: HiddenWorlds) -> gymnasium.spaces.Space[Any]:
    """`Discrete` over the responses, or `Box` of bytes where a skill's response is a text.

    With numbers it is a `Dict` of this `response`, of the `numbers`, and of which of them were `reported`.
    """
    response: gymnasium.spaces.Space[Any] = gymnasium.spaces.Discrete(len(worlds.responses))
    if worlds.has_texts:
        response = gymnasium.spaces.Box(0, 255, (TEXT_BYTES,), np.uint8)
    if not worlds.number_names:
        return response
    count = len(worlds.number_names)
    numbers = gymnasium.spaces.Box(-np.inf, np.inf, (count,), np.float64)
    reported = gymnasium.spaces.MultiBinary(count)
    return gymnasium.spaces.Dict({"response": response, "numbers": numbers, "reported": reported})


def observations(
    worlds: HiddenWorlds, responses: NDArray[np.int64], texts: list[str], numbers: Numbers
) -> Any:
    """The observations of all worlds: an array with a row for each, or a dict of such."""
    given = as_bytes(texts) if worlds.has_texts else responses
    if not worlds.number_names:
        return given
    return {"response": given, "numbers": numbers.values, "reported": numbers.is_reported}
