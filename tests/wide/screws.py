"""A robot that drives screws with unknown heads by tools that wear: documents and a rule."""

import random

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

_HEADS = (0.5, 0.3, 0.2)  # of a screw
_CHANGES, _TRUE = 0.9, 0.8
_DRIVES, _WORN_DRIVES, _STRIPS, _WEARS = 0.8, 0.3, 0.3, 0.05
_DISCOUNT = 0.98
_ENDED = {0: "slips", 1: "driven", 2: "stripped"}


def _environment(count: int) -> str:
    return f"""horizon: 80
discount: {_DISCOUNT}

state_variable: int head []
code:
state.head.assign({count}, 0);

state_variable: int end []
code:
state.end.assign({count}, 0);

state_variable: int tool

state_variable: bool is_worn

state_variable: bool is_finished

initial_belief:
for (int i = 0; i < {count}; i++) state.head[i] = AOSUtils::SampleDiscrete(vector<double>{{0.5, 0.3, 0.2}});

reward_code:
if (state.is_finished) {{
    __isGoalState = true;
    __reward = 10;
    for (int i = 0; i < {count}; i++) __reward -= state.end[i] == 1 ? 0 : 3;
}}
"""


def screws(count: int = 10) -> Bundle:
    """Heads are told by noisy looks or sure probes; a tool change takes time, and the wrong tool strips."""
    writer = BundleWriter(f"screws{count}", _environment(count))
    one = {"screw": str(count)}
    heads = ["slot", "cross", "star"]
    told = "__moduleResponse = {0} == 0 ? slot : {0} == 1 ? cross : star;"
    look = f"""__reward = -0.3;
int seen = state.head[screw];
if (!AOS.Bernoulli({_TRUE})) seen = (seen + 1 + AOSUtils::SampleDiscrete(vector<double>{{0.5, 0.5}})) % 3;
"""
    writer.skill("look", heads, look + told.format("seen"), over=one)
    writer.skill("probe", heads, "__reward = -1.5;\n" + told.format("state.head[screw]"), over=one)
    change = f"""__reward = -1;
if (AOS.Bernoulli({_CHANGES})) {{
    state__.tool = wanted;
    state__.is_worn = false;
    __moduleResponse = changed;
}} else {{
    __moduleResponse = jammed;
}}"""
    writer.skill("change", ["changed", "jammed"], change, over={"wanted": "3"})
    drive = f"""__reward = -0.2;
if (AOS.Bernoulli({_WEARS})) state__.is_worn = true;
__moduleResponse = slips;
if (state.end[screw] == 0) {{
    if (state.tool == state.head[screw]) {{
        if (AOS.Bernoulli(state.is_worn ? {_WORN_DRIVES} : {_DRIVES})) {{
            state__.end[screw] = 1;
            __reward = 3.8;
            __moduleResponse = driven;
        }}
    }} else if (AOS.Bernoulli({_STRIPS})) {{
        state__.end[screw] = 2;
        __reward = -3.2;
        __moduleResponse = stripped;
    }}
}}"""
    writer.skill("drive", ["slips", "driven", "stripped"], drive, over=one)
    writer.skill("finish", ["finished"], "state__.is_finished = true;\n__moduleResponse = finished;")
    return writer.files


class Screws(World):
    """The panel as the documents describe it."""

    discount = _DISCOUNT

    def __init__(self, count: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.heads = rng.choices(range(3), _HEADS, k=count)
        self.ends = [0] * count
        self.tool, self.is_worn = 0, False

    def actions(self) -> list[tuple[str, int]]:
        on_screws = [(skill, i) for skill in ("look", "probe", "drive") for i in range(len(self.heads))]
        return [*on_screws, *(("change", tool) for tool in range(3)), ("finish", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        told = ""
        if skill == "finish":
            self.has_ended = True
            self.gain(10 - 3 * sum(end != 1 for end in self.ends))
        elif skill == "change":
            if self.rng.random() < _CHANGES:
                self.tool, self.is_worn, told = value, False, "changed"
            self.gain(-1)
        elif skill == "drive":
            told = self._drive(value)
        else:
            seen = self.heads[value]
            if skill == "look" and self.rng.random() >= _TRUE:
                seen = (seen + self.rng.randrange(1, 3)) % 3
            told = str(seen)
            self.gain(-0.3 if skill == "look" else -1.5)
        return told

    def _drive(self, screw: int) -> str:
        fits = self.tool == self.heads[screw]
        probability = (_WORN_DRIVES if self.is_worn else _DRIVES) if fits else _STRIPS
        self.is_worn = self.is_worn or self.rng.random() < _WEARS
        if self.ends[screw] != 0 or self.rng.random() >= probability:
            self.gain(-0.2)
            return "slips"
        self.ends[screw] = 1 if fits else 2
        self.gain(3.8 if fits else -3.2)
        return _ENDED[self.ends[screw]]


def screws_rule(count: int, rng: random.Random) -> float:
    """Looks at all screws up to 0.85, then drives tool by tool, and probes one that slipped three times."""
    world = Screws(count, rng)
    odds = np.tile(np.array(_HEADS), (count, 1))
    for screw in range(count):
        while odds[screw].max() < 0.85 and not world.is_over:
            seen = int(world.act("look", screw))
            odds[screw] *= np.where(np.arange(3) == seen, _TRUE, (1 - _TRUE) / 2)
            odds[screw] /= odds[screw].sum()
    slipped = 0
    for tool in range(3):
        while world.tool != tool and any(odds[screw].argmax() == tool for screw in range(count)):
            if world.is_over:
                return world.earned
            world.act("change", tool)
        for screw in range(count):
            while odds[screw].argmax() == tool and world.ends[screw] == 0 and not world.is_over:
                if slipped >= 3:
                    odds[screw] = np.eye(3)[int(world.act("probe", screw))]
                    slipped = 0
                    while odds[screw].argmax() == tool and world.act("change", tool) != "changed":
                        if world.is_over:
                            return world.earned
                    continue
                slipped = slipped + 1 if world.act("drive", screw) == "slips" else 0
            slipped = 0
    if not world.is_over:
        world.act("finish")
    return world.earned
