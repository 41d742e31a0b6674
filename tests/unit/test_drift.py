import math
import random
from collections.abc import Mapping

import msgspec
import pytest
from decision_records import decision_record
from msgspec.structs import replace

from aos_protocol.messages import (
    ActivationId,
    BeliefSummary,
    DriftTests,
    ModelDrift,
    Outcome,
    PredictedObservation,
)
from aos_runtime.disk.journal import JournalRow
from aos_solver.mission.records.memory import folded
from aos_solver.mission.rules.drift import FALSE_ALARMS, after_use, begun, drifts, text_of

RIGHT = {"taken": 0.9, "missed": 0.1}
WRONG = {"taken": 0.6, "missed": 0.4}
Odds = Mapping[str, float]
"""The probability of each response."""

BELIEF = BeliefSummary((), 0.0, 0.0, 0.0, 2, True)


def use(
    tests: DriftTests, skill: str, modelled: Odds, response: str
) -> tuple[DriftTests, tuple[ModelDrift, ...]]:
    predicted = tuple(PredictedObservation(name, odds) for name, odds in modelled.items())
    decision = decision_record(0, skill=skill, model_digest="d", predicted=predicted, belief=BELIEF)
    outcome = Outcome(ActivationId("m", 1), skill, "observed", response)
    after = after_use(tests, decision, replace(decision, outcome=outcome))
    return after, drifts(tests, after, skill)


def drawn(odds: Odds, draw: random.Random) -> str:
    return draw.choices([*odds], [*odds.values()])[0]


def alarm_of(
    seed: int, modelled: Odds, real: Odds, uses: int, *, others: int = 0, right_before: int = 0
) -> ModelDrift | None:
    """The first alarm of a skill within so many uses, after some in which the model was right.

    There are as many `others`, which the model has right and which are not used.
    """
    draw = random.Random(seed)
    skills = {"pick": [*modelled], **{f"other{number}": ["yes", "no"] for number in range(others)}}
    tests = begun("d", skills)
    for number in range(right_before + uses):
        odds = modelled if number < right_before else real
        tests, alarms = use(tests, "pick", modelled, drawn(odds, draw))
        if alarms:
            return alarms[0]
    return None


def silent(seed: int, skills: Mapping[str, Odds], uses: int) -> bool:
    draw = random.Random(seed)
    tests = begun("d", {skill: [*odds] for skill, odds in skills.items()})
    for _ in range(uses):
        skill = draw.choice([*skills])
        weights = {name: odds * draw.uniform(0.2, 1.0) for name, odds in skills[skill].items()}
        modelled = {name: weight / sum(weights.values()) for name, weight in weights.items()}
        tests, alarms = use(tests, skill, modelled, drawn(modelled, draw))
        if alarms:
            return False
    return True


SKILLS: dict[str, Odds] = {
    "pick": {"taken": 0.9, "missed": 0.1},
    "look": {"left": 0.3, "right": 0.3, "nothing": 0.4},
    "go": {"arrived": 0.97, "lost": 0.02, "blocked": 0.01},
    "serve": {"delivered": 0.5, "not_delivered": 0.5},
}


def test_a_skill_of_0_9_that_is_0_6_alarms_within_60_uses():
    alarms = [alarm_of(seed, RIGHT, WRONG, 60, others=3) for seed in range(100)]
    assert sum(alarm is not None for alarm in alarms) >= 95
    first = next(alarm for alarm in alarms if alarm is not None)
    assert first.modelled == pytest.approx(0.9 if first.response == "taken" else 0.1)
    assert first.is_new
    assert (first.seen < 0.8) == (first.response == "taken")


def test_runs_of_a_right_model_stay_silent_all_skills_together():
    assert sum(silent(seed, SKILLS, 500) for seed in range(100)) >= 99


def test_a_skill_that_wears_out_later_is_found_too():
    alarms = [alarm_of(seed, RIGHT, WRONG, 100, others=3, right_before=100) for seed in range(20)]
    assert sum(alarm is not None and alarm.uses > 100 for alarm in alarms) >= 18


