import random
from itertools import product

from .chances import moved, noisy, odds_of, some_discount
from .problem import FAILURE, GOAL, NOTHING_SEEN, Outcome, Seen, State, World

Random = random.Random


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
                    noisy(after, count, accuracy),
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
    return World("doors", some_discount(random, horizon), horizon, ("door",), names, starts, step)


def boxes(random: Random, large: bool) -> World:
    """Something is in one of many boxes: opening costs, and a look tells the half of them that it is in."""
    count = random.randint(30, 60) if large else random.randint(4, 16)
    prize, cost = random.choice((10, 100)), random.choice((-1, -3))
    accuracy = random.choice((1.0, 0.9, 0.75))
    bits = max((count - 1).bit_length(), 1)
    odds = odds_of(random, count) if count <= 16 else [1 / count] * count

    def step(state: State, action: int) -> list[Outcome]:
        place = state[0]
        if action < bits:
            return [Outcome(1.0, state, cost / 2, noisy(place >> action & 1, 2, accuracy))]
        if action - bits == place:
            return [Outcome(1.0, state, prize + cost, 1, GOAL)]
        return [Outcome(1.0, state, cost, 0)]

    horizon = random.randint(5, 15)
    names = [*(f"look{i}" for i in range(bits)), *(f"open{i}" for i in range(count))]
    starts = [(share, (place,)) for place, share in enumerate(odds) if share > 0]
    return World("boxes", some_discount(random, horizon), horizon, ("box",), names, starts, step)


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
            return [Outcome(1.0, (moved(place, 1 if action == 0 else -1, cells), *good), 0)]
        if action == 2:
            if place not in places:
                return [Outcome(1.0, state, -1)]
            rock = places.index(place)
            reward = prize if good[rock] else fine
            good[rock] = 0
            return [Outcome(1.0, (place, *good), reward)]
        rock = action - 3
        accuracy = 0.5 + 0.5 * 2 ** (-abs(places[rock] - place) / reach)
        return [Outcome(1.0, state, 0, noisy(good[rock], 2, accuracy))]

    horizon = random.randint(8, 20)
    names = ["on", "back", "sample", *(f"check{i}" for i in range(count))]
    starts = [(1.0, (0, *good)) for good in product((0, 1), repeat=count)]
    variables = ("place", *(f"good{i}" for i in range(count)))
    return World("rocks", some_discount(random, horizon), horizon, variables, names, starts, step)


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
            return [Outcome(1.0, state, inspect, noisy(level, levels, accuracy))]
        earned = 1 - level * 3 / levels
        observation = ((1, 0.5 + 0.4 * level / levels), (0, 0.5 - 0.4 * level / levels))
        return [
            Outcome(1 - wear, state, earned, observation),
            Outcome(wear, (min(level + 1, levels - 1),), earned, observation),
        ]

    horizon = random.randint(10, 30)
    names = ["run", "inspect", "replace"]
    return World("machine", some_discount(random, horizon), horizon, ("wear",), names, [(1.0, (0,))], step)


def exits(random: Random, large: bool) -> World:
    """A free exit that can be put off at hardly any discount; looking longer may tell which is better."""
    count = random.randint(2, 3)
    accuracy = random.choice((0.6, 0.8, 1.0))
    values = [random.choice((5, 10, 20)), *(random.choice((-20, 0, 5, 9)) for _ in range(count - 1))]
    cost = random.choice((0, 0, 0, -0.001, -0.1))
    danger = random.choice((0, 0, 0.02))
    rooms = random.randint(3, 10) if large else 1

    def step(state: State, action: int) -> list[Outcome]:
        room, good = state
        if action == 0:
            observation = noisy(good, count, accuracy)
            lost = Outcome(danger, state, cost, NOTHING_SEEN, FAILURE)
            return [Outcome(1 - danger, (moved(room, 1, rooms), good), cost, observation), lost]
        value = values[(action - 1 - good) % count]
        return [Outcome(1.0, state, value, NOTHING_SEEN, GOAL if value > 0 else FAILURE)]

    horizon = random.randint(5, 20)
    discount = random.choice((1.0, 0.999999, 0.9999, 0.99))
    names = ["wait", *(f"exit{i}" for i in range(count))]
    starts = [(odds, (0, good)) for good, odds in enumerate(odds_of(random, count)) if odds > 0]
    return World("exits", discount, horizon, ("room", "good"), names, starts, step)


def pursuit(random: Random, large: bool) -> World:
    """A robot that has to catch what runs away; it sees it from nearby only, or through noise."""
    cells = random.randint(7, 12) if large else random.randint(3, 6)
    is_ring = random.random() < 0.5
    flees = random.choice((0.3, 0.6, 0.9))
    reach = random.choice((0, 0, 1))
    accuracy = random.choice((0.7, 0.9, 1.0))
    prize, fine, cost = 10, random.choice((-1, -10)), random.choice((-1, -0.1))

    def beside(place: int, by: int) -> int:
        return (place + by) % cells if is_ring else moved(place, by, cells)

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
            observation = noisy(int(abs(robot - after) <= reach), 2, accuracy)
            found.append(Outcome(odds, (robot, after), cost, observation))
        return found

    horizon = random.randint(8, 25)
    starts = [(1.0, (0, place)) for place in range(1, cells)]
    names = ["on", "back", "catch"]
    return World("pursuit", some_discount(random, horizon), horizon, ("robot", "target"), names, starts, step)


def search(random: Random, large: bool) -> World:
    """A thing in a grid, and a sensor that is the better the nearer; to take it where it is not costs."""
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
        robot = cells.index((moved(x, by_x, width), moved(y, by_y, height)))
        far = abs(cells[robot][0] - cells[thing][0]) + abs(cells[robot][1] - cells[thing][1])
        beeps = round(0.05 + 0.9 * 2 ** (-far / reach), 3)
        return [Outcome(1.0, (robot, thing), cost, ((1, beeps), (0, 1 - beeps)))]

    horizon = random.randint(6, 20)
    starts = [(odds, (0, thing)) for thing, odds in enumerate(odds_of(random, len(cells))) if odds > 0]
    names = ["e", "n", "w", "s", "take"]
    return World("search", some_discount(random, horizon), horizon, ("robot", "thing"), names, starts, step)


def hallway(random: Random, large: bool) -> World:
    """A robot in a hallway asks where it is: cells that look alike, sensors and motors that err, a goal
    that has to be declared."""
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
            Outcome(odds, (after,), cost, noisy(looks[after], 3, accuracy))
            for odds, after in (
                (1 - 2 * slip, (place + way) % cells),
                (slip, place),
                (slip, (place + 2 * way) % cells),
            )
        ]

    horizon = random.randint(10, 30)
    starts = [(1.0, (place,)) for place in range(cells)]
    return World(
        "hallway", some_discount(random, horizon), horizon, ("cell",), ["on", "back", "here"], starts, step
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
            observation: Seen = noisy(after[machine], 2, accuracy) if looks else NOTHING_SEEN
            found.append(Outcome(odds, after, reward, observation))
        return found

    horizon = random.randint(6, 20)
    names = [*(f"repair{i}" for i in range(count)), *(f"look{i}" for i in range(count)), "wait"]
    discount = random.choice((0.9, 0.95, 0.99))
    variables = tuple(f"broken{i}" for i in range(count))
    return World("machines", discount, horizon, variables, names, [(1.0, (0,) * count)], step)
