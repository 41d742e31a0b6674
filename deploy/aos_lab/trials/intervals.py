"""Intervals that hold the true value with a probability of 0.95: of a share, and of a mean."""

import math
import statistics
from collections.abc import Sequence

import msgspec

CONFIDENCE = 0.95
_Z = statistics.NormalDist().inv_cdf(0.5 + CONFIDENCE / 2)


class Interval(msgspec.Struct, frozen=True):
    """An estimate between its two ends, which are infinite (null in JSON) where nothing is known of them."""

    value: float
    low: float
    high: float


def interval_of_share(hits: int, trials: int) -> Interval:
    """Wilson's score interval, which stays within 0 and 1 and is not empty at them; 0 to 1 without trials."""
    if not trials:
        return Interval(0.0, 0.0, 1.0)
    share, weight = hits / trials, _Z**2 / trials
    middle = (share + weight / 2) / (1 + weight)
    half = _Z / (1 + weight) * (share * (1 - share) / trials + weight / (4 * trials)) ** 0.5
    return Interval(share, max(0.0, middle - half), min(1.0, middle + half))


def interval_of_mean(values: Sequence[float]) -> Interval | None:
    """Student's interval; None without values. One value says nothing about how far they scatter."""
    if not values:
        return None
    mean = statistics.fmean(values)
    if len(values) == 1:
        return Interval(mean, -math.inf, math.inf)
    half = _student(len(values) - 1) * statistics.stdev(values) / len(values) ** 0.5
    return Interval(mean, mean - half, mean + half)


def _student(degrees: int) -> float:
    """Student's quantile: exact for one and two degrees of freedom, else the normal one's expansion."""
    if degrees == 1:
        return 12.706
    if degrees == 2:
        return 4.303
    z, n = _Z, degrees
    first = (z**3 + z) / 4
    second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + first / n + second / n**2 + third / n**3