def test_the_wealth_of_a_right_model_stays_as_it_is_in_the_mean():
    """Exactly so, over all sequences of six uses; that is what the rate of false alarms rests on."""
    mean = 0.0
    for number in range(2**6):
        tests, probability = begun("d", {"pick": [*RIGHT]}), 1.0
        for place in range(6):
            response = "taken" if number >> place & 1 else "missed"
            probability *= RIGHT[response]
            tests, _ = use(tests, "pick", RIGHT, response)
        mean += probability * wealth(tests)
    assert mean == pytest.approx(1.0, abs=1e-12)


def wealth(tests: DriftTests) -> float:
    shares = (0.08, 0.17, 0.15, 0.1, 0.1, 0.15, 0.17, 0.08)
    test = tests.tests[0]
    bets = zip(shares, test.log_wealth, strict=True)
    return sum(share * math.exp(log) for share, log in bets) + 0.2 / test.uses


def test_what_the_model_excludes_alarms_at_once_where_it_comes_again():
    tests = begun("d", {"pick": [*RIGHT]})
    uses, alarms = 0, ()
    while not alarms and uses < 6:
        uses += 1
        tests, alarms = use(tests, "pick", {"taken": 1.0, "missed": 0.0}, "missed")
    assert uses <= 3
    assert text_of(alarms[0]) == (
        f"the model of pick does not hold: taken in 0.00 of {uses} uses, modelled 1.00"
    )


def test_a_belief_that_was_sampled_has_the_benefit_of_the_doubt():
    sampled = replace(BELIEF, error_bound=1.0, effective_states=100.0)
    tests = begun("d", {"pick": [*RIGHT]})
    predicted = tuple(PredictedObservation(name, odds) for name, odds in RIGHT.items())
    decision = decision_record(0, skill="pick", model_digest="d", predicted=predicted, belief=sampled)
    for number in range(300):
        response = "taken" if number % 20 < 17 else "missed"  # 0.85, within three standard errors
        outcome = Outcome(ActivationId("m", 1), "pick", "observed", response)
        tests = after_use(tests, decision, replace(decision, outcome=outcome))
    assert drifts(tests, tests, "pick") == ()


@pytest.mark.parametrize(
    "changes",
    [{"status": "timed_out", "response": ""}, {"stopped_by": "pick"}],
    ids=["not observed", "stopped"],
)
def test_what_says_nothing_about_the_model_is_not_tested(changes):
    tests = begun("d", {"pick": [*RIGHT]})
    decision = decision_record(0, skill="pick", model_digest="d")
    outcome = replace(Outcome(ActivationId("m", 1), "pick", "observed", "taken"), **changes)
    assert after_use(tests, decision, replace(decision, outcome=outcome)) == tests


def test_two_responses_are_one_test_and_one_response_is_none():
    tests = begun("d", {"pick": ["taken", "missed"], "look": ["a", "b", "c"], "go": ["arrived"]})
    assert tests.count == 4
    assert {test.skill for test in tests.tests} == {"pick", "look"}
    assert FALSE_ALARMS == 0.01


def test_the_tests_of_a_mission_are_the_fold_of_its_journal():
    tests = begun("d", {"look": ["left", "right"]})
    predicted = (PredictedObservation("left", 0.5), PredictedObservation("right", 0.5))
    rows = [("drift", tests)]
    for step in (1, 2):
        decision = decision_record(2 * step - 2, model_digest="d", predicted=predicted, belief=BELIEF)
        outcome = Outcome(ActivationId("m", step), "look", "observed", "left")
        done = replace(decision, sequence=2 * step - 1, outcome=outcome)
        tests = after_use(tests, decision, done)
        rows += [("decision", decision), ("decision", done)]
    journal = [JournalRow(n, 0, kind, msgspec.json.encode(each)) for n, (kind, each) in enumerate(rows, 1)]
    assert folded(journal).drift == tests
    assert tests.tests[0].uses == 2
