"""One thing is in one of many places: a drone seeks it on a grid, a robot on shelves, a boat by a pipe.

A look tells little, batteries drain unevenly, and what was found pays only once the robot is home.
"""

import random
from collections.abc import Callable

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

_CHARGE, _SEEN, _FALSE, _FOUND, _LOST = 90, 0.85, 0.05, 60, -60
_END = f"""bool is_home = %s;
if (state.has_landed) {{
    __reward = !is_home ? {_LOST} : state.has_it ? {_FOUND} : 0;
    __isGoalState = is_home;
    __isFailureState = !is_home;
}} else if (state.charge <= 0) {{
    __reward = {_LOST};
    __isFailureState = true;
}}
"""
_DRAIN = "AOS.SampleUniform(0.9, 1.1)"


def _writer(name: str, variables: str, start: str, home: str) -> BundleWriter:
    flags = "state_variable: bool has_it\n\nstate_variable: bool has_landed\n\n"
    charge = f"state_variable: double charge\ndefault_value: {_CHARGE}\n\n"
    texts = "".join(f"state_variable: int {variable}\n\n" for variable in variables.split())
    environment = f"horizon: 90\ndiscount: 0.99\n\n{texts}{charge}{flags}"
    writer = BundleWriter(name, f"{environment}initial_belief:\n{start}\n\nreward_code:\n{_END % home}")
    writer.skill("land", ["landed"], "state__.has_landed = true;\n__moduleResponse = landed;")
    return writer


def spot(size: int = 12) -> Bundle:
    """The drone starts at home, in a corner; a look sees the cells around with false alarms."""
    draw = f"AOS.SampleDiscrete(std::vector<double>({size}, 1.0))"
    start = f"state.at_x = {draw};\nstate.at_y = {draw};"
    writer = _writer(f"spot{size}", "x y at_x at_y", start, "state.x == 0 && state.y == 0")
    fly = f"""__reward = -0.2;
state__.x = std::max(0, std::min(state.x + (direction == 1) - (direction == 3), {size - 1}));
state__.y = std::max(0, std::min(state.y + (direction == 0) - (direction == 2), {size - 1}));
state__.charge = state.charge - {_DRAIN};
__moduleResponse = flown;"""
    writer.skill("fly", ["flown"], fly, over={"direction": "4"})
    look = f"""__reward = -0.2;
state__.charge = state.charge - {_DRAIN};
bool is_near = std::max(abs(state.x - state.at_x), abs(state.y - state.at_y)) <= 1;
__moduleResponse = AOS.Bernoulli(is_near ? {_SEEN} : {_FALSE}) ? seen : unseen;"""
    writer.skill("look", ["seen", "unseen"], look)
    take = f"""bool is_there = state.x == state.at_x && state.y == state.at_y;
__reward = is_there ? -0.2 : -1;
state__.charge = state.charge - {_DRAIN};
if (is_there) state__.has_it = true;
__moduleResponse = is_there ? taken : missed;"""
    writer.skill("take", ["taken", "missed"], take)
    return writer.files


