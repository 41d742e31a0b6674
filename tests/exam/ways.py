import random

from .chances import moved, noisy, odds_of, some_discount
from .problem import FAILURE, GOAL, NOTHING_SEEN, RUNNING, Outcome, Seen, State, World

Random = random.Random


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
            after = {"stay": state[0], "left": moved(state[0], -1, cells), "fall": 0}[backwards]
        else:
            after = moved(state[0], way, cells)
        found = []
        for odds, place in ((1 - slip, after), (slip, state[0])):
            is_there = place == goal and way == 1
            observation = (
                noisy(place, cells, accuracy) if accuracy in (0, 1) else _edge(place, cells, accuracy)
            )
            back = 0 if is_there and not ends else place
            found.append(
                Outcome(
                    odds,
                    (back,),
                    cost + (prize if is_there else 0),
                    NOTHING_SEEN if accuracy == 0 else observation,
                    GOAL if is_there and ends else RUNNING,
                )
            )
        return found

    horizon = max(cells + random.randint(0, cells), 5) if slip == 0 else 2 * cells
    starts = [(1.0, (0,))]
    if random.random() < 0.4:
        starts = [(1.0, (place,)) for place in range(max(cells // 2, 1))]
    actions = ["one", "other", *(f"wait{i}" for i in range(noops))]
    return World(
        "corridor", some_discount(random, horizon), min(horizon, 120), ("cell",), actions, starts, step
    )


def _edge(place: int, cells: int, accuracy: float) -> Seen:
    """Senses whether there is a wall."""
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
            x = moved(state[0], moves[move][0], width)
            y = moved(state[1], moves[move][1], height)
            observation = seen_at(x, y, (x, y) == state)
            if (x, y) == goal:
                found.append(Outcome(odds, (x, y), cost + prize, observation, GOAL))
            elif (x, y) in traps:
                found.append(
                    Outcome(odds, (x, y), cost + fine, observation, FAILURE if trap_ends else RUNNING)
                )
            else:
                found.append(Outcome(odds, (x, y), cost, observation))
        return found

    starts = [(1.0, (0, 0))]
    if random.random() < 0.4:
        starts = [
            (1.0, cell) for cell in random.sample(cells[:-1], min(3, len(cells) - 1)) if cell not in traps
        ] or starts
    horizon = min(2 * (width + height) + random.randint(0, 10), 60)
    return World(
        "grid", some_discount(random, horizon), horizon, ("x", "y"), ["e", "n", "w", "s"], starts, step
    )


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
            place = moved(place, 1 if action == 0 else -1, cells)
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
        observation = has_key if sees_key else NOTHING_SEEN
        return [Outcome(1.0, (place, has_key, key), reward, observation, ending)]

    places = [0, 1] if hidden else [0]
    starts = [(1.0, (home, 0, key)) for key in places]
    horizon = min(3 * cells + 6, 100)
    names = ["right", "left", "take", "open"]
    return World(
        "keys", some_discount(random, horizon), horizon, ("cell", "has_key", "key"), names, starts, step
    )


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
            one = min(moved(one, 1 if action == 0 else -1, cells), box - 1)
        else:
            other = min(moved(other, 1 if action == 2 else -1, cells), box - 1)
        done = Outcome(1 - slip, (one, other, box), reward, int(one == other), ending)
        return [done, Outcome(slip, state, cost, int(state[0] == state[1]))]

    starts = [(1.0, (0, random.randint(0, 1), random.randint(2, cells - 1)))]
    horizon = random.randint(10, 20) + 3 * cells
    names = ["one_up", "one_down", "other_up", "other_down", "push"]
    return World(
        "pushing", some_discount(random, horizon), horizon, ("one", "other", "box"), names, starts, step
    )


def late(random: Random, large: bool) -> World:
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
            place = moved(place, 1, cells)
        elif action == 1 and place == 0 and is_painted:
            colour = (colour + 1) % colours
        elif action >= 2 and place == cells - 1:
            is_right = action - 2 == colour
            return [
                Outcome(1.0, state, prize if is_right else fine, NOTHING_SEEN, GOAL if is_right else FAILURE)
            ]
        observation: Seen = noisy(colour, colours, accuracy) if is_seen and place == 0 else NOTHING_SEEN
        return [Outcome(1.0, (place, colour), cost, observation)]

    starts = [(odds, (0, colour)) for colour, odds in enumerate(odds_of(random, colours)) if odds > 0]
    horizon = cells + random.randint(4, 10)
    names = ["on", "paint", *(f"say{i}" for i in range(colours))]
    return World("late", some_discount(random, horizon), horizon, ("cell", "colour"), names, starts, step)


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
        place = moved(place, (1, -1, 0, 0)[action], fork + 1)
        observation: Seen = noisy(side, 2, accuracy) if place == 0 else NOTHING_SEEN
        return [Outcome(1.0, (place, side), cost, observation)]

    odds = random.choice((0.5, 0.4, 0.2))
    starts = [(odds, (way, 0)), (1 - odds, (way, 1))]
    horizon = 2 * way + arm + random.randint(3, 10)
    names = ["on", "back", "left", "right"]
    return World("heaven", some_discount(random, horizon), horizon, ("cell", "side"), names, starts, step)


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
    return World("lock", some_discount(random, horizon), horizon, ("done",), names, [(1.0, (0,))], step)


def invest(random: Random, large: bool) -> World:
    """A long loss before a gain: doing nothing is worth 0, and all steps of the way but the last cost."""
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
        observation = done + 1 if is_seen else NOTHING_SEEN
        return [
            Outcome(1 - lapse, (done + 1,), cost, observation),
            Outcome(lapse, (0,), cost, 0 if is_seen else NOTHING_SEEN),
        ]

    horizon = min(length + random.randint(2, 20), 60)
    discount = random.choice((1.0, 0.999, 0.99, round(0.7 ** (1 / length), 4)))
    return World("invest", discount, horizon, ("done",), ["rest", "work"], [(1.0, (0,))], step)


def battery(random: Random, large: bool) -> World:
    """Extrinsic changes: work far away costs charge, which also leaks; an empty battery is the end."""
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
            place = moved(place, 1 if action == 0 else -1, cells)
            charge -= 1
        elif action == 2:
            reward = earned if place == cells - 1 else -0.1
            charge -= 1
        else:
            charge = full if place == 0 else charge
        found = []
        for odds, lost in ((1 - leak, 0), (leak, 1)):
            rest = max(charge - lost, 0)
            observation = (
                rest if sees == "charge" else int(rest <= full // 3) if sees == "low" else NOTHING_SEEN
            )
            if rest == 0:
                found.append(Outcome(odds, (place, 0), reward + fine, observation, FAILURE))
            else:
                found.append(Outcome(odds, (place, rest), reward, observation))
        return found

    horizon = random.randint(10, 30)
    names = ["out", "home", "work", "charge"]
    starts = [(1.0, (0, full))]
    return World("battery", some_discount(random, horizon), horizon, ("place", "charge"), names, starts, step)
