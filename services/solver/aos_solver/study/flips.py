"""The belief at which a choice changes: the probability of one value is moved until another action is better.

Between two beliefs that differ by Jeffrey's rule lies a line, and the value of each way of deciding is linear
along it. So the margin of two actions is continuous, and where it changes its sign the choice changes.
"""

import itertools
import math
import time
from collections.abc import Awaitable, Callable, Iterator, Sequence

from aos_protocol.messages import BeliefSummary, Flip
from aos_solver.child.engine import Engine
from aos_solver.study.valuing import Margin, Valuing

_PRECISION = 2e-4
_PARTS = 4
"""So many parts of the line are looked at before the nearest change is halved in."""
_MOST_VALUES = 6
_CERTAIN = 1e-9
_TIE = 1e-9
_ERRORS = 2.0
"""A margin that is further from 0 than so many standard errors is certain."""

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
            if valuing.is_exact:
                values = await valuing.values(engine, anywhere=True)
                return Margin.of(values[actions[0]], values[actions[1]])
            one, other = [
                await valuing.alone(engine, action, valuing.share_beside, is_moved=True) for action in actions
            ]
            return Margin.of(one, other)

        if valuing.is_exact:
            between = await flip_between(margin_at, now)
        else:
            beside = [(p, await margin_at(p)) for p in places_beside(now)]
            between = sampled_flip([*beside, (now, margin)], now)
        if between is not None:
            found.append(Flip(variable, value, now, *between))
    return tuple(sorted(found, key=lambda flip: abs((flip.low + flip.high) / 2 - flip.now)))


def places_beside(now: float) -> tuple[float, ...]:
    """The probabilities at which a searched margin is looked at beside that of `now`."""
    return 0.0, now / 2, (1 + now) / 2, 1.0


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


def sampled_flip(places: Sequence[tuple[float, Margin]], now: float) -> tuple[float, float, bool] | None:
    """The interval nearest to `now` in which the choice may change, as far as margins with errors tell.

    A margin is certain where it is further from 0 than two standard errors. Between places, both ends of this
    are taken along straight lines. The last result says whether the choice changes for certain: one action is
    better on one side, and the other one on the other side. None where one action is better at each place.
    """
    places = sorted(places)
    sides = [
        [(p, margin.value + sign * _ERRORS * margin.stderr) for p, margin in places] for sign in (-1.0, 1.0)
    ]
    ends = sorted({p for p, _ in places} | {crossing for side in sides for crossing in _crossings(side)})
    parts: list[tuple[float, float, int]] = []  # with 1 where the margin is above 0, -1 below, 0 uncertain
    for low, high in itertools.pairwise(ends):
        middle = (low + high) / 2
        least, most = (_along(side, middle) for side in sides)
        sign = 1 if least > 0 else -1 if most < 0 else 0
        if parts and parts[-1][2] == sign:
            low = parts.pop()[0]
        parts.append((low, high, sign))
    open_ = [number for number, (_, _, sign) in enumerate(parts) if sign == 0]
    if not open_:
        return None
    nearest = min(open_, key=lambda number: max(parts[number][0] - now, now - parts[number][1], 0.0))
    low, high, _ = parts[nearest]
    around = [sign for _, _, sign in parts[max(nearest - 1, 0) : nearest + 2]]
    return low, high, min(around) < 0 < max(around)


def _crossings(points: Sequence[tuple[float, float]]) -> Iterator[float]:
    """The places at which values between points change their sign, by straight lines."""
    for (left, low), (right, high) in itertools.pairwise(points):
        if (low < 0) != (high < 0):
            yield left + (right - left) * low / (low - high)


def _along(points: Sequence[tuple[float, float]], place: float) -> float:
    """The value at a place between the first point and the last one, by straight lines."""
    (left, low), (right, high) = next(
        pair for pair in itertools.pairwise(points) if pair[0][0] <= place <= pair[1][0]
    )
    return low + (high - low) * (place - left) / (right - left)