class _Seek(World):
    """The battery of the three worlds, and their end at home."""

    discount = 0.99

    def __init__(self, size: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.size, self.charge, self.has_it = size, float(_CHARGE), False

    def land(self, is_home: bool) -> str:
        """Ends the mission."""
        self.has_ended = True
        self.gain(_LOST if not is_home else _FOUND if self.has_it else 0)
        return "landed"

    def spend(self, reward: float, told: str, steps: int = 1) -> str:
        """Takes a step, which may empty the battery."""
        self.charge -= sum(self.rng.uniform(0.9, 1.1) for _ in range(steps))
        self.has_ended = self.charge <= 0
        self.gain(reward + (_LOST if self.has_ended else 0))
        return told


class Spot(_Seek):
    """The drone as the documents describe it."""

    def __init__(self, size: int, rng: random.Random) -> None:
        super().__init__(size, rng)
        self.x = self.y = 0
        self.at = (rng.randrange(size), rng.randrange(size))

    def actions(self) -> list[tuple[str, int]]:
        return [*(("fly", way) for way in range(4)), ("look", 0), ("take", 0), ("land", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        if skill == "land":
            return self.land(self.x == 0 and self.y == 0)
        if skill == "fly":
            self.x = max(0, min(self.x + (value == 1) - (value == 3), self.size - 1))
            self.y = max(0, min(self.y + (value == 0) - (value == 2), self.size - 1))
            return self.spend(-0.2, "flown")
        if skill == "look":
            is_near = max(abs(self.x - self.at[0]), abs(self.y - self.at[1])) <= 1
            return self.spend(
                -0.2, "seen" if self.rng.random() < (_SEEN if is_near else _FALSE) else "unseen"
            )
        is_there = (self.x, self.y) == self.at
        self.has_it = self.has_it or is_there
        return self.spend(-0.2 if is_there else -1, "taken" if is_there else "missed")


def spot_rule(size: int, rng: random.Random) -> float:
    """Sweeps in rows, goes where something was seen, and is home in time."""
    world = Spot(size, rng)
    places = np.arange(size)
    odds = np.full((size, size), 1 / size**2)
    rows = [range(1, size, 3), range(size - 2, 0, -3)]
    ways = [(x, y) for row, y in enumerate(range(1, size, 3)) for x in rows[row % 2]]
    while not world.is_over:
        x, y = world.x, world.y
        if world.has_it or world.charge <= 1.1 * (x + y) + 3:
            goal = (0, 0)
        elif odds.max() > 0.06:
            goal = tuple(int(i) for i in np.unravel_index(odds.argmax(), odds.shape))
        else:
            goal = ways[0] if ways else (0, 0)
        if (x, y) != goal:
            world.act("fly", (1 if goal[0] > x else 3) if goal[0] != x else (0 if goal[1] > y else 2))
        elif goal == (0, 0):
            world.act("land")
        elif odds[x, y] > 0.2:
            if world.act("take") == "missed":
                odds[x, y] = 0
        else:
            if ways and goal == ways[0]:
                ways.pop(0)
            near = np.maximum(abs(places - x)[:, None], abs(places - y)[None, :]) <= 1
            likelihood = np.where(near, _SEEN, _FALSE)
            odds *= likelihood if world.act("look") == "seen" else 1 - likelihood
        odds /= odds.sum()
    return world.earned


_ROOMS = 5
_HIT, _ALARM = 0.8, 0.1


def shelves(size: int = 60) -> Bundle:
    """A thing on one of the shelves of five rooms; to go to another room takes three units of charge."""
    each = size // _ROOMS
    start = f"state.thing = AOS.SampleDiscrete(std::vector<double>({size}, 1.0));\nstate.room = {_ROOMS};"
    writer = _writer(f"shelves{size}", "room thing", start, f"state.room == {_ROOMS}")
    go = f"""__reward = -0.6;
state__.room = room;
state__.charge = state.charge - 3 * {_DRAIN};
__moduleResponse = there;"""
    writer.skill("go", ["there"], go, over={"room": str(_ROOMS + 1)})
    scan = f"""__reward = -0.2;
state__.charge = state.charge - {_DRAIN};
bool is_there = state.thing == state.room * {each} + shelf;
__moduleResponse = AOS.Bernoulli(is_there ? {_HIT} : {_ALARM}) ? beep : quiet;"""
    writer.skill("scan", ["beep", "quiet"], scan, over={"shelf": str(each)})
    pick = f"""bool is_there = state.thing == state.room * {each} + shelf;
__reward = is_there ? -0.2 : -3;
state__.charge = state.charge - 2 * {_DRAIN};
if (is_there) state__.has_it = true;
__moduleResponse = is_there ? picked : missed;"""
    writer.skill("pick", ["picked", "missed"], pick, over={"shelf": str(each)})
    return writer.files


class Shelves(_Seek):
    """The rooms as the documents describe them."""

    def __init__(self, size: int, rng: random.Random) -> None:
        super().__init__(size, rng)
        self.room, self.thing, self.each = _ROOMS, rng.randrange(size), size // _ROOMS

    def actions(self) -> list[tuple[str, int]]:
        here = [(skill, shelf) for skill in ("scan", "pick") for shelf in range(self.each)]
        return [*(("go", room) for room in range(_ROOMS + 1)), *here, ("land", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        if skill == "land":
            return self.land(self.room == _ROOMS)
        if skill == "go":
            self.room = value
            return self.spend(-0.6, "there", 3)
        is_there = self.thing == self.room * self.each + value
        if skill == "scan":
            return self.spend(-0.2, "beep" if self.rng.random() < (_HIT if is_there else _ALARM) else "quiet")
        self.has_it = self.has_it or is_there
        return self.spend(-0.2 if is_there else -3, "picked" if is_there else "missed", 2)


def shelves_rule(size: int, rng: random.Random) -> float:
    """Scans each shelf of a room once, and where it beeps up to twice more; picks, and is back in time."""
    world = Shelves(size, rng)
    for room in range(_ROOMS):
        if world.charge <= 12:
            break
        world.act("go", room)
        for shelf in range(world.each):
            if world.has_it or world.charge <= 9:
                break
            beeps = 0
            while beeps < 2 and world.act("scan", shelf) == "beep":
                beeps += 1
            if beeps == 2:
                world.act("pick", shelf)
        if world.has_it:
            break
    if not world.is_over:
        world.act("go", _ROOMS)
        world.act("land")
    return world.earned


_SIGMA = 1.0
_REACH = 4.0


def pipe(size: int = 40) -> Bundle:
    """A leak somewhere along a pipe; a sample is a number, larger near the leak."""
    start = f"state.leak = AOS.SampleDiscrete(std::vector<double>({size}, 1.0));"
    writer = _writer(f"pipe{size}", "x leak", start, "state.x == 0")
    sail = f"""__reward = -0.2;
int by = speed == 0 ? -5 : speed == 1 ? -1 : speed == 2 ? 1 : 5;
state__.x = std::max(0, std::min(state.x + by, {size - 1}));
state__.charge = state.charge - (abs(by) > 1 ? 3 : 1) * {_DRAIN};
__moduleResponse = sailed;"""
    writer.skill("sail", ["sailed"], sail, over={"speed": "4"})
    sample = f"""__reward = -0.2;
state__.charge = state.charge - {_DRAIN};
double strength = 3 * std::exp(-abs(state.x - state.leak) / {_REACH / 2});
__observed.value = AOS.SampleNormal(strength, {_SIGMA});
__moduleResponse = sampled;"""
    writer.skill("sample", ["sampled"], sample, numbers=["value"])
    plug = f"""bool is_there = state.x == state.leak;
__reward = is_there ? -0.2 : -3;
state__.charge = state.charge - 2 * {_DRAIN};
if (is_there) state__.has_it = true;
__moduleResponse = is_there ? plugged : missed;"""
    writer.skill("plug", ["plugged", "missed"], plug)
    return writer.files


class Pipe(_Seek):
    """The pipe as the documents describe it."""

    def __init__(self, size: int, rng: random.Random) -> None:
        super().__init__(size, rng)
        self.x, self.leak, self.value = 0, rng.randrange(size), 0.0

    def actions(self) -> list[tuple[str, int]]:
        return [*(("sail", speed) for speed in range(4)), ("sample", 0), ("plug", 0), ("land", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        if skill == "land":
            return self.land(self.x == 0)
        if skill == "sail":
            by = (-5, -1, 1, 5)[value]
            self.x = max(0, min(self.x + by, self.size - 1))
            return self.spend(-0.2, "sailed", 3 if abs(by) > 1 else 1)
        if skill == "sample":
            self.value = self.rng.gauss(3 * np.exp(-abs(self.x - self.leak) / (_REACH / 2)), _SIGMA)
            return self.spend(-0.2, "sampled")
        is_there = self.x == self.leak
        self.has_it = self.has_it or is_there
        return self.spend(-0.2 if is_there else -3, "plugged" if is_there else "missed", 2)


def pipe_rule(size: int, rng: random.Random) -> float:
    """Samples at every third place, goes where the leak is likely, and is home in time."""
    world, places = Pipe(size, rng), np.arange(size)
    odds, goal = np.full(size, 1 / size), 1
    while not world.is_over:
        x = world.x
        likely = int(odds.argmax())
        back = 3.3 * (x // 5) + 1.1 * (x % 5) + 7
        to = (
            0
            if world.has_it or world.charge <= back
            else likely
            if odds[likely] > 0.15
            else min(goal, size - 1)
        )
        if x != to:
            by = to - x
            world.act("sail", (3 if by >= 5 else 2) if by > 0 else (0 if by <= -5 else 1))
        elif to == 0:
            world.act("land")
        elif odds[x] > 0.25:
            if world.act("plug") == "missed":
                odds[x] = 0
        else:
            if to == goal or goal < x:
                goal = x + 3 if x + 3 < size else 1
            world.act("sample")
            odds *= np.exp(
                -((world.value - 3 * np.exp(-abs(x - places) / (_REACH / 2))) ** 2) / 2 / _SIGMA**2
            )
        odds /= odds.sum()
    return world.earned


SEEK = {"spot": spot, "shelves": shelves, "pipe": pipe}
SEEK_SIZES = {"spot": 12, "shelves": 60, "pipe": 40}
SEEK_RULES = {"spot": spot_rule, "shelves": shelves_rule, "pipe": pipe_rule}
SEEK_WORLDS: dict[str, Callable[[int, random.Random], World]] = {
    "spot": Spot,
    "shelves": Shelves,
    "pipe": Pipe,
}
