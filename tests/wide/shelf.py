"""A box on one of three shelves that expires; moves and grips fail by thresholds of continuous draws."""

import random

from .writing import Bundle, BundleWriter

_ODDS = (0.5, 0.3, 0.2)
_LOOK = 0.85


def shelf(steps: int = 7) -> Bundle:
    writer = BundleWriter(
        "shelf",
        f"""horizon: 10
discount: 0.95

state_variable: int box

state_variable: int at

state_variable: int left
default_value: {steps}

state_variable: bool has_it

initial_belief:
vector<double> odds{{{", ".join(map(str, _ODDS))}}};
state.box = AOSUtils::SampleDiscrete(odds);

extrinsic_code:
state_.left = state.left - 1;

reward_code:
if (state.has_it) {{
    __reward = 30;
    __isGoalState = true;
}}
if (state.left <= 0) __isFailureState = true;
""",
    )
    go = """__reward = -1;
bool fails = AOS.SampleNormal(0, 1) > 1.0;
if (!fails) state__.at = shelf;
__moduleResponse = fails ? failed : there;"""
    writer.skill("go", go, over={"shelf": "3"})
    look = f"""__reward = -0.5;
bool is_it = state.at == state.box;
__moduleResponse = AOS.Bernoulli({_LOOK}) == is_it ? box_there : no_box;"""
    writer.skill("look", look)
    grab = """bool holds = state.at == state.box && AOS.SampleUniform(0, 1) < 0.8;
__reward = holds ? -1 : -4;
if (holds) state__.has_it = true;
__moduleResponse = holds ? got : missed;"""
    writer.skill("grab", grab)
    return writer.files


def shelf_rule(steps: int, rng: random.Random) -> float:
    box, at, odds = rng.choices(range(3), _ODDS)[0], 0, list(_ODDS)
    earned, discount = 0.0, 1.0
    for _ in range(steps):
        likeliest = max(range(3), key=odds.__getitem__)
        likelihoods, reward = [1.0, 1.0, 1.0], -1.0
        if at != likeliest:
            at = likeliest if rng.gauss(0, 1) <= 1 else at
        elif odds[at] < 0.75:
            seen = (rng.random() < _LOOK) == (at == box)
            likelihoods = [_LOOK if (place == at) == seen else 1 - _LOOK for place in range(3)]
            reward = -0.5
        elif at == box and rng.random() < 0.8:
            return earned + discount * 29
        else:
            likelihoods = [0.2 if place == at else 1.0 for place in range(3)]
            reward = -4.0
        odds = [odd * likelihood for odd, likelihood in zip(odds, likelihoods, strict=True)]
        odds = [odd / sum(odds) for odd in odds]
        earned, discount = earned + discount * reward, discount * 0.95
    return earned
