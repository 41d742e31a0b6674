"""Model against reality: sequential tests of what is seen against what was predicted.

Where the model is right, a response comes at each use with the probability that was predicted for it, given
all that was before. So bets on it at these odds win nothing in the mean, and a wealth that begins with 1 ever
reaches c with a probability of 1/c at most (Ville, 1939). Each response has such a wealth. It is spread over
bets that the odds are others by some factor, from the first use on or from a later one (mixtures of
likelihood ratios: Robbins, 1970). It alarms where it reaches the number of tests divided by FALSE_ALARMS.
"""

import math
from collections.abc import Mapping, Sequence

from msgspec.structs import replace

from aos_protocol.messages import BeliefSummary, DecisionRecord, DriftTest, DriftTests, ModelDrift

FALSE_ALARMS = 0.01
"""The probability, at most, that any test ever alarms where the model is right, all skills together."""

_BETS = {-3.6: 0.08, -1.8: 0.17, -0.9: 0.15, -0.4: 0.1, 0.4: 0.1, 0.9: 0.15, 1.8: 0.17, 3.6: 0.08}
"""The bets, as logarithms of the factor of the odds, each with its share of the wealth."""

_LOG_SHARES = tuple(math.log(share) for share in _BETS.values())

_LATER = 0.2
"""The share of the wealth that is bet from later uses on: for a skill that is right at first."""

_STANDARD_ERRORS = 3.0
"""A probability that was sampled may be wrong by so many standard errors."""

_ENUMERATED_STATES = 10_000
_DRAWN = 5_000
"""Predictions from more states may be drawn, with so many samples: see max_predicted_paths."""


def begun(model_digest: str, responses: Mapping[str, Sequence[str]]) -> DriftTests:
    """The tests of a model: for each skill that has several responses, one of each."""
    several = {skill: names for skill, names in responses.items() if len(names) > 1}
    tests = tuple(DriftTest(skill, name) for skill, names in several.items() for name in names)
    # Of two responses each is the complement of the other: their wealths are one.
    count = sum(1 if len(names) == 2 else len(names) for names in several.values())
    return DriftTests(model_digest, count, tests)


def after_use(tests: DriftTests, decision: DecisionRecord, record: DecisionRecord) -> DriftTests:
    """The tests after a use: of what was predicted at the `decision`, and the `record` of its outcome.

    Nothing is tested where nobody observed anything, where something has stopped the skill, and where the
    decision was for the cautious belief.
    """
    outcome = record.outcome
    if outcome is None or outcome.status != "observed" or outcome.stopped_by or decision.is_cautious:
        return tests
    if decision.model_digest != tests.model_digest:
        return tests
    predicted = {each.response: each.probability for each in decision.predicted}
    after = []
    for test in tests.tests:
        if test.skill != decision.skill:
            after.append(test)
            continue
        probability = min(max(predicted.get(test.response, 0.0), 0.0), 1.0)
        doubt = _doubt(probability, decision.belief)
        after.append(_after(test, outcome.response == test.response, probability, doubt, tests.count))
    return replace(tests, tests=tuple(after))


def drifts(before: DriftTests, after: DriftTests, skill: str) -> tuple[ModelDrift, ...]:
    """The alarms of a skill that stand, after one more use of it."""
    were = {(test.skill, test.response) for test in before.tests if test.is_alarm}
    return tuple(
        ModelDrift(
            test.skill,
            test.response,
            modelled=test.expected / test.uses,
            seen=test.seen / test.uses,
            uses=test.uses,
            is_new=(test.skill, test.response) not in were,
        )
        for test in after.tests
        if test.is_alarm and test.skill == skill
    )


def text_of(drift: ModelDrift) -> str:
    """An alarm for people."""
    return (
        f"the model of {drift.skill} does not hold: {drift.response} in {drift.seen:.2f} of {drift.uses} "
        f"uses, modelled {drift.modelled:.2f}"
    )


def _after(test: DriftTest, is_seen: bool, probability: float, doubt: float, count: int) -> DriftTest:
    uses = test.uses + 1
    begins = math.log(1 - _LATER if uses == 1 else _LATER / (uses * (uses - 1)))
    before = test.log_wealth or (-math.inf,) * len(_BETS)
    log_wealth = tuple(
        _log_sum(wealth, begins) + _log_ratio(tilt, is_seen, probability, doubt)
        for wealth, tilt in zip(before, _BETS, strict=True)
    )
    whole = math.log(_LATER / uses)  # what is still to be bet
    for wealth, share in zip(log_wealth, _LOG_SHARES, strict=True):
        whole = _log_sum(whole, wealth + share)
    return DriftTest(
        test.skill,
        test.response,
        uses=uses,
        seen=test.seen + is_seen,
        expected=test.expected + probability,
        log_wealth=log_wealth,
        is_alarm=test.is_alarm or whole >= math.log(count / FALSE_ALARMS),
    )


def _log_ratio(tilt: float, is_seen: bool, probability: float, doubt: float) -> float:
    """The gain of a bet on odds that are others by exp(tilt); within the doubt at the odds that win least."""
    odds_at = min(max(probability + math.copysign(doubt, tilt), 0.0), 1.0)
    return tilt * is_seen - math.log1p(odds_at * math.expm1(tilt))


def _doubt(probability: float, belief: BeliefSummary) -> float:
    """The error that a predicted probability may have where a belief is not exact."""
    is_exact = belief.error_bound < 0.5 and belief.states <= _ENUMERATED_STATES
    if is_exact:
        return belief.error_bound
    samples = min(max(belief.effective_states, 1.0), _DRAWN)
    return _STANDARD_ERRORS * math.sqrt(max(probability * (1 - probability), 1 / samples) / samples)


def _log_sum(a: float, b: float) -> float:
    high, low = max(a, b), min(a, b)
    return high if low == -math.inf else high + math.log1p(math.exp(low - high))
