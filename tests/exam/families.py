"""Families of random worlds, each with what a tuned planner may get wrong.

A family draws its own sizes, noise, rewards and discount; `large` asks for what is hard to find: long ways, many
states.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from itertools import product

from .problem import FAILURE, GOAL, NOTHING_SEEN, RUNNING, Outcome, Seen, State, World, odds_of

__all__ = ["FAMILIES", "NEEDLES", "Family"]

Random = random.Random
Family = Callable[[Random, bool], World]


def _discount(random: Random, horizon: int) -> float:
    """Mostly such that what lies at the horizon still counts for something."""
    return random.choice((0.9, 0.95, 0.98, 0.99, 0.999, 1.0, round(0.2 ** (1 / horizon), 4)))


def _scale(random: Random) -> float:
    return random.choice((0.01, 0.1, 1, 1, 1, 10, 100))


def _noisy(right: int, count: int, accuracy: float) -> Seen:
    """`right` with this probability, else any other observation."""
    if count == 1 or accuracy >= 1:
        return right
    return tuple((seen, accuracy if seen == right else (1 - accuracy) / (count - 1)) for seen in range(count))


def _moved(place: int, by: int, count: int) -> int:
    return min(max(place + by, 0), count - 1)


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
    scale = _scale(random)
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
        _discount(random, horizon),
        horizon,
        ("place",),
        [f"a{i}" for i in range(actions)],
        starts,
        step,
    )


def corridor(random: Random, large: bool) -> World:
    """Cells in a row and the reward at the far end; nothing else tells the way."""
    cells = random.randint(12, 60) if large else random.randint(3, 12)
    cost = random.choice((0, 0, -0.1, -0.01))
    slip = random.choice((0, 0, 0.1, 0.2))
    accuracy = random.choice((0.0, 0.8, 1.0))
    ends = random.choice((True, False))
    prize = random.choice((1, 10, 100))
    is_far_right = random.random() < 0.5
    backwards = random.choice(("stay", "left", "fall"))  # what the wrong action does
    noops = random.choice((0, 0, 1, 3))
    goal = cells - 1

    def step(state: State, action: int) -> list[Outcome]:
        way = 1 if (action == 0) == is_far_right else -1
        if action >= 2:
            way = 0
        if way == -1:
            after = {"stay": state[0], "left": _moved(state[0], -1, cells), "fall": 0}[backwards]
        else:
            after = _moved(state[0], way, cells)
        found = []
        for odds, place in ((1 - slip, after), (slip, state[0])):
            is_there = place == goal and way == 1
            seen = _noisy(place, cells, accuracy) if accuracy in (0, 1) else _edge(place, cells, accuracy)
            back = 0 if is_there and not ends else place
            found.append(
                Outcome(
                    odds,
                    (back,),
                    cost + (prize if is_there else 0),
                    NOTHING_SEEN if accuracy == 0 else seen,
                    GOAL if is_there and ends else RUNNING,
                )
            )
        return found

    horizon = max(cells + random.randint(0, cells), 5) if slip == 0 else 2 * cells
    starts = [(1.0, (0,))]
    if random.random() < 0.4:
        starts = [(1.0, (place,)) for place in range(max(cells // 2, 1))]
    actions = ["one", "other", *(f"wait{i}" for i in range(noops))]
    return World("corridor", _discount(random, horizon), min(horizon, 120), ("cell",), actions, starts, step)


def _edge(place: int, cells: int, accuracy: float) -> Seen:
    """Whether there is a wall."""
    is_edge = 1 if place in (0, cells - 1) else 0
    return ((is_edge, accuracy), (1 - is_edge, 1 - accuracy))


def grid(random: Random, large: bool) -> World:
    """Traps on the way to a goal; the robot may not know where it is."""
    width = random.randint(5, 9) if large else random.randint(2, 4)
    height = random.randint(4, 8) if large else random.randint(2, 4)
    cells = [(x, y) for x in range(width) for y in range(height)]
    goal = cells[-1]
    traps = set(random.sample(cells[1:-1], min(len(cells) - 2, random.randint(1, max(1, len(cells) // 6)))))
    slip = random.choice((0, 0.1, 0.3))
    cost = random.choice((0, -0.01, -0.1, -1))
    prize, fine = random.choice((1, 10, 50)), random.choice((-0.5, -10, -100))
    trap_ends = random.choice((True, False))
    sees = random.choice(("place", "row", "nothing", "bump"))
    moves = ((1, 0), (0, 1), (-1, 0), (0, -1))

    def seen_at(x: int, y: int, bumped: bool) -> Seen:
        if sees == "place":
            return x * height + y
        return NOTHING_SEEN if sees == "nothing" else y if sees == "row" else int(bumped)

    def step(state: State, action: int) -> list[Outcome]:
        found = []
        for odds, move in ((1 - slip, action), (slip / 2, (action + 1) % 4), (slip / 2, (action + 3) % 4)):
            x = _moved(state[0], moves[move][0], width)
            y = _moved(state[1], moves[move][1], height)
            seen = seen_at(x, y, (x, y) == state)
            if (x, y) == goal:
                found.append(Outcome(odds, (x, y), cost + prize, seen, GOAL))
            elif (x, y) in traps:
                found.append(Outcome(odds, (x, y), cost + fine, seen, FAILURE if trap_ends else RUNNING))
            else:
                found.append(Outcome(odds, (x, y), cost, seen))
        return found

    starts = [(1.0, (0, 0))]
    if random.random() < 0.4:
        starts = [
            (1.0, cell) for cell in random.sample(cells[:-1], min(3, len(cells) - 1)) if cell not in traps
        ] or starts
    horizon = min(2 * (width + height) + random.randint(0, 10), 60)
    return World("grid", _discount(random, horizon), horizon, ("x", "y"), ["e", "n", "w", "s"], starts, step)


def keys(random: Random, large: bool) -> World:
    """The key at one end, the door at the other; the key may be at one of several places."""
    cells = random.randint(8, 25) if large else random.randint(3, 7)
    hidden = random.choice((False, True)) and not large
    home = random.randint(1, cells - 2)
    prize = random.choice((1, 10, 100))
    cost = random.choice((0, 0, -0.01, -0.05)) * prize
    needs_grip = random.random() < 0.5  # the key has to be taken, not only walked over
    sees_key = random.random() < 0.7
    fine = random.choice((0, 0, -0.1)) * prize

    def step(state: State, action: int) -> list[Outcome]:
        place, has_key, key = state
        reward = cost
        ending = RUNNING
        if action < 2:
            place = _moved(place, 1 if action == 0 else -1, cells)
            if place == key and not needs_grip:
                has_key = 1
        elif action == 2:
            if place == key and needs_grip:
                has_key = 1
            elif place != key:
                reward += fine
        elif place == cells - 1 and has_key:
            reward, ending = reward + prize, GOAL
        else:
            reward += fine
        seen = has_key if sees_key else NOTHING_SEEN
        return [Outcome(1.0, (place, has_key, key), reward, seen, ending)]

    places = [0, 1] if hidden else [0]
    starts = [(1.0, (home, 0, key)) for key in places]
    horizon = min(3 * cells + 6, 100)
    names = ["right", "left", "take", "open"]
    return World("keys", _discount(random, horizon), horizon, ("cell", "has_key", "key"), names, starts, step)


def pushing(random: Random, large: bool) -> World:
    """Two robots have to push a box together; all else is worth nothing, or costs."""
    cells = random.randint(4, 5) if large else 3
    prize = random.choice((5, 100, 5000))
    cost = random.choice((0, -1, -20)) if prize > 100 else random.choice((0, -0.01, -0.1))
    alone = random.choice((0, -0.5)) * (1 if prize < 100 else 10)
    slip = random.choice((0, 0, 0.1))

    def step(state: State, action: int) -> list[Outcome]:
        one, other, box = state
        reward = cost
        ending = RUNNING
        if action == 4:
            if one == other == box - 1:
                one, other, box = one + 1, other + 1, box + 1
                if box == cells:
                    reward, ending, box = reward + prize, GOAL, cells
            else:
                reward += alone
        elif action < 2:
            one = min(_moved(one, 1 if action == 0 else -1, cells), box - 1)
        else:
            other = min(_moved(other, 1 if action == 2 else -1, cells), box - 1)
        done = Outcome(1 - slip, (one, other, box), reward, int(one == other), ending)
        return [done, Outcome(slip, state, cost, int(state[0] == state[1]))]

    starts = [(1.0, (0, random.randint(0, 1), random.randint(2, cells - 1)))]
    horizon = random.randint(10, 20) + 3 * cells
    names = ["one_up", "one_down", "other_up", "other_down", "push"]
    return World("pushing", _discount(random, horizon), horizon, ("one", "other", "box"), names, starts, step)


def doors(random: Random, large: bool) -> World:
    """Noisy sensors: one of some doors is the right one."""
    count = random.randint(4, 8) if large else random.randint(2, 4)
    accuracy = random.choice((0.6, 0.7, 0.85, 0.95))
    prize, fine, cost = random.choice((1, 10)), random.choice((-1, -10, -100)), random.choice((0, -0.1, -1))
    again = random.choice((True, False))
    moves = random.choice((0, 0, 0.1))

    def step(state: State, action: int) -> list[Outcome]:
        place = state[0]
        if action == 0:
            return [
                Outcome(
                    1 - moves if after == place else moves / (count - 1),
                    (after,),
                    cost,
                    _noisy(after, count, accuracy),
                )
                for after in range(count)
            ]
        is_right = action - 1 == place
        reward, ending = (prize, GOAL) if is_right else (fine, FAILURE)
        if not again:
            return [Outcome(1.0, state, reward, NOTHING_SEEN, ending)]
        return [Outcome(1 / count, (after,), reward, NOTHING_SEEN) for after in range(count)]

    horizon = random.randint(5, 20)
    names = ["listen", *(f"open{i}" for i in range(count))]
    starts = [(odds, (place,)) for place, odds in enumerate(odds_of(random, count))]
    return World("doors", _discount(random, horizon), horizon, ("door",), names, starts, step)


def late(random: Random, large: bool) -> World:
    """A colour, seen or chosen at the beginning, that matters only at the far end of the way."""
    cells = random.randint(8, 30) if large else random.randint(2, 7)
    colours = random.randint(2, 3)
    is_painted = random.random() < 0.5  # the robot may change it, at the beginning only
    is_seen = random.random() < 0.6
    accuracy = random.choice((1.0, 0.8))
    prize, fine = random.choice((1, 10, 100)), random.choice((0, -5, -50))
    cost = random.choice((0, -0.02))

    def step(state: State, action: int) -> list[Outcome]:
        place, colour = state
        if action == 0:
            place = _moved(place, 1, cells)
        elif action == 1 and place == 0 and is_painted:
            colour = (colour + 1) % colours
        elif action >= 2 and place == cells - 1:
            is_right = action - 2 == colour
            return [
                Outcome(1.0, state, prize if is_right else fine, NOTHING_SEEN, GOAL if is_right else FAILURE)
            ]
        seen: Seen = _noisy(colour, colours, accuracy) if is_seen and place == 0 else NOTHING_SEEN
        return [Outcome(1.0, (place, colour), cost, seen)]

    starts = [(odds, (0, colour)) for colour, odds in enumerate(odds_of(random, colours)) if odds > 0]
    horizon = cells + random.randint(4, 10)
    names = ["on", "paint", *(f"say{i}" for i in range(colours))]
    return World("late", _discount(random, horizon), horizon, ("cell", "colour"), names, starts, step)


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
        seen = after if is_seen else NOTHING_SEEN
        if action == 1:
            is_open = now >= opens
            return [Outcome(1.0, (after,), prize if is_open else fine, seen, GOAL if is_open else FAILURE)]
        if action == 2:  # winds it back
            return [Outcome(1.0, (0,), quiet, seen)]
        return [Outcome(1.0, (after,), quiet, seen)]

    starts = [(1.0, (0,))] if random.random() < 0.6 else [(1.0, (now,)) for now in range(period)]
    horizon = period + random.randint(2, 10)
    return World(
        "counter", _discount(random, horizon), horizon, ("clock",), ["wait", "try", "wind"], starts, step
    )


def ties(random: Random, large: bool) -> World:
    """Actions that do the same, whole rewards, equal values everywhere."""
    states, kinds = (random.randint(8, 20) if large else random.randint(2, 5)), random.randint(2, 3)
    twins = random.randint(2, 4)
    moves = {key: random.randrange(states) for key in product(range(states), range(kinds))}
    rewards = {key: random.choice((-1, 0, 0, 0, 1)) for key in moves}
    seen = [random.randrange(2) for _ in range(states)]

    def step(state: State, action: int) -> list[Outcome]:
        key = (state[0], action % kinds)
        return [Outcome(1.0, (moves[key],), rewards[key], seen[moves[key]])]

    horizon = random.randint(5, 15)
    names = [f"a{i}" for i in range(kinds * twins)]
    starts = [(1.0, (state,)) for state in range(min(states, 4))]
    return World("ties", _discount(random, horizon), horizon, ("place",), names, starts, step)


def exits(random: Random, large: bool) -> World:
    """A free exit that can be put off, at hardly any discount; looking longer may tell which exit is better."""
    count = random.randint(2, 3)
    accuracy = random.choice((0.6, 0.8, 1.0))
    values = [random.choice((5, 10, 20)), *(random.choice((-20, 0, 5, 9)) for _ in range(count - 1))]
    cost = random.choice((0, 0, 0, -0.001, -0.1))
    danger = random.choice((0, 0, 0.02))
    rooms = random.randint(3, 10) if large else 1

    def step(state: State, action: int) -> list[Outcome]:
        room, good = state
        if action == 0:
            seen = _noisy(good, count, accuracy)
            lost = Outcome(danger, state, cost, NOTHING_SEEN, FAILURE)
            return [Outcome(1 - danger, (_moved(room, 1, rooms), good), cost, seen), lost]
        value = values[(action - 1 - good) % count]
        return [Outcome(1.0, state, value, NOTHING_SEEN, GOAL if value > 0 else FAILURE)]

    horizon = random.randint(5, 20)
    discount = random.choice((1.0, 0.999999, 0.9999, 0.99))
    names = ["wait", *(f"exit{i}" for i in range(count))]
    starts = [(odds, (0, good)) for good, odds in enumerate(odds_of(random, count)) if odds > 0]
    return World("exits", discount, horizon, ("room", "good"), names, starts, step)


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
        seen = NOTHING_SEEN if is_seen else 0
        over = Outcome(hazard[key], state, prizes[key] + rewards[key], seen, kinds[key])
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
    return World("endings", _discount(random, horizon), horizon, ("place",), names, starts, step)


def battery(random: Random, large: bool) -> World:
    """Extrinsic changes: what is earned far away costs charge, which also leaks; an empty battery is the end."""
    cells = random.randint(5, 8) if large else random.randint(2, 4)
    full = random.randint(2 * cells, 3 * cells) if large else random.randint(cells, cells + 3)
    leak = random.choice((0, 0.1, 0.3))
    earned = random.choice((1, 5))
    fine = random.choice((0, -10, -50))
    sees = random.choice(("charge", "low", "nothing"))

    def step(state: State, action: int) -> list[Outcome]:
        place, charge = state
        reward = 0.0
        if action < 2:
            place = _moved(place, 1 if action == 0 else -1, cells)
            charge -= 1
        elif action == 2:
            reward = earned if place == cells - 1 else -0.1
            charge -= 1
        else:
            charge = full if place == 0 else charge
        found = []
        for odds, lost in ((1 - leak, 0), (leak, 1)):
            left = max(charge - lost, 0)
            seen = left if sees == "charge" else int(left <= full // 3) if sees == "low" else NOTHING_SEEN
            if left == 0:
                found.append(Outcome(odds, (place, 0), reward + fine, seen, FAILURE))
            else:
                found.append(Outcome(odds, (place, left), reward, seen))
        return found

    horizon = random.randint(10, 30)
    names = ["out", "home", "work", "charge"]
    starts = [(1.0, (0, full))]
    return World("battery", _discount(random, horizon), horizon, ("place", "charge"), names, starts, step)


def heaven(random: Random, large: bool) -> World:
    """Heaven or hell: the sign that tells where the reward is lies off the way, and looking at it costs."""
    arm = random.randint(3, 8) if large else random.randint(1, 3)  # the fork is so far off
    way = random.randint(3, 10) if large else random.randint(1, 4)  # and the sign in the other direction
    prize, fine = random.choice((1, 10, 100)), random.choice((-1, -10, -100))
    cost = random.choice((0, -0.01, -0.1))
    accuracy = random.choice((1.0, 1.0, 0.9))
    # Cells: the sign is 0, the start `way`, the fork `way + arm`.
    fork = way + arm

    def step(state: State, action: int) -> list[Outcome]:
        place, side = state
        if action >= 2 and place == fork:
            is_right = action - 2 == side
            return [
                Outcome(1.0, state, prize if is_right else fine, NOTHING_SEEN, GOAL if is_right else FAILURE)
            ]
        place = _moved(place, (1, -1, 0, 0)[action], fork + 1)
        seen: Seen = _noisy(side, 2, accuracy) if place == 0 else NOTHING_SEEN
        return [Outcome(1.0, (place, side), cost, seen)]

    odds = random.choice((0.5, 0.4, 0.2))
    starts = [(odds, (way, 0)), (1 - odds, (way, 1))]
    horizon = 2 * way + arm + random.randint(3, 10)
    names = ["on", "back", "left", "right"]
    return World("heaven", _discount(random, horizon), horizon, ("cell", "side"), names, starts, step)


def lock(random: Random, large: bool) -> World:
    """Many actions, of which one at a time is of use; the others cost, or bring the robot back."""
    count = random.randint(50, 100) if large else random.randint(8, 40)
    length = random.randint(2, 5) if large else random.randint(1, 3)
    code = [random.randrange(count) for _ in range(length)]
    wrong = random.choice(("nothing", "back", "cost"))
    prize = random.choice((1, 10, 100))
    is_seen = random.random() < 0.7

    def step(state: State, action: int) -> list[Outcome]:
        done = state[0]
        if action == code[done]:
            if done + 1 == length:
                return [Outcome(1.0, state, prize, NOTHING_SEEN, GOAL)]
            return [Outcome(1.0, (done + 1,), 0, done + 1 if is_seen else NOTHING_SEEN)]
        after = 0 if wrong == "back" else done
        cost = -0.1 * prize / length if wrong == "cost" else 0
        return [Outcome(1.0, (after,), cost, after if is_seen else NOTHING_SEEN)]

    horizon = random.randint(5, 15)
    names = [f"a{i}" for i in range(count)]
    return World("lock", _discount(random, horizon), horizon, ("done",), names, [(1.0, (0,))], step)


def boxes(random: Random, large: bool) -> World:
    """Something is in one of many boxes: opening costs, and a look tells only the half of them that it is in."""
    count = random.randint(30, 60) if large else random.randint(4, 16)
    prize, cost = random.choice((10, 100)), random.choice((-1, -3))
    accuracy = random.choice((1.0, 0.9, 0.75))
    bits = max((count - 1).bit_length(), 1)
    odds = odds_of(random, count) if count <= 16 else [1 / count] * count

    def step(state: State, action: int) -> list[Outcome]:
        place = state[0]
        if action < bits:
            return [Outcome(1.0, state, cost / 2, _noisy(place >> action & 1, 2, accuracy))]
        if action - bits == place:
            return [Outcome(1.0, state, prize + cost, 1, GOAL)]
        return [Outcome(1.0, state, cost, 0)]

    horizon = random.randint(5, 15)
    names = [*(f"look{i}" for i in range(bits)), *(f"open{i}" for i in range(count))]
    starts = [(share, (place,)) for place, share in enumerate(odds) if share > 0]
    return World("boxes", _discount(random, horizon), horizon, ("box",), names, starts, step)


def rocks(random: Random, large: bool) -> World:
    """Rocks on a line, good or bad, with a sensor that is the better the nearer."""
    count = random.randint(3, 4) if large else random.randint(1, 2)
    cells = count * random.randint(2, 3)
    places = sorted(random.sample(range(cells), count))
    prize, fine, leave = 10, random.choice((-10, -5)), random.choice((10, 1, 0))
    reach = random.choice((1, 2, 5))

    def step(state: State, action: int) -> list[Outcome]:
        place, *good = state
        if action < 2:
            if action == 0 and place == cells - 1:
                return [Outcome(1.0, state, leave, NOTHING_SEEN, GOAL)]
            return [Outcome(1.0, (_moved(place, 1 if action == 0 else -1, cells), *good), 0)]
        if action == 2:
            if place not in places:
                return [Outcome(1.0, state, -1)]
            rock = places.index(place)
            reward = prize if good[rock] else fine
            good[rock] = 0
            return [Outcome(1.0, (place, *good), reward)]
        rock = action - 3
        accuracy = 0.5 + 0.5 * 2 ** (-abs(places[rock] - place) / reach)
        return [Outcome(1.0, state, 0, _noisy(good[rock], 2, accuracy))]

    horizon = random.randint(8, 20)
    names = ["on", "back", "sample", *(f"check{i}" for i in range(count))]
    starts = [(1.0, (0, *good)) for good in product((0, 1), repeat=count)]
    variables = ("place", *(f"good{i}" for i in range(count)))
    return World("rocks", _discount(random, horizon), horizon, variables, names, starts, step)


def machine(random: Random, large: bool) -> World:
    """Wear that is not seen: inspecting costs, replacing costs more, and running a worn machine most."""
    levels = random.randint(6, 12) if large else random.randint(3, 5)
    wear = random.choice((0.1, 0.3, 0.5))
    accuracy = random.choice((0.7, 0.9, 1.0))
    replace, inspect = random.choice((-5, -20)), random.choice((-0.2, -1))

    def step(state: State, action: int) -> list[Outcome]:
        level = state[0]
        if action == 2:
            return [Outcome(1.0, (0,), replace)]
        if action == 1:
            return [Outcome(1.0, state, inspect, _noisy(level, levels, accuracy))]
        earned = 1 - level * 3 / levels
        seen = ((1, 0.5 + 0.4 * level / levels), (0, 0.5 - 0.4 * level / levels))
        return [
            Outcome(1 - wear, state, earned, seen),
            Outcome(wear, (min(level + 1, levels - 1),), earned, seen),
        ]

    horizon = random.randint(10, 30)
    names = ["run", "inspect", "replace"]
    return World("machine", _discount(random, horizon), horizon, ("wear",), names, [(1.0, (0,))], step)


def invest(random: Random, large: bool) -> World:
    """A long loss before a gain: doing nothing is worth 0, and all steps of the right way but the last cost."""
    length = random.randint(10, 40) if large else random.randint(3, 10)
    cost = random.choice((-0.1, -1))
    prize = -cost * length * random.choice((1.5, 3, 10))
    is_seen = random.random() < 0.5
    lapse = random.choice((0, 0, 0.05))

    def step(state: State, action: int) -> list[Outcome]:
        done = state[0]
        if action == 0:
            return [Outcome(1.0, (0 if done == 0 else done - 1,), 0, done if is_seen else NOTHING_SEEN)]
        if done + 1 == length:
            return [Outcome(1.0, (0,), prize, 0)]
        seen = done + 1 if is_seen else NOTHING_SEEN
        return [
            Outcome(1 - lapse, (done + 1,), cost, seen),
            Outcome(lapse, (0,), cost, 0 if is_seen else NOTHING_SEEN),
        ]

    horizon = min(length + random.randint(2, 20), 60)
    discount = random.choice((1.0, 0.999, 0.99, round(0.7 ** (1 / length), 4)))
    return World("invest", discount, horizon, ("done",), ["rest", "work"], [(1.0, (0,))], step)


def pursuit(random: Random, large: bool) -> World:
    """A robot that has to catch what runs away; it sees it from nearby only, or through noise."""
    cells = random.randint(7, 12) if large else random.randint(3, 6)
    is_ring = random.random() < 0.5
    flees = random.choice((0.3, 0.6, 0.9))
    reach = random.choice((0, 0, 1))
    accuracy = random.choice((0.7, 0.9, 1.0))
    prize, fine, cost = 10, random.choice((-1, -10)), random.choice((-1, -0.1))

    def beside(place: int, by: int) -> int:
        return (place + by) % cells if is_ring else _moved(place, by, cells)

    def step(state: State, action: int) -> list[Outcome]:
        robot, target = state
        if action == 2:
            if robot == target:
                return [Outcome(1.0, state, prize, NOTHING_SEEN, GOAL)]
            return [Outcome(1.0, state, fine, 0)]
        robot = beside(robot, 1 if action == 0 else -1)
        away = 1 if target >= robot else -1
        found = []
        for odds, by in ((flees, away), ((1 - flees) / 2, 0), ((1 - flees) / 2, -away)):
            after = beside(target, by)
            seen = _noisy(int(abs(robot - after) <= reach), 2, accuracy)
            found.append(Outcome(odds, (robot, after), cost, seen))
        return found

    horizon = random.randint(8, 25)
    starts = [(1.0, (0, place)) for place in range(1, cells)]
    names = ["on", "back", "catch"]
    return World("pursuit", _discount(random, horizon), horizon, ("robot", "target"), names, starts, step)


def search(random: Random, large: bool) -> World:
    """A thing somewhere in a grid, and a sensor that is the better the nearer; to take it where it is not costs."""
    width = random.randint(3, 4) if large else 2
    height = random.randint(2, 3) if large else 2
    cells = [(x, y) for x in range(width) for y in range(height)]
    reach = random.choice((0.5, 1, 2))
    prize, fine, cost = 10, random.choice((-1, -5, -50)), random.choice((0, -0.1, -0.5))
    moves = ((1, 0), (0, 1), (-1, 0), (0, -1))

    def step(state: State, action: int) -> list[Outcome]:
        robot, thing = state
        x, y = cells[robot]
        if action == 4:
            if robot == thing:
                return [Outcome(1.0, state, prize, NOTHING_SEEN, GOAL)]
            return [Outcome(1.0, state, fine, 2)]
        by_x, by_y = moves[action]
        robot = cells.index((_moved(x, by_x, width), _moved(y, by_y, height)))
        far = abs(cells[robot][0] - cells[thing][0]) + abs(cells[robot][1] - cells[thing][1])
        beeps = round(0.05 + 0.9 * 2 ** (-far / reach), 3)
        return [Outcome(1.0, (robot, thing), cost, ((1, beeps), (0, 1 - beeps)))]

    horizon = random.randint(6, 20)
    starts = [(odds, (0, thing)) for thing, odds in enumerate(odds_of(random, len(cells))) if odds > 0]
    names = ["e", "n", "w", "s", "take"]
    return World("search", _discount(random, horizon), horizon, ("robot", "thing"), names, starts, step)


def hallway(random: Random, large: bool) -> World:
    """Where am I: cells that look alike, sensors and motors that err, a goal that has to be declared."""
    cells = random.randint(10, 25) if large else random.randint(4, 9)
    looks = [random.randrange(3) for _ in range(cells)]
    accuracy = random.choice((0.6, 0.8, 0.95))
    slip = random.choice((0.05, 0.2))
    goal = random.randrange(cells)
    fine, cost = random.choice((-1, -10, -50)), random.choice((0, -0.1))

    def step(state: State, action: int) -> list[Outcome]:
        place = state[0]
        if action == 2:
            is_there = place == goal
            return [
                Outcome(1.0, state, 10 if is_there else fine, NOTHING_SEEN, GOAL if is_there else FAILURE)
            ]
        way = 1 if action == 0 else -1
        return [
            Outcome(odds, (after,), cost, _noisy(looks[after], 3, accuracy))
            for odds, after in (
                (1 - 2 * slip, (place + way) % cells),
                (slip, place),
                (slip, (place + 2 * way) % cells),
            )
        ]

    horizon = random.randint(10, 30)
    starts = [(1.0, (place,)) for place in range(cells)]
    return World(
        "hallway", _discount(random, horizon), horizon, ("cell",), ["on", "back", "here"], starts, step
    )


def machines(random: Random, large: bool) -> World:
    """Several machines that break unseen: one can be looked at or repaired at a time."""
    count = random.randint(3, 5) if large else 2
    breaks = [random.choice((0.02, 0.1, 0.3)) for _ in range(count)]
    accuracy = random.choice((0.7, 0.9))
    repair, looking = random.choice((-1, -3)), random.choice((0, -0.2))
    earned = [random.choice((0.5, 1)) for _ in range(count)]

    def step(state: State, action: int) -> list[Outcome]:
        reward = sum(value for value, is_broken in zip(earned, state, strict=True) if not is_broken)
        machine = action % count
        fixed = list(state)
        if action < count:
            reward += repair
            fixed[machine] = 0
        elif action < 2 * count:
            reward += looking
        found = []
        for after in product(*((0, 1) if not is_broken else (1,) for is_broken in fixed)):
            odds = 1.0
            for broken, was_broken, hazard in zip(after, fixed, breaks, strict=True):
                odds *= 1.0 if was_broken else hazard if broken else 1 - hazard
            looks = count <= action < 2 * count
            seen: Seen = _noisy(after[machine], 2, accuracy) if looks else NOTHING_SEEN
            found.append(Outcome(odds, after, reward, seen))
        return found

    horizon = random.randint(6, 20)
    names = [*(f"repair{i}" for i in range(count)), *(f"look{i}" for i in range(count)), "wait"]
    discount = random.choice((0.9, 0.95, 0.99))
    variables = tuple(f"broken{i}" for i in range(count))
    return World("machines", discount, horizon, variables, names, [(1.0, (0,) * count)], step)


FAMILIES: dict[str, Family] = {
    family.__name__: family
    for family in (
        dense, corridor, grid, keys, pushing, doors, late, counter, ties, exits, endings, battery, heaven, lock,
        boxes, rocks, machine, invest, pursuit, search, hallway, machines,
    )
}  # fmt: skip

NEEDLES: Sequence[str] = ("corridor", "keys", "pushing", "late", "lock", "heaven")
"""Families of which the large ones are needles in haystacks."""
