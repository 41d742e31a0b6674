from typing import Any

from decision_records import decision_record
from msgspec.structs import replace

from aos_gateway.metrics.counting import Families
from aos_gateway.metrics.exposition import Counter, Histogram, exposition
from aos_protocol.messages import ActivationId, DecisionRecord, Fault, ModelDrift, Outcome, SearchMade


def counted(*records: DecisionRecord) -> dict[str, str]:
    families, engine_starts = Families(), {}
    for record in records:
        families.take("r2", record, engine_starts)
    lines = exposition(families.all).decode().splitlines()
    return {name: value for name, _, value in (line.rpartition(" ") for line in lines if line[0] != "#")}


def observed(step: int, status: str = "observed", **others: Any) -> DecisionRecord:
    outcome = Outcome(ActivationId("m", step), "look", status, "red" if status == "observed" else "")
    return decision_record(2 * step - 1, outcome=outcome, **others)


def test_a_counter_has_help_type_and_escaped_labels():
    counter = Counter("aos_things_total", "Things, of a\\b.")
    counter.add(robot='the "first"\nof\\two')
    counter.add(0.5, robot="b")
    assert exposition([counter]).decode() == (
        "# HELP aos_things_total Things, of a\\\\b.\n"
        "# TYPE aos_things_total counter\n"
        'aos_things_total{robot="b"} 0.5\n'
        'aos_things_total{robot="the \\"first\\"\\nof\\\\two"} 1\n'
    )


def test_a_histogram_counts_up_to_each_bound_and_a_bound_itself_is_within():
    histogram = Histogram("aos_s", "Seconds.", (0.1, 1.0))
    for value in (0.05, 0.1, 0.5, 7.0):
        histogram.observe(value, robot="a")
    assert exposition([histogram]).decode().splitlines()[2:] == [
        'aos_s_bucket{robot="a",le="0.1"} 2',
        'aos_s_bucket{robot="a",le="1"} 3',
        'aos_s_bucket{robot="a",le="+Inf"} 4',
        'aos_s_sum{robot="a"} 7.65',
        'aos_s_count{robot="a"} 4',
    ]


def test_nothing_is_told_of_what_was_never_counted():
    assert exposition(Families().all) == b""


def test_a_decision_adds_its_seconds_and_the_simulations_of_all_its_searches():
    searches = (SearchMade("pomcp", (100, 50), known=30), SearchMade("pomcp", (7,), is_dropped=True))
    samples = counted(decision_record(0, planning_s=0.3, searches=searches), observed(1, searches=searches))
    assert samples['aos_simulations_total{robot="r2"}'] == "157"
    assert samples['aos_decision_seconds_sum{robot="r2",chosen_by="planner"}'] == "0.3"
    assert samples['aos_decision_seconds_bucket{robot="r2",chosen_by="planner",le="0.25"}'] == "0"
    assert samples['aos_decision_seconds_count{robot="r2",chosen_by="planner"}'] == "1"


def test_surprise_is_that_of_observations_and_an_impossible_one_is_counted_apart():
    samples = counted(observed(1, surprise=0.7), observed(2, "failed"), observed(3, is_impossible=True))
    assert samples['aos_steps_total{robot="r2"}'] == samples['aos_activations_total{robot="r2",skill="look"}']
    assert samples['aos_steps_total{robot="r2"}'] == "3"
    assert samples['aos_surprise_nats_count{robot="r2"}'] == "1"
    assert samples['aos_skill_failures_total{robot="r2",skill="look",status="failed"}'] == "1"
    assert samples['aos_impossible_outcomes_total{robot="r2",skill="look"}'] == "1"


def test_a_refusal_because_another_skill_may_move_is_no_failure_of_the_one_refused():
    record = observed(1, "refused")
    assert record.outcome is not None
    outcome = replace(record.outcome, fault=Fault("AOS512", "/take may still be moving"))
    assert not [name for name in counted(replace(record, outcome=outcome)) if "failures" in name]


def test_an_alarm_of_drift_counts_when_it_begins_and_not_while_it_stands():
    alarm = ModelDrift("look", "red", 0.9, 0.6, 40, is_new=True)
    standing = ModelDrift("look", "red", 0.9, 0.6, 41)
    samples = counted(observed(1, drift=(alarm,)), observed(2, drift=(standing,)))
    assert samples['aos_drift_alarms_total{robot="r2",skill="look",response="red"}'] == "1"


def test_engines_that_start_anew_count_also_with_a_new_model_and_a_new_solver():
    def restarts(*starts: tuple[str, int]) -> str:
        records = (
            decision_record(2 * place, model_digest=model, engine_starts=number)
            for place, (model, number) in enumerate(starts)
        )
        return counted(*records)['aos_engine_restarts_total{robot="r2"}']

    assert restarts(("a", 1), ("a", 1)) == "0"
    assert restarts(("a", 1), ("a", 3)) == "2"
    assert restarts(("a", 2), ("b", 1), ("b", 2)) == "2"
    assert restarts(("a", 2), ("a", 1), ("a", 2)) == "2"
