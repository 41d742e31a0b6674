"""Rules by hand for the problems, played in simulations of their own, which share nothing with the engine."""

import random

import numpy as np


def parcels(count: int, rng: random.Random) -> float:
    """Scan a parcel until one place has 0.85 of the belief, and send it there."""
    earned, discount = 0.0, 1.0
    for parcel in range(count):
        place = rng.choices(range(3), (0.5, 0.3, 0.2))[0]
        odds = [0.5, 0.3, 0.2]
        while max(odds) < 0.85:
            seen = place if rng.random() < 0.7 else (place + rng.choice((1, 2))) % 3
            odds = [p * (0.7 if i == seen else 0.15) for i, p in enumerate(odds)]
            odds = [p / sum(odds) for p in odds]
            earned -= 0.4 * discount
            discount *= 0.97
        earned += discount * ((6 if odds[place] == max(odds) else -8) + (5 if parcel == count - 1 else 0))
        discount *= 0.97
    return earned


def clutter(count: int, rng: random.Random) -> float:
    """Look at one spot after the other, lift covers, look twice, pick where the belief is above 0.6."""
    place = rng.randrange(count)
    covered = [rng.random() < 0.4 for _ in range(count)]
    odds = np.full(count, 1 / count)
    unknown = set(range(count))
    earned, discount = 0.0, 1.0

    for _ in range(2 * count + 20):
        best = int(odds.argmax())
        if odds[best] > 0.6 and best not in unknown:
            if best == place:
                return earned + discount * 60
            reward, odds[best] = -10.0, 0.0
            odds /= odds.sum()
        else:
            spot = max(range(count), key=lambda i: (odds[i], -i))
            if covered[spot] and spot not in unknown:
                covered[spot], reward = False, -1.0
            else:
                reward = -0.5
                unknown.discard(spot)
                if not covered[spot]:
                    sees = rng.random() < (0.9 if spot == place else 0.03)
                    odds[spot] *= 0.9 / 0.03 if sees else 0.1 / 0.97
                    odds /= odds.sum()
        earned += discount * reward
        discount *= 0.985
    return earned


def open_field(light: int, rng: random.Random) -> float:
    """Go north to the light, measure until the place is known within 0.3, go to the goal and stop."""
    at = np.array([rng.uniform(0, 4), rng.uniform(0, 4)])
    draws = np.random.default_rng(rng.randrange(2**32))
    cloud = draws.uniform(0, 4, (4000, 2))
    moves = np.array([[0, 1], [1, 0], [0, -1], [-1, 0]])
    discount, is_sure = 1.0, False
    for _ in range(59):
        mean, spread = cloud.mean(0), cloud.std(0).max()
        is_sure = is_sure or (spread < 0.35 and mean[1] > light - 2.5)
        goal = np.array([9.0, 1.0]) if is_sure else np.array([mean[0] + (1 if mean[0] < 8.5 else 0), light])
        gap = goal - mean
        if is_sure and np.abs(gap).max() < 0.55:
            break
        axis = int(np.abs(gap)[1] < np.abs(gap)[0]) if is_sure or mean[1] > light - 1.5 else 0
        move = (0 if gap[1] > 0 else 2) if axis == 0 else (1 if gap[0] > 0 else 3)
        at = at + moves[move] + draws.normal(0, 0.1, 2)
        cloud = cloud + moves[move] + draws.normal(0, 0.1, cloud.shape)
        seen = draws.normal(at, 0.3 + 0.5 * abs(light - at[1]))
        deviation = 0.3 + 0.5 * np.abs(light - cloud[:, 1])
        logs = -0.5 * (((cloud - seen) / deviation[:, None]) ** 2).sum(1) - 2 * np.log(deviation)
        weights = np.exp(logs - logs.max())
        cloud = cloud[draws.choice(len(cloud), len(cloud), p=weights / weights.sum())] + draws.normal(
            0, 0.02, cloud.shape
        )
        discount *= 0.97
    return discount * (100 if (at[0] - 9) ** 2 + (at[1] - 1) ** 2 < 1 else -100)
