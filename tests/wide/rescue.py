import random
from collections import deque

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

_WIDE = 4  # rooms in a row; the dock is room 0
_JAMS, _FORCED = 0.25, 0.6
_BATTERY = 24
_SEES, _MISTAKES = 0.9, 0.05
_HEARS = (0.9, 0.5, 0.15)  # by the distance in rooms of the nearer person
_DISCOUNT = 0.985
_STEPS = ((0, -1), (1, 0), (0, 1), (-1, 0))


def _environment(high: int) -> str:
    rooms = _WIDE * high
    return f"""horizon: 80
discount: {_DISCOUNT}

state_variable: int at

state_variable: int battery
default_value: {_BATTERY}

state_variable: int person []
code:
state.person.assign(2, 0);

state_variable: bool is_helped []
code:
state.is_helped.assign(2, false);

// The door to the east of a room, and the one to the south.
state_variable: bool is_jammed []
code:
state.is_jammed.assign({2 * rooms}, false);

initial_belief:
for (int i = 0; i < 2; i++) state.person[i] = 1 + AOSUtils::SampleDiscrete(vector<double>({rooms - 1}, 1.0));
for (int i = 0; i < {2 * rooms}; i++) state.is_jammed[i] = AOS.Bernoulli({_JAMS});

reward_code:
if (state.battery < 0) {{
    __isFailureState = true;
    __reward = -40;
}}

reward_code:
if (state.is_helped[0] && state.is_helped[1]) {{
    __isGoalState = true;
    __reward = 10;
}}
"""


def rescue(high: int = 3) -> Bundle:
    writer = BundleWriter(f"rescue{high}", _environment(high))
    way = f"""int x = state.at % {_WIDE}, y = state.at / {_WIDE};
int to_x = x + (direction == 1) - (direction == 3), to_y = y + (direction == 2) - (direction == 0);
bool is_wall = to_x < 0 || to_x >= {_WIDE} || to_y < 0 || to_y >= {high};
int door = 2 * (std::min(y, to_y) * {_WIDE} + std::min(x, to_x)) + (to_y != y ? 1 : 0);
"""
    go = f"""{way}state__.battery = state.battery - 1;
__reward = -0.3;
if (is_wall || state.is_jammed[door]) {{
    __moduleResponse = blocked;
}} else {{
    state__.at = to_y * {_WIDE} + to_x;
    __moduleResponse = moved;
}}"""
    writer.skill("go", go, over={"direction": "4"})
    force = f"""{way}state__.battery = state.battery - 3;
__reward = -1;
if (!is_wall && AOS.Bernoulli({_FORCED})) {{
    state__.is_jammed[door] = false;
    __moduleResponse = opened;
}} else {{
    __moduleResponse = stuck;
}}"""
    writer.skill("force", force, over={"direction": "4"})
    listen = f"""__reward = -0.2;
double odds = {_MISTAKES};
for (int i = 0; i < 2; i++) {{
    int across = state.person[i] % {_WIDE} - state.at % {_WIDE};
    int far = abs(across) + abs(state.person[i] / {_WIDE} - state.at / {_WIDE});
    double heard = far == 0 ? {_HEARS[0]} : far == 1 ? {_HEARS[1]} : far == 2 ? {_HEARS[2]} : {_MISTAKES};
    if (!state.is_helped[i]) odds = std::max(odds, heard);
}}
__moduleResponse = AOS.Bernoulli(odds) ? voice : silence;"""
    writer.skill("listen", listen)
    here = "bool is_here = false;\n" + (
        "for (int i = 0; i < 2; i++) is_here |= state.person[i] == state.at && !state.is_helped[i];\n"
    )
    look = f"""__reward = -0.2;
{here}__moduleResponse = AOS.Bernoulli(is_here ? {_SEES} : {_MISTAKES}) ? somebody : nobody;"""
    writer.skill("look", look)
    assist = f"""{here}__reward = is_here ? 20 : -3;
for (int i = 0; i < 2; i++) if (state.person[i] == state.at) state__.is_helped[i] = true;
__moduleResponse = is_here ? helped : nobody;"""
    writer.skill("assist", assist)
    writer.charger(_BATTERY)
    return writer.files


