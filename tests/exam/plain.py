import random
from itertools import product

from .chances import odds_of, some_discount, some_scale
from .problem import FAILURE, GOAL, NOTHING_SEEN, RUNNING, Outcome, State, World

Random = random.Random


def dense(random: Random, large: bool) -> World:
    """Tables without any structure."""
    states = random.randint(20, 60) if large else random.randint(2, 6)
    actions, observations = random.randint(2, 4), random.randint(1, 3)
    moves = {
        key: odds_of(random, states, few=random.randint(1, 3))
        for key in product(range(states), range(actions))
    }
    senses = {
        key: tuple(enumerate(odds_of(random, observations))) for key in product(range(actions), range(states))
    }
    scale = some_scale(random)
    rewards = {key: round(random.gauss(0, 1), 2) * scale for key in product(range(states), range(actions))}
    endings = [random.choice((RUNNING,) * 9 + (GOAL, FAILURE)) for _ in range(states)]

    def step(state: State, action: int) -> list[Outcome]:
        key = (state[0], action)
        return [
            Outcome(odds, (after,), rewards[key], senses[action, after], endings[after])
            for after, odds in enumerate(moves[key])
        ]

    horizon = random.randint(5, 12)
    starts = [(odds, (state,)) for state, odds in enumerate(odds_of(random, states, few=min(states, 4)))]
    return World(
        "dense",
        some_discount(random, horizon),
        horizon,
        ("place",),
        [f"a{i}" for i in range(actions)],
        starts,
        step,
    )


def ties(random: Random, large: bool) -> World:
    states, kinds = (random.randint(8, 20) if large else random.randint(2, 5)), random.randint(2, 3)
    twins = random.randint(2, 4)
    moves = {key: random.randrange(states) for key in product(range(states), range(kinds))}
    rewards = {key: random.choice((-1, 0, 0, 0, 1)) for key in moves}
    sights = [random.randrange(2) for _ in range(states)]

    def step(state: State, action: int) -> list[Outcome]:
        key = (state[0], action % kinds)
        return [Outcome(1.0, (moves[key],), rewards[key], sights[moves[key]])]

    horizon = random.randint(5, 15)
    names = [f"a{i}" for i in range(kinds * twins)]
    starts = [(1.0, (state,)) for state in range(min(states, 4))]
    return World("ties", some_discount(random, horizon), horizon, ("place",), names, starts, step)


def endings(random: Random, large: bool) -> World:
    """Every step may end the mission, with rewards of all signs; ended or not is not always seen."""
    states = random.randint(10, 25) if large else random.randint(2, 5)
    actions = random.randint(2, 4)
    moves = {key: odds_of(random, states, few=2) for key in product(range(states), range(actions))}
    hazard = {key: random.choice((0, 0, 0.1, 0.5, 1)) for key in moves}
    prizes = {key: random.choice((-10, -1, 0, 1, 5)) for key in moves}
    rewards = {key: random.choice((-1, -0.1, 0, 0, 0.1)) for key in moves}
    kinds = {key: random.choice((GOAL, FAILURE)) for key in moves}
    is_seen = random.random() < 0.5

    def step(state: State, action: int) -> list[Outcome]:
        key = (state[0], action)
        observation = NOTHING_SEEN if is_seen else 0
        over = Outcome(hazard[key], state, prizes[key] + rewards[key], observation, kinds[key])
        return [
            over,
            *(
                Outcome((1 - hazard[key]) * odds, (after,), rewards[key], after % 2)
                for after, odds in enumerate(moves[key])
            ),
        ]

    horizon = random.randint(5, 20)
    starts = [(1.0, (state,)) for state in range(min(states, 3))]
    names = [f"a{i}" for i in range(actions)]
    return World("endings", some_discount(random, horizon), horizon, ("place",), names, starts, step)


def counter(random: Random, large: bool) -> World:
    """A clock that is read late: nothing happens before its time, or all does only in its window."""
    period = random.randint(15, 40) if large else random.randint(3, 9)
    opens = random.randint(period // 2, period - 1)
    once = random.random() < 0.5  # it stops at its end
    prize, fine = random.choice((1, 20)), random.choice((0, -1, -20))
    is_seen = random.random() < 0.5
    quiet = random.choice((0, 0.05, -0.05))

    def step(state: State, action: int) -> list[Outcome]:
        now = state[0]
        after = min(now + 1, period) if once else (now + 1) % period
        observation = after if is_seen else NOTHING_SEEN
        if action == 1:
            is_open = now >= opens
            return [
                Outcome(1.0, (after,), prize if is_open else fine, observation, GOAL if is_open else FAILURE)
            ]
        if action == 2:  # winds it back
            return [Outcome(1.0, (0,), quiet, observation)]
        return [Outcome(1.0, (after,), quiet, observation)]

    starts = [(1.0, (0,))] if random.random() < 0.6 else [(1.0, (now,)) for now in range(period)]
    horizon = period + random.randint(2, 10)
    return World(
        "counter", some_discount(random, horizon), horizon, ("clock",), ["wait", "try", "wind"], starts, step
    )
