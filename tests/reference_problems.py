"""Tiger, Tag and RockSample(7, 8) once more, in a few lines of Python each: what the documents must say.

A model has the names of the engine's actions and gives a step as (probability, next state, reward, response);
a next state of None is the end.
"""

from collections.abc import Hashable, Iterator
from itertools import product
from math import hypot
from typing import Any, Protocol, TypeVar

S = TypeVar("S", bound=Hashable)

Belief = dict[S, float]
Outcome = tuple[float, S | None, float, str]

Cell = tuple[int, int]
Chase = tuple[Cell, Cell]
"""The places of the robot and of its opponent."""
Survey = tuple[Cell, tuple[bool, ...]]
"""The place of the robot, and which rocks are good."""

MOVES = {"north": (0, 1), "east": (1, 0), "south": (0, -1), "west": (-1, 0)}


class Model(Protocol[S]):
    actions: tuple[str, ...]

    def starts(self) -> list[S]:
        """The states of the initial belief, all equally likely."""
        ...

    def step(self, state: S, action: str) -> Iterator[Outcome[S]]: ...


class Tiger(Model[str]):
    actions = ("listen", "open(door=left_door)", "open(door=right_door)")

    def starts(self) -> list[str]:
        return ["left", "right"]

    def step(self, state: str, action: str) -> Iterator[Outcome[str]]:
        if action == "listen":
            other = "left" if state == "right" else "right"
            yield 0.85, state, -1, f"tiger_{state}"
            yield 0.15, state, -1, f"tiger_{other}"
        else:
            for after in ("left", "right"):
                yield 0.5, after, -100 if f"door={state}_door" in action else 10, "opened"


class Tag(Model[Chase]):
    actions = (*(f"move(direction={name})" for name in sorted(MOVES)), "tag")
    cells = (*((x, y) for y in (0, 1) for x in range(10)), *((x, y) for y in (2, 3, 4) for x in (5, 6, 7)))

    def starts(self) -> list[Chase]:
        return list(product(self.cells, self.cells))

    def step(self, state: Chase, action: str) -> Iterator[Outcome[Chase]]:
        robot, opponent = state
        if action == "tag":
            if robot == opponent:
                yield 1, None, 10, "tagged"
            else:
                yield 1, state, -10, f"cell_{self.cells.index(robot)}"
            return
        there = self._moved(robot, MOVES[action.removeprefix("move(direction=").removesuffix(")")])
        for probability, way in self._flight(robot, opponent):
            fled = self._moved(opponent, way)
            response = "same_cell" if fled == there else f"cell_{self.cells.index(there)}"
            yield probability, (there, fled), -1, response

    def _moved(self, cell: Cell, way: Cell) -> Cell:
        there = (cell[0] + way[0], cell[1] + way[1])
        return there if there in self.cells else cell

    @staticmethod
    def _flight(robot: Cell, opponent: Cell) -> Iterator[tuple[float, Cell]]:
        yield 0.2, (0, 0)
        for axis in (0, 1):
            away = opponent[axis] - robot[axis]
            for side in (-1, 1):
                share = 0.2 if away == 0 else 0.4 if away * side > 0 else 0
                if share:
                    yield share, (side, 0) if axis == 0 else (0, side)


class RockSample(Model[Survey]):
    size = 7
    rocks = ((2, 0), (0, 1), (3, 1), (6, 3), (2, 4), (3, 4), (5, 5), (1, 6))
    actions = (
        *(f"check(rock={rock})" for rock in range(len(rocks))),
        *(f"move(direction={name})" for name in sorted(MOVES)),
        "sample",
    )

    def starts(self) -> list[Survey]:
        return [((0, 3), good) for good in product((False, True), repeat=len(self.rocks))]

    def step(self, state: Survey, action: str) -> Iterator[Outcome[Survey]]:
        (x, y), good = state
        if action == "sample":
            if (x, y) not in self.rocks:
                yield 1, state, -100, "sampled"
                return
            rock = self.rocks.index((x, y))
            rocks = (*good[:rock], False, *good[rock + 1 :])
            yield 1, ((x, y), rocks), 10 if good[rock] else -10, "sampled"
        elif action.startswith("check"):
            rock = int(action.removeprefix("check(rock=").removesuffix(")"))
            distance = hypot(x - self.rocks[rock][0], y - self.rocks[rock][1])
            is_true = (1 + 2 ** (-distance / 20)) / 2
            yield is_true, state, 0, "good" if good[rock] else "bad"
            yield 1 - is_true, state, 0, "bad" if good[rock] else "good"
        else:
            dx, dy = MOVES[action.removeprefix("move(direction=").removesuffix(")")]
            if x + dx == self.size:
                yield 1, None, 10, "moved"
            elif x + dx >= 0 and 0 <= y + dy < self.size:
                yield 1, ((x + dx, y + dy), good), 0, "moved"
            else:
                yield 1, state, -100, "moved"


MODELS: dict[str, Model[Any]] = {"tiger": Tiger(), "tag": Tag(), "rocksample-7-8": RockSample()}


def initial_belief(model: Model[S]) -> Belief[S]:
    starts = model.starts()
    return dict.fromkeys(starts, 1 / len(starts))


def expected_reward(model: Model[S], belief: Belief[S], action: str) -> float:
    return sum(
        weight * probability * reward
        for state, weight in belief.items()
        for probability, _, reward, _ in model.step(state, action)
    )


def observed(model: Model[S], belief: Belief[S], action: str, response: str) -> tuple[float, Belief[S]]:
    """Returns how likely the response is, and the belief after it; empty if the problem has ended with it."""
    after: Belief[S] = {}
    total = 0.0
    for state, weight in belief.items():
        for probability, following, _, said in model.step(state, action):
            if said != response or probability == 0:
                continue
            total += weight * probability
            if following is not None:
                after[following] = after.get(following, 0) + weight * probability
    return total, {state: weight / total for state, weight in after.items()}
