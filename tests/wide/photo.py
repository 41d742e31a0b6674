"""A drone with a battery takes a photo in an unknown cell and comes back; a wind blows east.

The values of all its states can be computed without observations, and promise far too much.
"""

import random

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

__all__ = ["Photo", "photo", "photo_rule"]

_DISCOUNT = 0.98
_CHARGE, _WIND, _FELT = 70, 0.15, 0.95
_SEEN = 0.85  # what is below the drone, or up to two cells away; else nothing is seen


def _environment(size: int) -> str:
    return f"""horizon: 70
discount: {_DISCOUNT}

state_variable: int x

state_variable: int y

state_variable: int charge
default_value: {_CHARGE}

state_variable: int at_x

state_variable: int at_y

state_variable: bool has_photo

state_variable: bool has_landed

initial_belief:
state.at_x = AOSUtils::SampleDiscrete(vector<double>({size}, 1.0));
state.at_y = AOSUtils::SampleDiscrete(vector<double>({size}, 1.0));

reward_code:
if (state.has_landed) {{
    bool is_home = state.x == 0 && state.y == 0;
    __reward = is_home ? (state.has_photo ? 60 : 0) : -15;
    __isGoalState = is_home;
    __isFailureState = !is_home;
}} else if (state.charge <= 0) {{
    __reward = -20;
    __isFailureState = true;
}}
"""


def photo(size: int = 12) -> Bundle:
    """The drone starts at home, in a corner."""
    writer = BundleWriter(f"photo{size}", _environment(size))
    fly = f"""__reward = -0.2;
bool is_blown = AOS.Bernoulli({_WIND});
state__.x = std::max(0, std::min(state.x + (direction == 1) - (direction == 3) + is_blown, {size - 1}));
state__.y = std::max(0, std::min(state.y + (direction == 0) - (direction == 2), {size - 1}));
state__.charge = state.charge - 1;
__moduleResponse = AOS.Bernoulli({_FELT}) == is_blown ? blown : calm;"""
    writer.skill("fly", fly, over={"direction": "4"})
    look = f"""__reward = -0.2;
state__.charge = state.charge - 1;
int distance = std::max(abs(state.x - state.at_x), abs(state.y - state.at_y));
__moduleResponse = !AOS.Bernoulli({_SEEN}) || distance > 2 ? unseen : distance == 0 ? below : near;"""
    writer.skill("look", look)
    locate = """__reward = -0.2;
state__.charge = state.charge - 1;
__moduleResponse = state.x < 4 ? west : state.x < 8 ? middle : east;"""
    writer.skill("locate", locate)
    take = """bool is_there = state.x == state.at_x && state.y == state.at_y;
__reward = is_there ? -0.2 : -2;
state__.charge = state.charge - 1;
if (is_there) state__.has_photo = true;
__moduleResponse = is_there ? taken : missed;"""
    writer.skill("take", take)
    writer.skill("land", "state__.has_landed = true;\n__moduleResponse = landed;")
    return writer.files


class Photo(World):
    """The drone as the documents describe it."""

    def __init__(self, size: int, rng: random.Random):
        super().__init__(rng, _DISCOUNT, fly=4, look=1, locate=1, take=1, land=1)
        self.size, self.charge, self.has_photo = size, _CHARGE, False
        self.x = self.y = 0
        self.at = (rng.randrange(size), rng.randrange(size))

    def act(self, skill: str, value: int = 0) -> str:
        if skill == "land":
            self.has_ended = True
            is_home = self.x == 0 and self.y == 0
            self.gain((60.0 if self.has_photo else 0.0) if is_home else -15.0)
            return "landed"
        told, reward = "", -0.2
        self.charge -= 1
        if skill == "fly":
            is_blown = self.rng.random() < _WIND
            self.x = max(0, min(self.x + (value == 1) - (value == 3) + is_blown, self.size - 1))
            self.y = max(0, min(self.y + (value == 0) - (value == 2), self.size - 1))
            told = "blown" if (self.rng.random() < _FELT) == is_blown else "calm"
        elif skill == "look":
            distance = max(abs(self.x - self.at[0]), abs(self.y - self.at[1]))
            is_seen = self.rng.random() < _SEEN and distance <= 2
            told = "unseen" if not is_seen else "below" if distance == 0 else "near"
        elif skill == "locate":
            told = "west" if self.x < 4 else "middle" if self.x < 8 else "east"
        else:
            is_there = (self.x, self.y) == self.at
            self.has_photo = self.has_photo or is_there
            reward, told = (-0.2, "taken") if is_there else (-2.0, "missed")
        if self.charge <= 0:
            self.has_ended = True
            reward += -20.0
        self.gain(reward)
        return told


