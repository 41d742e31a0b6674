import random

from .problem import Seen

Random = random.Random


def some_discount(random: Random, horizon: int) -> float:
    """Mostly such that what lies at the horizon still counts for something."""
    return random.choice((0.9, 0.95, 0.98, 0.99, 0.999, 1.0, round(0.2 ** (1 / horizon), 4)))


def some_scale(random: Random) -> float:
    return random.choice((0.01, 0.1, 1, 1, 1, 10, 100))


def noisy(right: int, count: int, accuracy: float) -> Seen:
    """`right` with this probability, else any other observation."""
    if count == 1 or accuracy >= 1:
        return right
    return tuple(
        (value, accuracy if value == right else (1 - accuracy) / (count - 1)) for value in range(count)
    )


def moved(place: int, by: int, count: int) -> int:
    return min(max(place + by, 0), count - 1)


def odds_of(random: random.Random, count: int, *, few: int = 0) -> list[float]:
    """A distribution in steps of a hundredth, over `few` of the outcomes where that is given."""
    weights = [0.0] * count
    places = random.sample(range(count), few) if 0 < few < count else range(count)
    for place in places:
        weights[place] = random.expovariate(1)
    total = sum(weights)
    rounded = [round(100 * weight / total) for weight in weights]
    rounded[max(range(count), key=rounded.__getitem__)] += 100 - sum(rounded)
    return [weight / 100 for weight in rounded]