class Rescue(World):
    """The rooms as the documents describe them."""

    def __init__(self, high: int, rng: random.Random):
        super().__init__(rng, _DISCOUNT, go=4, force=4, listen=1, look=1, assist=1, charge=1)
        self.high, self.rooms = high, _WIDE * high
        self.people = [1 + rng.randrange(self.rooms - 1) for _ in range(2)]
        self.is_helped = [False, False]
        self.is_jammed = [rng.random() < _JAMS for _ in range(2 * self.rooms)]
        self.at, self.battery = 0, _BATTERY

    def through(self, room: int, direction: int) -> tuple[int, int] | None:
        """The door from a room in a direction, and the room behind; None where there is a wall."""
        x, y = room % _WIDE, room // _WIDE
        to_x, to_y = x + _STEPS[direction][0], y + _STEPS[direction][1]
        if not (0 <= to_x < _WIDE and 0 <= to_y < self.high):
            return None
        return 2 * (min(y, to_y) * _WIDE + min(x, to_x)) + (to_y != y), to_y * _WIDE + to_x

    def act(self, skill: str, value: int = 0) -> str:
        here = [i for i in (0, 1) if self.people[i] == self.at and not self.is_helped[i]]
        told, reward = "", -0.2
        if skill in {"go", "force"}:
            way = self.through(self.at, value)
            self.battery -= 1 if skill == "go" else 3
            reward = -0.3 if skill == "go" else -1.0
            if skill == "go" and way and not self.is_jammed[way[0]]:
                self.at, told = way[1], "moved"
            elif skill == "force" and way and self.rng.random() < _FORCED:
                self.is_jammed[way[0]], told = False, "opened"
        elif skill == "listen":
            told = "voice" if self.rng.random() < self._heard() else "silence"
        elif skill == "look":
            told = "somebody" if self.rng.random() < (_SEES if here else _MISTAKES) else "nobody"
        elif skill == "assist":
            reward = 20.0 if here else -3.0
            for i in here:
                self.is_helped[i], told = True, "helped"
        else:
            reward = -0.5
            self.battery = _BATTERY if self.at == 0 else self.battery
        self.has_ended = all(self.is_helped) or self.battery < 0
        self.gain(reward + (10 if all(self.is_helped) else 0) - (40 if self.battery < 0 else 0))
        return told

    def _heard(self) -> float:
        odds = _MISTAKES
        for i in (0, 1):
            x, y = self.people[i] % _WIDE, self.people[i] // _WIDE
            far = abs(x - self.at % _WIDE) + abs(y - self.at // _WIDE)
            if not self.is_helped[i] and far < len(_HEARS):
                odds = max(odds, _HEARS[far])
        return odds


def _way(world: Rescue, jams: np.ndarray, start: int, goal: int) -> tuple[int, int]:
    costs, first = {start: 0.0}, {start: 0}
    queue = deque([start])
    while queue:
        room = queue.popleft()
        for direction in range(4):
            way = world.through(room, direction)
            if way is None:
                continue
            cost = costs[room] + 1 + jams[way[0]] * 6
            if cost < costs.get(way[1], 1e9):
                costs[way[1]] = cost
                first[way[1]] = direction if room == start else first[room]
                queue.append(way[1])
    return first[goal], int(np.ceil(costs[goal]))


def rescue_rule(high: int, rng: random.Random) -> float:
    world = Rescue(high, rng)
    jams = np.full(2 * world.rooms, _JAMS)
    odds = np.full(world.rooms, 2 / (world.rooms - 1))  # that an unhelped person is there
    odds[0] = 0
    while not world.is_over:
        room = world.at
        if odds[room] > 0.6:
            world.act("assist")
            odds[room] = 0
            continue
        if odds[room] > 0.02:
            seen = world.act("look") == "somebody"
            yes, no = (_SEES, _MISTAKES) if seen else (1 - _SEES, 1 - _MISTAKES)
            odds[room] = odds[room] * yes / (odds[room] * yes + (1 - odds[room]) * no)
            continue
        others = [goal for goal in range(world.rooms) if goal != room]
        worth = {goal: odds[goal] / (1 + _way(world, jams, room, goal)[1]) for goal in others}
        goal = max(worth, key=lambda place: worth[place])
        there, home = _way(world, jams, room, goal)[1], _way(world, jams, goal, 0)[1]
        if world.battery < there + home + 4 and not (room == 0 and world.battery == _BATTERY):
            goal = 0
        if room == 0 and goal == 0:
            world.act("charge")
            continue
        direction = _way(world, jams, room, goal)[0]
        way = world.through(room, direction)
        assert way is not None
        if jams[way[0]] > 0.9:
            jams[way[0]] = 0.0 if world.act("force", direction) == "opened" else 1.0
        else:
            jams[way[0]] = 0.0 if world.act("go", direction) == "moved" else 1.0
    return world.earned