class _Track:
    """Odds of the drone's column and of the cell, as the rule knows them, and the cells of its sweep."""

    def __init__(self, size: int):
        self.size = size
        self.odds = np.zeros((size, size, size))  # x of the drone, x and y of the cell
        self.odds[0] = 1 / size**2
        rows = [range(1, size, 3), range(size - 2, 0, -3), range(1, size, 3)]
        self.ways = [(x, y) for y, row in zip((1, 5, 9), rows, strict=True) for x in row]

    def fly(self, east: int, told: str):
        after = np.zeros_like(self.odds)
        for x in range(self.size):
            for is_blown in (False, True):
                odds = (_WIND if is_blown else 1 - _WIND) * (
                    _FELT if is_blown == (told == "blown") else 1 - _FELT
                )
                after[max(0, min(x + east + is_blown, self.size - 1))] += odds * self.odds[x]
        self.odds = after / after.sum()

    def weigh(self, likelihood: np.ndarray):
        self.odds *= likelihood
        self.odds /= self.odds.sum()

    def distance(self, y: int) -> np.ndarray:
        places = np.arange(self.size)
        across = abs(places[:, None, None] - places[None, :, None])
        return np.maximum(across, abs(places - y)[None, None, :])

    @property
    def column(self) -> int:
        return int(self.odds.sum(axis=(1, 2)).argmax())


def photo_rule(size: int, rng: random.Random) -> float:
    """Sweeps in rows, looks in every third cell, goes where it saw something, and is home in time."""
    world, track = Photo(size, rng), _Track(size)
    while not world.is_over:
        x, y = track.column, world.y
        if world.has_photo or world.charge <= 1.3 * x + y + 6:
            _go_home(world, track)
        elif float((track.odds * (track.distance(y) == 0)).sum()) > 0.3:
            is_there = track.distance(y) == 0
            told = world.act("take")
            track.weigh((is_there if told == "taken" else ~is_there) + 1e-12)
        else:
            _search(world, track)
    return world.earned


def _go_home(world: Photo, track: _Track):
    if world.y == 0 and track.odds[0].sum() > 0.85:
        world.act("land")
    else:
        _fly(world, track, 2 if world.y > 0 and track.column == 0 else 3)


def _search(world: Photo, track: _Track):
    x, y = track.column, world.y
    there = track.odds.sum(axis=0)
    best = np.unravel_index(there.argmax(), there.shape)
    is_sweep = there.max() <= 0.03 and len(track.ways) > 0
    goal_x, goal_y = track.ways[0] if is_sweep else (int(best[0]), int(best[1]))
    if (x, y) != (goal_x, goal_y):
        across = 1 if goal_x > x else 3
        _fly(world, track, across if goal_x != x else 0 if goal_y > y else 2)
        return
    if is_sweep:
        track.ways.pop(0)
    told = world.act("look")
    distance = track.distance(y)
    seen = _SEEN * np.where(distance == 0, told == "below", (told == "near") & (distance <= 2))
    track.weigh(seen if told != "unseen" else np.where(distance <= 2, 1 - _SEEN, 1))


def _fly(world: Photo, track: _Track, way: int):
    track.fly((way == 1) - (way == 3), world.act("fly", way))
