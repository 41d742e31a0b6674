"""A boat looks for a leak along a pipe: a sample tells little, the battery drains unevenly, and home pays."""

import random

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

_CHARGE, _FOUND, _LOST = 90, 60, -60
_END = f"""bool is_home = state.x == 0;
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


_SIGMA = 1.0
_REACH = 4.0


def pipe(size: int = 40) -> Bundle:
    """A leak somewhere along a pipe; a sample is a number, larger near the leak."""
    integers = "state_variable: int x\n\nstate_variable: int leak\n\n"
    charge = f"state_variable: double charge\ndefault_value: {_CHARGE}\n\n"
    flags = "state_variable: bool has_it\n\nstate_variable: bool has_landed\n\n"
    start = f"state.leak = AOS.SampleDiscrete(std::vector<double>({size}, 1.0));"
    environment = f"horizon: 90\ndiscount: 0.99\n\n{integers}{charge}{flags}"
    writer = BundleWriter(f"pipe{size}", f"{environment}initial_belief:\n{start}\n\nreward_code:\n{_END}")
    writer.skill("land", "state__.has_landed = true;\n__moduleResponse = landed;")
    sail = f"""__reward = -0.2;
int by = speed == 0 ? -5 : speed == 1 ? -1 : speed == 2 ? 1 : 5;
state__.x = std::max(0, std::min(state.x + by, {size - 1}));
state__.charge = state.charge - (abs(by) > 1 ? 3 : 1) * {_DRAIN};
__moduleResponse = sailed;"""
    writer.skill("sail", sail, over={"speed": "4"})
    sample = f"""__reward = -0.2;
state__.charge = state.charge - {_DRAIN};
double strength = 3 * std::exp(-abs(state.x - state.leak) / {_REACH / 2});
__observed.value = AOS.SampleNormal(strength, {_SIGMA});
__moduleResponse = sampled;"""
    writer.skill("sample", sample)
    plug = f"""bool is_there = state.x == state.leak;
__reward = is_there ? -0.2 : -3;
state__.charge = state.charge - 2 * {_DRAIN};
if (is_there) state__.has_it = true;
__moduleResponse = is_there ? plugged : missed;"""
    writer.skill("plug", plug)
    return writer.files


class Pipe(World):
    """The pipe as the documents describe it."""

    def __init__(self, size: int, rng: random.Random):
        super().__init__(rng, 0.99, sail=4, sample=1, plug=1, land=1)
        self.size, self.charge, self.has_it = size, float(_CHARGE), False
        self.x, self.leak, self.value = 0, rng.randrange(size), 0.0

    def act(self, skill: str, value: int = 0) -> str:
        if skill == "land":
            self.has_ended = True
            self.gain(_LOST if self.x != 0 else _FOUND if self.has_it else 0)
            return "landed"
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

    def spend(self, reward: float, told: str, steps: int = 1) -> str:
        """Takes a step, which may empty the battery."""
        self.charge -= sum(self.rng.uniform(0.9, 1.1) for _ in range(steps))
        self.has_ended = self.charge <= 0
        self.gain(reward + (_LOST if self.has_ended else 0))
        return told


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
