from math import log
from typing import Any

import pytest

from aos_protocol.messages import ActivationId, BeliefSummary, DecisionRecord, Fault, Outcome
from aos_solver.mission.rules.failures import FailureRules, Failures, SkillRule

BELIEF = BeliefSummary((), 0.0, 0.0, 0.0, 1, True)
FAULT = Fault("AOS510", "jammed")


def decision(skill: str) -> DecisionRecord:
    return DecisionRecord(0, 0, "m", 1, 1, skill, skill, {}, "", 1, 1, 1, 1, 0.0, (), (), BELIEF)


def outcome(skill: str, status: str, fault: Fault | None = FAULT) -> Outcome:
    response = "seen" if status == "observed" else ""
    return Outcome(ActivationId("m", 1), skill, status, response, fault=fault)


class Mission:
    def __init__(self, **rules: Any):
        self.failures = Failures(FailureRules(**rules))
        self.now_s = 0.0
        self.announced: dict[str, int] = {}

    def take(
        self,
        skill: str,
        status: str = "failed",
        *,
        fault: Fault | None = FAULT,
        excluded: bool = False,
        surprise: float = 0.0,
    ) -> str:
        return self.failures.take(
            decision(skill),
            outcome(skill, status, fault),
            is_excluded=excluded,
            surprise=surprise,
            now_s=self.now_s,
            announced=self.announced,
        )

    def works(self, skill: str):
        assert not self.take(skill, "observed", fault=None)

    @property
    def set_aside(self) -> set[str]:
        return set(self.failures.set_aside(self.now_s, self.announced))


def test_a_skill_is_set_aside_whatever_ran_between():
    mission = Mission()
    for _ in range(2):
        assert not mission.take("take")
        mission.works("look")
    assert mission.take("take") == (
        "take is set aside for 300 s after 3 failures in a row, the last failed, AOS510: jammed"
    )
    assert mission.set_aside == {"take"}


def test_a_refusal_because_another_skill_may_move_counts_for_that_one():
    mission = Mission(skills={"look": SkillRule(set_aside_after=2)})
    mission.take("take", "timed_out")
    may_move = Fault("AOS512", "/take may still be moving")
    assert not mission.take("look", "refused", fault=may_move)
    assert "take is set aside for 300 s after 3 failures" in mission.take("look", "refused", fault=may_move)
    mission.take("look", "refused", fault=may_move)
    assert mission.set_aside == {"take"}


def test_an_observed_end_ends_the_row():
    mission = Mission()
    for _ in range(5):
        mission.take("take")
        mission.take("take", "timed_out")
        mission.works("take")
    assert not mission.set_aside


def test_reports_that_the_model_excludes_are_failures():
    mission = Mission(failure_limit=4)
    for _ in range(3):
        mission.take("take", "observed", fault=None, excluded=True)
    assert mission.set_aside == {"take"}
    mission.take("look")
    assert mission.failures.to_end.startswith(
        "4 activations of the mission have failed, the last look: failed"
    )


@pytest.mark.parametrize(("probability", "failures"), [(0.01, 3), (0.1, 3), (0.2, 5), (0.5, 10)])
def test_what_a_rule_told_of_a_failure_counts_by_how_improbable_it_was(probability, failures):
    mission = Mission(failure_limit=3)
    count = 0
    while not mission.set_aside:
        mission.take("look", "observed", surprise=-log(probability))
        count += 1
    assert count == failures
    assert not mission.failures.to_end


def test_an_expected_failure_never_sets_a_skill_aside():
    mission = Mission()
    for _ in range(1000):
        mission.take("look", "observed", surprise=0.0)
    assert not mission.set_aside


def test_a_pause_ends_in_time_and_with_an_adapter_that_comes_anew():
    mission = Mission(set_aside_after=1, set_aside_s=60.0)
    mission.announced = {"take": 1}
    mission.take("take")
    mission.now_s = 59.0
    assert mission.set_aside == {"take"}
    assert mission.failures.s_until_return(mission.now_s) == pytest.approx(1.0)
    mission.now_s = 60.0
    assert not mission.set_aside
    mission.take("take")
    assert mission.set_aside == {"take"}
    mission.announced = {"take": 2}
    assert not mission.set_aside


def test_a_new_adapter_begins_a_new_row():
    mission = Mission()
    mission.announced = {"take": 1}
    mission.take("take")
    mission.take("take")
    mission.announced = {"take": 2}
    mission.take("take")
    assert not mission.set_aside


@pytest.mark.parametrize("outcome", ["unknown", "timed_out"], ids=["ends", "has to be ended"])
def test_an_adapter_that_ends_in_or_after_each_call_is_no_new_one(outcome):
    mission = Mission()
    for start in (1, 2, 3):
        mission.announced = {"take": start}
        mission.take("take", outcome)
    mission.announced = {"take": 4}
    assert mission.set_aside == {"take"}
    mission.now_s = 300.0
    assert not mission.set_aside


def test_a_call_that_is_refused_while_the_adapter_is_ended_makes_no_new_one_of_it():
    mission = Mission()
    for start, status in ((1, "timed_out"), (1, "refused"), (2, "timed_out")):
        mission.announced = {"take": start}
        mission.take("take", status)
    mission.announced = {"take": 3}
    assert mission.set_aside == {"take"}


def test_somebody_who_starts_an_adapter_again_after_a_row_of_timeouts_ends_the_pause():
    mission = Mission()
    mission.announced = {"take": 1}
    for _ in range(3):
        mission.take("take", "timed_out")
    assert mission.set_aside == {"take"}
    mission.announced = {"take": 2}
    assert not mission.set_aside
    assert not mission.take("take", "timed_out"), "a new row"


def test_a_skills_own_numbers_count_before_the_missions():
    rules = {"take": SkillRule(set_aside_after=1, set_aside_s=5.0), "look": SkillRule(set_aside_after=4)}
    mission = Mission(skills=rules)
    assert "take is set aside for 5 s after a failure" in mission.take("take")
    for _ in range(3):
        assert not mission.take("look")


def test_tries_count_too_and_end_with_the_pause():
    mission = Mission(skills={"take": SkillRule(on_failure="retry", retries=5)})
    mission.take("take")
    assert mission.failures.to_retry is not None
    mission.take("take")
    mission.take("take")
    assert mission.failures.to_retry is None
    assert mission.set_aside == {"take"}


def test_whoever_lets_a_mission_go_on_has_looked_after_the_skill():
    mission = Mission(skills={"take": SkillRule(on_failure="hold")})
    for _ in range(5):
        mission.take("take")
        assert mission.failures.to_hold == "the mission holds: take: failed, AOS510: jammed"
    assert not mission.set_aside


@pytest.mark.parametrize(
    ("status", "usual", "given"),
    [("refused", 0.0, 0.0), ("failed", 0.0, 0.8), ("timed_out", 0.5, 0.8), ("unknown", 0.5, 0.8)],
)
def test_how_probable_it_is_that_a_skill_ran(status, usual, given):
    lost = outcome("take", status)
    assert Failures().ran_probability(lost) == usual
    rules = FailureRules(skills={"take": SkillRule(ran_probability=0.8)})
    assert Failures(rules).ran_probability(lost) == given
