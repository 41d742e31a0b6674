"""The changes to a world that hardly change what it is worth: variables that matter to nobody, other units,
actions in another order, observations that tell nothing.
"""

import dataclasses
import random
from collections.abc import Callable, Sequence

from .problem import Outcome, State, World

Odds = Sequence[tuple[float, int]]
"""Values with their probabilities."""

Change = Callable[[int, int], Odds]
"""The odds of the values that a value becomes by an action."""


def disguised(random: random.Random, world: World) -> World:
    if random.random() < 0.4:
        world = _with_shuffled_actions(random, world)
    if random.random() < 0.3:
        world = _in_other_units(random, world)
    if random.random() < 0.3:
        world = random.choice((_with_clock, _with_dice, _with_diary, _with_label))(random, world)
    if random.random() < 0.15:
        world = _with_chatter(random, world)
    return world


def _with_shuffled_actions(random: random.Random, world: World) -> World:
    order = list(range(len(world.actions)))
    random.shuffle(order)
    return dataclasses.replace(
        world,
        actions=[world.actions[action] for action in order],
        step=lambda state, action: world.step(state, order[action]),
    )


def _in_other_units(random: random.Random, world: World) -> World:
    factor = random.choice((0.001, 0.1, 7, 1000))

    def step(state: State, action: int) -> list[Outcome]:
        return [dataclasses.replace(out, reward=out.reward * factor) for out in world.step(state, action)]

    return dataclasses.replace(world, step=step)


def _with_clock(random: random.Random, world: World) -> World:
    """Phases that go round and matter to nobody."""
    phases = random.randint(2, 5)
    return _beside(random, world, "phase", [(1.0, 0)], lambda value, action: [(1.0, (value + 1) % phases)])


def _with_dice(random: random.Random, world: World) -> World:
    sides = random.randint(2, 3)
    thrown = [(1 / sides, value) for value in range(sides)]
    return _beside(random, world, "dice", thrown, lambda value, action: thrown)


def _with_diary(random: random.Random, world: World) -> World:
    """Adds a variable for what the robot did last, or for whether it ever did something."""
    if random.random() < 0.5:
        return _beside(random, world, "last", [(1.0, -1)], lambda value, action: [(1.0, action)])
    return _beside(
        random, world, "ever", [(1.0, 0)], lambda value, action: [(1.0, max(value, int(action == 0)))]
    )


def _with_label(random: random.Random, world: World) -> World:
    """A hidden number that never changes and that nobody reads."""
    values = random.randint(2, 4)
    odds = [(1 / values, value) for value in range(values)]
    return _beside(random, world, "label", odds, lambda value, action: [(1.0, value)])


def _with_chatter(random: random.Random, world: World) -> World:
    """Every observation comes in shades, by chance, that tell nothing; trees of observations grow by it."""
    shades = random.randint(2, 4)

    def step(state: State, action: int) -> list[Outcome]:
        found = []
        for out in world.step(state, action):
            sensing = out.observation if isinstance(out.observation, tuple) else ((out.observation, 1.0),)
            shaded = tuple(
                ((observation + 1) * shades + shade, odds / shades)
                for observation, odds in sensing
                for shade in range(shades)
            )
            found.append(dataclasses.replace(out, observation=shaded))
        return found

    return dataclasses.replace(world, step=step)


def _beside(random: random.Random, world: World, name: str, starts: Odds, change: Change) -> World:
    """A world and a variable that changes by itself; the engine may be told that it does not matter."""

    def step(state: State, action: int) -> list[Outcome]:
        return [
            dataclasses.replace(
                out, probability=out.probability * odds, next=(*out.next, value), reward=out.reward
            )
            for out in world.step(state[:-1], action)
            for odds, value in change(state[-1], action)
        ]

    return dataclasses.replace(
        world,
        variables=(*world.variables, name),
        starts=[(odds * more, (*state, value)) for odds, state in world.starts for more, value in starts],
        step=step,
        irrelevant=[len(world.variables)] if random.random() < 0.5 else (),
    )
