"""A lock of dials that opens when all of them are right, with a noisy probe of each: documents and a rule."""

import random

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

_DIGITS = 6
_TRUE = 0.8
_DISCOUNT = 0.98


def _environment(count: int) -> str:
    return f"""horizon: 60
discount: {_DISCOUNT}

state_variable: int digit []
code:
state.digit.assign({count}, 0);

state_variable: int dial []
code:
state.dial.assign({count}, 0);

state_variable: bool is_open

initial_belief:
vector<double> odds({_DIGITS}, 1.0);
for (int i = 0; i < {count}; i++) state.digit[i] = AOSUtils::SampleDiscrete(odds);

reward_code:
if (state.is_open) __isGoalState = true;
"""


def lock(count: int = 5) -> Bundle:
    """Dials are turned and probed one by one; a pull opens the lock, or costs."""
    writer = BundleWriter(f"lock{count}", _environment(count))
    one = {"which": str(count)}
    turn = f"""__reward = -0.2;
state__.dial[which] = (state.dial[which] + (up == 1 ? 1 : {_DIGITS - 1})) % {_DIGITS};
__moduleResponse = turned;"""
    writer.skill("turn", turn, over=one | {"up": "2"})
    probe = f"""__reward = -0.3;
int told = state.dial[which] < state.digit[which] ? 0 : state.dial[which] == state.digit[which] ? 1 : 2;
if (!AOS.Bernoulli({_TRUE})) told = (told + 1 + AOSUtils::SampleDiscrete(vector<double>{{0.5, 0.5}})) % 3;
__moduleResponse = told == 0 ? below : told == 1 ? right : above;"""
    writer.skill("probe", probe, over=one)
    pull = f"""int right = 0;
for (int i = 0; i < {count}; i++) right += state.dial[i] == state.digit[i];
if (right == {count}) {{
    __reward = 60;
    state__.is_open = true;
    __moduleResponse = opened;
}} else {{
    __reward = -5;
    __moduleResponse = stuck;
}}"""
    writer.skill("pull", pull)
    return writer.files


class Lock(World):
    """The lock as the documents describe it; a turn has the value `2 * dial + up`."""

    def __init__(self, count: int, rng: random.Random):
        super().__init__(rng, _DISCOUNT, turn=2 * count, probe=count, pull=1)
        self.digits = [rng.randrange(_DIGITS) for _ in range(count)]
        self.dials = [0] * count

    def act(self, skill: str, value: int = 0) -> str:
        if skill == "turn":
            self.dials[value // 2] = (self.dials[value // 2] + (1 if value % 2 else -1)) % _DIGITS
            self.gain(-0.2)
        elif skill == "probe":
            gap = self.digits[value] - self.dials[value]
            told = 0 if gap > 0 else 1 if gap == 0 else 2
            if self.rng.random() >= _TRUE:
                told = (told + self.rng.randrange(1, 3)) % 3
            self.gain(-0.3)
            return str(told)
        else:
            self.has_ended = self.dials == self.digits
            self.gain(60 if self.has_ended else -5)
        return ""


def lock_rule(count: int, rng: random.Random) -> float:
    world = Lock(count, rng)
    odds = np.full((count, _DIGITS), 1 / _DIGITS)
    digits = np.arange(_DIGITS)
    while not world.is_over:
        for which in range(count):
            while odds[which].max() < 0.95 and not world.is_over:
                _turn(world, which, int(np.searchsorted(odds[which].cumsum(), 0.5)))
                expected = np.sign(world.dials[which] - digits) + 1
                told = int(world.act("probe", which))
                odds[which] *= np.where(expected == told, _TRUE, (1 - _TRUE) / 2)
                odds[which] /= odds[which].sum()
            _turn(world, which, int(odds[which].argmax()))
        if not world.is_over:
            world.act("pull")
        odds = (odds + 0.1) / (odds + 0.1).sum(1, keepdims=True)
    return world.earned


def _turn(world: Lock, which: int, digit: int):
    up = (digit - world.dials[which]) % _DIGITS <= _DIGITS // 2
    while world.dials[which] != digit and not world.is_over:
        world.act("turn", 2 * which + up)
