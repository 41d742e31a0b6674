import random

from .world import MOST_STEPS
from .writing import Bundle, BundleWriter


def _arms_environment(count: int) -> str:
    return f"""horizon: 80
discount: 0.98

state_variable: bool good []
code:
state.good.assign({2 * count}, false);

state_variable: bool gone []
code:
state.gone.assign({2 * count}, false);

state_variable: int held []
code:
state.held.assign(2, -1);

state_variable: int joined

initial_belief:
for (int i = 0; i < {2 * count}; i++) state.good[i] = AOS.Bernoulli(0.6);

reward_code:
if (state.joined >= 4) {{
    __isGoalState = true;
    __reward = 20;
}}
"""


def arms(count: int = 8) -> Bundle:
    """Two arms with bolts and plates, good or bad: pick, inspect, put away, and join two good ones."""
    writer = BundleWriter(f"arms{count}", _arms_environment(count))
    arm = {"arm": "2"}
    pick = f"""__reward = -0.5;
int which = arm * {count} + part;
if (state.held[arm] >= 0 || state.gone[which]) {{
    __moduleResponse = refused;
}} else {{
    state__.held[arm] = which;
    state__.gone[which] = true;
    __moduleResponse = picked;
}}"""
    writer.skill("pick", pick, over=arm | {"part": str(count)})
    inspect = """__reward = -0.3;
if (state.held[arm] < 0) {
    __moduleResponse = empty;
} else {
    __moduleResponse = AOS.Bernoulli(state.good[state.held[arm]] ? 0.85 : 0.2) ? looks_good : looks_bad;
}"""
    writer.skill("inspect", inspect, over=arm)
    put = "__reward = -0.5;\nstate__.held[arm] = -1;\n__moduleResponse = done;"
    writer.skill("put_away", put, over=arm)
    join = """if (state.held[0] < 0 || state.held[1] < 0) {
    __reward = -2;
    __moduleResponse = nothing;
} else if (state.good[state.held[0]] && state.good[state.held[1]]) {
    __reward = 10;
    state__.joined = state.joined + 1;
    state__.held[0] = -1;
    state__.held[1] = -1;
    __moduleResponse = holds;
} else {
    __reward = -10;
    state__.held[0] = -1;
    state__.held[1] = -1;
    __moduleResponse = broke;
}"""
    writer.skill("join", join)
    return writer.files


def arms_rule(count: int, rng: random.Random) -> float:
    """Each arm inspects until its part is good with 0.9, or bad with 0.8; two good ones are joined."""
    left = [count, count]
    held: list[bool | None] = [None, None]
    odds = [0.6, 0.6]
    earned, discount, joined = 0.0, 1.0, 0
    for _ in range(MOST_STEPS):
        arm = next((i for i in (0, 1) if held[i] is None or odds[i] < 0.9), None)
        if arm is None:
            is_good = bool(held[0] and held[1])
            joined += is_good
            reward, held = (10.0 if is_good else -10.0), [None, None]
            if joined == 4:
                return earned + discount * 30
        elif held[arm] is None:
            if left[arm] == 0:
                reward = -0.3  # nothing is left to do, and no action is free
            else:
                left[arm] -= 1
                held[arm], odds[arm], reward = rng.random() < 0.6, 0.6, -0.5
        elif odds[arm] < 0.2:
            held[arm], reward = None, -0.5
        else:
            looks_good = rng.random() < (0.85 if held[arm] else 0.2)
            good, bad = (0.85, 0.2) if looks_good else (0.15, 0.8)
            odds[arm] = odds[arm] * good / (odds[arm] * good + (1 - odds[arm]) * bad)
            reward = -0.3
        earned += discount * reward
        discount *= 0.98
    return earned
