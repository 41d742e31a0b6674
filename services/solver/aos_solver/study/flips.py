"""The belief at which a choice changes: the probability of one value is moved until another action is better.

Between two beliefs that differ by Jeffrey's rule lies a line, and the value of each way of deciding is linear
along it. So the margin of two actions is continuous, and where it changes its sign the choice changes.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Awaitable, Callable, Iterator, Sequence

from aos_protocol.messages import BeliefSummary, Flip
from aos_solver.child.engine import Engine
from aos_solver.study.valuing import Margin, Valuing

__all__ = ["doubtful_values", "flip_between", "flips_of", "is_lost"]

_PRECISION = 2e-4
_PARTS = 4
"""So many parts of the line are looked at before the nearest change is halved in."""
_REFINEMENTS = 2
_MOST_VALUES = 6
_CERTAIN = 1e-9
_TIE = 1e-9

MarginAt = Callable[[float], Awaitable[Margin]]


def doubtful_values(belief: BeliefSummary) -> Iterator[tuple[str, str, float]]:
    """The values that are neither certain nor excluded, those of the most doubtful variables first.

    Of a variable with two values one is told: to move the other is the same. Of a number that has quantiles
    none is told: no value of it has a probability worth moving.
    """
    doubts = []
    for marginal in belief.marginals:
        if marginal.quantiles:
            continue
        open_ = {v: p for v, p in marginal.values.items() if _CERTAIN < p < 1 - _CERTAIN}
        entropy = -sum(p * math.log(p) for p in open_.values())
        if entropy > 0:
            told = list(open_)[: 1 if len(open_) == 2 and not marginal.others else 2]
            doubts.append((entropy, marginal.variable, [(value, open_[value]) for value in told]))
    doubts.sort(key=lambda doubt: (-doubt[0], doubt[1]))
    for _, variable, values in doubts:
        for value, probability in values:
            yield variable, value, probability


async def flips_of(
    engine: Engine,
    valuing: Valuing,
    belief: BeliefSummary,
    actions: tuple[str, str],
    margin: Margin,
    until_s: float,
) -> tuple[Flip, ...]:
    """The changes from the first action to the second, the nearest first; the `margin` is that of now.

    The engine's belief was put aside. Exact values are computed until the monotonic time `until_s`; of
    searched ones the most doubtful value alone is moved.
    """
    found = []
    for variable, value, now in list(doubtful_values(belief))[: _MOST_VALUES if valuing.is_exact else 1]:
        if time.monotonic() > until_s:
            break

        async def margin_at(p: float, variable: str = variable, value: str = value) -> Margin:
            await engine.believe(variable, value, p, from_aside=True, cautious=valuing.within.cautious)
            values = await valuing.values(engine, share=valuing.share, anywhere=True)
            return Margin.of(values[actions[0]], values[actions[1]])

        if valuing.is_exact:
            between = await flip_between(margin_at, now)
        else:
            between = await _sampled_flip(margin_at, now, margin)
        if between is not None:
            found.append(Flip(variable, value, now, *between))
    return tuple(sorted(found, key=lambda flip: abs((flip.low + flip.high) / 2 - flip.now)))


def is_lost(margin: float) -> bool:
    """Says whether the other action is better by an exact margin; rounding decides no tie."""
    return margin < -_TIE


async def flip_between(margin_at: MarginAt, now: float) -> tuple[float, float, bool] | None:
    """The two probabilities nearest to `now` between which the margin changes its sign, at both of which it
    was computed; None where it does not, as far as a few looks tell."""
    here = (await margin_at(now)).value
    brackets = []
    for end in (0.0, 1.0):
        near, sign = now, here
        for part in range(1, _PARTS + 1):
            far = now + (end - now) * part / _PARTS
            value = (await margin_at(far)).value
            if is_lost(value) != is_lost(sign):
                brackets.append((abs(near - now), near, far, is_lost(sign)))
                break
            near, sign = far, value
    if not brackets:
        return None
    _, near, far, is_negative = min(brackets)
    while abs(far - near) > _PRECISION:
        middle = (near + far) / 2
        if is_lost((await margin_at(middle)).value) == is_negative:
            near = middle
        else:
            far = middle
    return min(near, far), max(near, far), True


async def _sampled_flip(margin_at: MarginAt, now: float, here: Margin) -> tuple[float, float, bool] | None:
    """The interval, within two standard errors, in which the margin changes its sign nearest to `now`.

    None where it does not for certain: then it may not at all.
    """
    if here.is_close:
        return None
    sign = 1.0 if here.value >= 0 else -1.0
    for end in sorted((0.0, 1.0), key=lambda end: abs(end - now)):
        there = await margin_at(end)
        if sign * there.value >= 0 or there.is_close:
            continue
        points = [(now, here), (end, there)]
        for _ in range(_REFINEMENTS):
            middle = _crossing([(p, sign * m.value) for p, m in points])
            if middle is None or any(middle == p for p, _ in points):
                break
            points.append((middle, await margin_at(middle)))
            points.sort(key=lambda point: abs(point[0] - now))
        surely = [(p, sign * m.value - 2 * m.stderr) for p, m in points]
        hardly = [(p, sign * m.value + 2 * m.stderr) for p, m in points]
        near, far = _crossing(surely), _crossing(hardly)
        assert near is not None
        assert far is not None
        return min(near, far), max(near, far), True
    return None


def _crossing(points: Sequence[tuple[float, float]]) -> float | None:
    """The place at which values between points change their sign first, by straight lines."""
    for (left, low), (right, high) in itertools.pairwise(points):
        if (low < 0) != (high < 0):
            return left + (right - left) * low / (low - high)
    return None
