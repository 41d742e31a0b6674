"""A robot that clears a table of things whose places are numbers: documents and a rule."""

import random

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

_SIDE_M, _CELLS = 1.2, 5  # the gripper goes to the middle of one of 5 x 5 cells
_CELL_M = _SIDE_M / _CELLS
_REACH_M, _NUDGE_M = 0.15, 0.3
_PUSHED_M = 0.08
_DISCOUNT = 0.98
_NEAR_M, _FAR = 0.03, 0.35  # the deviation of a look, and how it grows with the distance


def _environment(things: int) -> str:
    return f"""horizon: 80
discount: {_DISCOUNT}

state_variable: int cell

state_variable: double x_m []
code:
state.x_m.assign({things}, 0);

state_variable: double y_m []
code:
state.y_m.assign({things}, 0);

state_variable: bool is_gone []
code:
state.is_gone.assign({things}, false);

initial_belief:
for (int i = 0; i < {things}; i++) {{
    state.x_m[i] = AOS.SampleUniform(0, {_SIDE_M});
    state.y_m[i] = AOS.SampleUniform(0, {_SIDE_M});
}}

reward_code:
bool all = true;
for (int i = 0; i < {things}; i++) if (!state.is_gone[i]) all = false;
if (all) {{
    __isGoalState = true;
    __reward = 10;
}}
"""


def tabletop(things: int = 5) -> Bundle:
    """A gripper goes to cells, looks are sharper from nearby, and a grasp beside a thing pushes it."""
    writer = BundleWriter(f"tabletop{things}", _environment(things))
    at = f"""double at_x = ({{0}} % {_CELLS} + 0.5) * {_CELL_M}, at_y = ({{0}} / {_CELLS} + 0.5) * {_CELL_M};
"""
    far = "double far = sqrt(pow(state.x_m[thing] - at_x, 2) + pow(state.y_m[thing] - at_y, 2));\n"
    move = f"""int across = abs(to % {_CELLS} - state.cell % {_CELLS});
int along = abs(to / {_CELLS} - state.cell / {_CELLS});
__reward = -0.2 - 0.1 * (across + along);
state__.cell = to;
__moduleResponse = arrived;"""
    writer.skill("move", ["arrived"], move, over={"to": str(_CELLS * _CELLS)})
    look = f"""__reward = -0.2;
if (state.is_gone[thing]) {{
    __moduleResponse = gone;
}} else {{
    {at.format("state.cell")}    {far}    double deviation = {_NEAR_M} + {_FAR} * far;
    __moduleResponse = seen;
    __observed.x_m = AOS.SampleNormal(state.x_m[thing], deviation);
    __observed.y_m = AOS.SampleNormal(state.y_m[thing], deviation);
}}"""
    one = {"thing": str(things)}
    writer.skill("look", ["seen", "gone"], look, over=one, numbers=["x_m", "y_m"])
    grasp = f"""{at.format("state.cell")}{far}if (state.is_gone[thing]) {{
    __reward = -1;
    __moduleResponse = missed;
}} else if (far < {_REACH_M}) {{
    state__.is_gone[thing] = true;
    __reward = 6;
    __moduleResponse = grasped;
}} else {{
    __reward = -1.5;
    __moduleResponse = missed;
    if (far < {_NUDGE_M}) {{
        state__.x_m[thing] = std::clamp(state.x_m[thing] + AOS.SampleNormal(0, {_PUSHED_M}), 0.0, {_SIDE_M});
        state__.y_m[thing] = std::clamp(state.y_m[thing] + AOS.SampleNormal(0, {_PUSHED_M}), 0.0, {_SIDE_M});
    }}
}}"""
    writer.skill("grasp", ["grasped", "missed"], grasp, over=one)
    return writer.files


class Tabletop(World):
    """The table as the documents describe it. A look keeps its numbers in `seen`."""

    discount = _DISCOUNT

    def __init__(self, things: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.places = [np.array([rng.uniform(0, _SIDE_M), rng.uniform(0, _SIDE_M)]) for _ in range(things)]
        self.is_gone = [False] * things
        self.cell = 0
        self.seen = np.zeros(2)

    def actions(self) -> list[tuple[str, int]]:
        on_things = [(skill, i) for skill in ("look", "grasp") for i in range(len(self.places))]
        return [*on_things, *(("move", cell) for cell in range(_CELLS * _CELLS))]

    @staticmethod
    def middle(cell: int) -> np.ndarray:
        """The place above which the gripper is in a cell, in metres."""
        return (np.array([cell % _CELLS, cell // _CELLS]) + 0.5) * _CELL_M

    def act(self, skill: str, value: int = 0) -> str:
        if skill == "move":
            apart = abs(value % _CELLS - self.cell % _CELLS) + abs(value // _CELLS - self.cell // _CELLS)
            self.cell = value
            self.gain(-0.2 - 0.1 * apart)
            return "arrived"
        far = float(np.hypot(*(self.places[value] - self.middle(self.cell))))
        if skill == "look":
            self.seen = self.places[value] + self._noise(_NEAR_M + _FAR * far)
            self.gain(-0.2)
            return "gone" if self.is_gone[value] else "seen"
        if self.is_gone[value] or far >= _REACH_M:
            if far < _NUDGE_M:
                self.places[value] = np.clip(self.places[value] + self._noise(_PUSHED_M), 0, _SIDE_M)
            self.gain(-1.0 if self.is_gone[value] else -1.5)
            return "missed"
        self.is_gone[value] = True
        self.has_ended = all(self.is_gone)
        self.gain(6 + (10 if self.has_ended else 0))
        return "grasped"

    def _noise(self, deviation: float) -> np.ndarray:
        return np.array([self.rng.gauss(0, deviation), self.rng.gauss(0, deviation)])


def tabletop_rule(things: int, rng: random.Random) -> float:
    """Looks at a thing up to a deviation of 0.2 m, goes there, looks again, and grasps by 0.1 m."""
    world = Tabletop(things, rng)
    for thing in range(things):
        place, variance = np.full(2, _SIDE_M / 2), _SIDE_M**2 / 12
        while not world.is_over and not world.is_gone[thing]:
            cells = np.clip(place // _CELL_M, 0, _CELLS - 1).astype(int)
            goal = int(cells[0] + _CELLS * cells[1])
            if variance < 0.2**2 and world.cell != goal:
                world.act("move", goal)
            elif variance < 0.1**2:
                world.act("grasp", thing)
                variance += _PUSHED_M**2
            else:
                world.act("look", thing)
                far = float(np.hypot(*(place - world.middle(world.cell))))
                noise = (_NEAR_M + _FAR * np.hypot(far, variance**0.5)) ** 2
                place = (place * noise + world.seen * variance) / (variance + noise)
                variance = variance * noise / (variance + noise)
    return world.earned
