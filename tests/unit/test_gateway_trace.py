from typing import Any

import pytest
from decision_records import decision_record

from aos_gateway.runs.trace import Step, Steps, steps_of
from aos_protocol.messages import (
    ActionValue,
    ActivationId,
    BeliefSummary,
    DecisionRecord,
    Marginal,
    Outcome,
    PredictedObservation,
    SearchMade,
)


def belief(goal: float = 0.0, **variables: dict[str, float]) -> BeliefSummary:
    marginals = tuple(Marginal(name, values) for name, values in variables.items())
    return BeliefSummary(marginals, 0.5, goal, 0.0, 2, True)


def decided(step: int, **others: Any) -> DecisionRecord:
    return decision_record(2 * step - 2, **others)


def observed(step: int, response: str, **others: Any) -> DecisionRecord:
    outcome = Outcome(ActivationId("m", step), "look", "observed" if response else "failed", response)
    return decision_record(2 * step - 1, outcome=outcome, **others)


def row_of(*records: DecisionRecord) -> Step:
    (row,) = steps_of("m", records).steps
    return row


def test_the_margin_is_over_the_best_of_the_other_actions():
    values = (
        ActionValue("look", 2.5, 9, 0.1),
        ActionValue("wait", 1.0, 9, 0.2),
        ActionValue("go", 2.0, 9, 0.3),
    )
    row = row_of(decided(1, actions=values))
    assert (row.value, row.second, row.second_value, row.second_error, row.margin) == (
        2.5,
        "go",
        2.0,
        0.3,
        0.5,
    )


@pytest.mark.parametrize("value", [45.16546243254006, -123456.784])
def test_a_value_has_the_decimals_that_the_values_of_the_decision_have(value):
    shown = row_of(decided(1, actions=(ActionValue("look", value, 1, 0.0),))).value
    assert f"{shown:.2f}" == f"{value:.2f}"


def test_a_choice_that_bounds_tell_apart_is_proven_whatever_the_errors_are():
    chosen = ActionValue("look", 38.0, 1, 19.0, 37.9, 38.1)
    apart = (chosen, ActionValue("open", 31.7, 1, 19.0, 31.6, 31.8))
    assert row_of(decided(1, actions=apart)).is_proven
    assert not row_of(decided(1, actions=(chosen, ActionValue("open", 31.7, 1, 19.0, 31.6, 38.0)))).is_proven
    assert not row_of(decided(1, actions=(chosen, ActionValue("open", 31.7, 1, 19.0)))).is_proven


def test_an_action_that_cannot_be_chosen_is_no_second():
    actions = tuple(
        ActionValue(name, value, 9, 0.1) for name, value in {"look": 2, "go": 3, "wait": 1}.items()
    )
    barred = SearchMade("pomcp", (9,), barred={"go": "no adapter answers calls of /go"})
    dropped = SearchMade("pomcp", (9,), is_dropped=True)
    assert row_of(decided(1, actions=actions, searches=(barred, dropped))).second == "wait"


def test_an_action_whose_value_nobody_knows_is_no_second():
    for unknown in (ActionValue("go", float("-inf"), 0, 0.0), ActionValue("go", 9.0, 0, 1.0)):
        values = (ActionValue("look", 2.5, 9, 0.1), unknown)
        assert row_of(decided(1, actions=values, simulations=9)).margin is None


def test_a_row_has_what_was_expected_and_what_was_seen():
    predicted = (PredictedObservation("yes", 0.75), PredictedObservation("no", 0.25))
    row = row_of(decided(1, predicted=predicted), observed(1, "no", predicted=predicted, surprise=1.386))
    assert (row.predicted, row.seen, row.expected) == ({"yes": 0.75, "no": 0.25}, "no", 0.25)
    assert (row.status, row.surprise) == ("observed", 1.386)


def test_of_thousands_of_responses_the_likeliest_are_listed_and_all_others_are_one():
    predicted = tuple(PredictedObservation(f"text {n}", n / 4950) for n in range(100))
    row = row_of(decided(1, predicted=predicted), observed(1, "text 2", predicted=predicted))
    assert list(row.predicted) == [*(f"text {n}" for n in range(99, 49, -1)), "…"]
    assert sum(row.predicted.values()) == pytest.approx(1, abs=0.005)
    assert row.expected == 0.0004


def test_a_skill_that_failed_has_a_status_and_nothing_seen():
    row = row_of(decided(1), observed(1, ""))
    assert (row.status, row.seen, row.expected) == ("failed", "", None)


def test_only_variables_whose_distribution_has_changed_are_in_the_row():
    before = belief(at={"A": 1.0}, held={"true": 0.5, "false": 0.5})
    after = belief(at={"A": 1.0}, held={"true": 0.9, "false": 0.1})
    trace = steps_of(
        "m", [decided(1, belief=before), observed(1, "yes", belief=after), decided(2, belief=after)]
    )
    first, second = trace.steps
    assert first.belief == {"at": {"A": 1.0}, "held": {"true": 0.5, "false": 0.5}}
    assert first.after == {"held": {"true": 0.9, "false": 0.1}}
    assert second.belief == {}


def test_rows_of_a_stream_have_all_variables_since_a_page_may_begin_anywhere():
    same = belief(at={"A": 1.0})
    rows = Steps(whole=True)
    rows.take(decided(1, belief=same))
    assert rows.take(observed(1, "yes", belief=same)).after == {"at": {"A": 1.0}}


def test_what_is_not_certain_is_not_rounded_to_certainty():
    row = row_of(decided(1, belief=belief(goal=0.99999, held={"true": 0.99999, "false": 0.00001})))
    assert row.endings.goal < 1
    assert row.belief["held"]["true"] < 1


def test_values_beyond_the_likeliest_are_one():
    many = {f"v{number}": 0.1 for number in range(10)}
    values = row_of(decided(1, belief=belief(at=many))).belief["at"]
    assert len(values) == 9
    assert abs(sum(values.values()) - 1) < 1e-9


def test_a_trace_says_with_which_record_to_go_on():
    trace = steps_of("m", [decided(3), observed(3, "yes")])
    assert (trace.first, trace.next, [row.sequence for row in trace.steps]) == (3, 6, [5])
    assert steps_of("m", []).next == 0


def test_a_number_with_many_values_is_told_by_its_quantiles():
    depth = Marginal("depth", {"1.23456789": 0.001}, 0.999, (0.5, 1.0, 1.23456789, 2.0, 2.5))
    row = row_of(decided(1, belief=BeliefSummary((depth,), 0.5, 0.0, 0.0, 2, True)))
    assert row.belief == {"depth": (0.5, 1.0, 1.2346, 2.0, 2.5)}
