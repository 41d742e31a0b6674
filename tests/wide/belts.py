"""A robot that takes parts from moving belts before they are lost, and sorts them: documents and a rule."""

import random

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

__all__ = ["Belts", "belts", "belts_rule"]

_LENGTH = 5  # slots of a belt; parts are seen in slot 2 and taken from slot 3
_SEEN, _TAKEN = 2, 3
_KINDS = (0.65, 0.14, 0.13, 0.08)  # of what comes: nothing, a bolt, a nut, scrap
_TRUE, _GRASPS = 0.85, 0.9
_DISCOUNT = 0.97


def _environment(count: int) -> str:
    slots = count * _LENGTH
    kinds = ", ".join(str(share) for share in _KINDS)
    return f"""horizon: 40
discount: {_DISCOUNT}

state_variable: int kind []
code:
state.kind.assign({slots}, 0);

state_variable: int hand

state_variable: bool moves_next

initial_belief:
for (int i = 0; i < {slots}; i++) state.kind[i] = AOS.SampleDiscrete({{{kinds}}});

extrinsic_code:
state_.moves_next = !state.moves_next;
if (state.moves_next) {{
    for (int b = 0; b < {count}; b++) {{
        int first = b * {_LENGTH};
        for (int i = first + {_LENGTH} - 1; i > first; i--) state_.kind[i] = state.kind[i - 1];
        state_.kind[first] = AOS.SampleDiscrete({{{kinds}}});
    }}
}}

reward_code:
// What arrives in the last slot is lost, as long as it lies there.
for (int b = 0; b < {count}; b++) {{
    int last = state.kind[b * {_LENGTH} + {_LENGTH - 1}];
    if (last == 1 || last == 2) __reward -= 0.5;
}}
"""


def belts(count: int = 3) -> Bundle:
    """Belts bring bolts, nuts and scrap; a camera is noisy, a feeler is sure and slow, and time presses."""
    writer = BundleWriter(f"belts{count}", _environment(count))
    belt = {"belt": str(count)}
    look = f"""__reward = -0.1;
int seen = state_.kind[belt * {_LENGTH} + {_SEEN}];
if (!AOS.Bernoulli({_TRUE})) seen = (seen + 1 + AOSUtils::SampleDiscrete(vector<double>(3, 1.0))) % 4;
__moduleResponse = seen == 0 ? nothing : seen == 1 ? bolt : seen == 2 ? nut : scrap;"""
    kinds = ["nothing", "bolt", "nut", "scrap"]
    writer.skill("look", kinds, look, over=belt)
    grab = f"""__reward = -0.2;
int slot = belt * {_LENGTH} + {_TAKEN};
if (state_.hand == 0 && state_.kind[slot] > 0 && AOS.Bernoulli({_GRASPS})) {{
    state__.hand = state_.kind[slot];
    state__.kind[slot] = 0;
    __moduleResponse = taken;
}} else {{
    __moduleResponse = missed;
}}"""
    writer.skill("grab", ["taken", "missed"], grab, over=belt)
    feel = """__reward = -1;
__moduleResponse = state_.hand == 0 ? nothing : state_.hand == 1 ? bolt : state_.hand == 2 ? nut : scrap;"""
    writer.skill("feel", kinds, feel)
    sort = """if (state_.hand == 0) {
    __reward = -1;
    __moduleResponse = refused;
} else {
    __reward = state_.hand != box + 1 ? -5 : box == 2 ? 1 : 5;
    state__.hand = 0;
    __moduleResponse = sorted;
}"""
    writer.skill("sort", ["sorted", "refused"], sort, over={"box": "3"})
    return writer.files


class Belts(World):
    """The belts as the documents describe them."""

    discount = _DISCOUNT

    def __init__(self, count: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.kinds = [rng.choices(range(4), _KINDS, k=_LENGTH) for _ in range(count)]
        self.hand = 0
        self.moves_next = False

    def actions(self) -> list[tuple[str, int]]:
        on_belts = [(skill, belt) for skill in ("look", "grab") for belt in range(len(self.kinds))]
        return [*on_belts, ("feel", 0), *(("sort", box) for box in range(3))]

    def act(self, skill: str, value: int = 0) -> str:
        if self.moves_next:
            self.kinds = [[self.rng.choices(range(4), _KINDS)[0], *kinds[:-1]] for kinds in self.kinds]
        self.moves_next = not self.moves_next
        told, reward = "", 0.0
        if skill == "look":
            seen = self.kinds[value][_SEEN]
            if self.rng.random() >= _TRUE:
                seen = (seen + self.rng.randrange(1, 4)) % 4
            told, reward = str(seen), -0.1
        elif skill == "grab":
            reward = -0.2
            if self.hand == 0 and self.kinds[value][_TAKEN] > 0 and self.rng.random() < _GRASPS:
                self.hand, self.kinds[value][_TAKEN], told = self.kinds[value][_TAKEN], 0, "taken"
        elif skill == "feel":
            told, reward = str(self.hand), -1.0
        else:
            right = 1.0 if value == 2 else 5.0
            reward = -1.0 if self.hand == 0 else right if self.hand == value + 1 else -5.0
            self.hand = 0
        self.gain(reward - 0.5 * sum(kinds[-1] in (1, 2) for kinds in self.kinds))
        return told


def belts_rule(count: int, rng: random.Random) -> float:
    """Looks at the belt known least, grabs what is a part by 0.6, feels it below 0.75, and sorts it."""
    world = Belts(count, rng)
    odds = np.tile(np.array(_KINDS), (count, _LENGTH, 1))
    hand: np.ndarray | None = None
    while not world.is_over:
        if world.moves_next:
            odds = np.concatenate([np.tile(np.array(_KINDS), (count, 1, 1)), odds[:, :-1]], axis=1)
        parts = odds[:, _TAKEN, 1] + odds[:, _TAKEN, 2]
        belt = int(parts.argmax())
        if hand is not None and hand.max() < 0.75:
            hand = np.eye(4)[int(world.act("feel"))]
        elif hand is not None:
            world.act("sort", int(hand[1:].argmax()))
            hand = None
        elif parts[belt] > 0.6:
            slot = odds[belt, _TAKEN].copy()
            missed = slot * np.array([1, 1 - _GRASPS, 1 - _GRASPS, 1 - _GRASPS])
            if world.act("grab", belt) == "taken":
                slot[0] = 0
                hand, odds[belt, _TAKEN] = slot / slot.sum(), np.eye(4)[0]
            else:
                odds[belt, _TAKEN] = missed / missed.sum()
        else:
            belt = int(np.argmin(odds[:, _SEEN].max(axis=1)))
            seen = int(world.act("look", belt))
            odds[belt, _SEEN] *= np.where(np.arange(4) == seen, _TRUE, (1 - _TRUE) / 3)
            odds[belt, _SEEN] /= odds[belt, _SEEN].sum()
    return world.earned
