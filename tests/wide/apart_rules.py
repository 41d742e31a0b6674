"""Rules by hand for the problems apart, played without the engine."""

import random
from collections.abc import Callable

import numpy as np

from .delivery import delivery_rule
from .world import MOST_STEPS


def plant(count: int, rng: random.Random) -> float:
    """Listen to a machine until one fault has 0.75 of the belief, mend it by that, and start at the end."""
    earned, discount, loss = 0.0, 1.0, 0.0
    for _ in range(count):
        fault = rng.choices(range(3), (0.6, 0.25, 0.15))[0]
        odds = np.array([0.6, 0.25, 0.15])
        while odds.max() < 0.75:
            heard = fault if rng.random() < 0.65 else (fault + rng.choice((1, 2))) % 3
            odds = odds * np.where(np.arange(3) == heard, 0.65, 0.175)
            odds /= odds.sum()
            earned -= 0.2 * discount
            discount *= 0.995
        believed = int(odds.argmax())
        if believed > 0:
            earned -= (1 if believed == 1 else 5) * discount
            discount *= 0.995
            fault = 0 if believed == 2 or fault == 1 else fault
        loss += (0, 4, 10)[fault]
    return earned + discount * (60 - loss)


def drone(size: int, rng: random.Random) -> float:
    """Measure until the place is known within 0.8, fly to the pad, land where 0.85 of the belief is."""
    draws = np.random.default_rng(rng.randrange(2**32))
    beacons = np.array([[0, 0], [size, 0], [0, size]], float)
    moves = np.array([[0, 1], [1, 0], [0, -1], [-1, 0]], float)
    pad = np.array([size // 2, size // 2], float)
    at, wind = draws.uniform(0, size, 2), draws.normal(0, 0.3, 2)
    cloud, winds = draws.uniform(0, size, (20_000, 2)), draws.normal(0, 0.3, (20_000, 2))
    earned, discount = 0.0, 1.0
    for turn in range(49):
        if (((cloud - pad) ** 2).sum(1) < 1.44).mean() > 0.85:
            return earned + discount * (60 if ((at - pad) ** 2).sum() < 1.44 else -60)
        gap = pad - cloud.mean(0) - winds.mean(0)
        is_measuring = cloud.std(0).max() > 0.8 or np.abs(gap).max() < 0.5
        at = at + wind + draws.normal(0, 0.1, 2)
        cloud = cloud + winds + draws.normal(0, 0.1, cloud.shape)
        if is_measuring:
            beacon = beacons[turn % 3]
            metres = float(np.hypot(*(at - beacon))) + draws.normal(0, 0.3)
            logs = -0.5 * ((np.hypot(*(cloud - beacon).T) - metres) / 0.3) ** 2
            weights = np.exp(logs - logs.max())
            chosen = draws.choice(len(cloud), len(cloud), p=weights / weights.sum())
            cloud = cloud[chosen] + draws.normal(0, 0.02, cloud.shape)
            winds = winds[chosen] + draws.normal(0, 0.01, cloud.shape)
            earned -= 0.2 * discount
        else:
            axis = int(np.abs(gap)[1] < np.abs(gap)[0])
            move = moves[(0 if gap[1] > 0 else 2) if axis == 0 else (1 if gap[0] > 0 else 3)]
            at, cloud = at + move, cloud + move
            earned -= 0.5 * discount
        discount *= 0.98
    return earned


def courier(addresses: int, rng: random.Random) -> float:
    """Go to the next address, ring twice at most, and hand over at once where steps are heard."""
    home = [rng.random() < 0.5 for _ in range(addresses + 1)]
    served = [False] * (addresses + 1)
    at, charge, rung, heard = 0, 30, 0, False
    earned, discount = 0.0, 1.0
    for _ in range(60):
        waiting = [place for place in range(1, addresses + 1) if not served[place]]
        before = list(home)
        if heard:
            if before[at]:
                served[at], reward = True, 10.0
            else:
                reward = -4.0
            heard, rung = False, 2
        elif at in waiting and rung < 2:
            heard = rng.random() < (0.9 if before[at] else 0.1)
            reward, rung = -0.2, rung + 1
        else:
            following = [place for place in waiting if place > at]
            place = following[0] if following and charge > 2 * addresses + 2 else 0 if at > 0 else waiting[0]
            way = abs(place - at) + 1
            at, charge, rung, reward = place, 30 if place == 0 else charge - way, 0, -0.3 * way
        home = [is_home != (rng.random() < 0.04) for is_home in home]
        if all(served[1:]):
            return earned + discount * (reward + 10)
        earned += discount * reward
        discount *= 0.98
    return earned


def arms(count: int, rng: random.Random) -> float:
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


APART_RULES: dict[str, Callable[[int, random.Random], float]] = {
    "plant": plant,
    "drone": drone,
    "courier": courier,
    "arms": arms,
    "delivery": delivery_rule,
}
