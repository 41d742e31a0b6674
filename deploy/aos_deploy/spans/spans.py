"""The spans of a mission: the mission itself, and of each step decision, activation and belief update."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import msgspec

from aos_protocol.messages import DecisionRecord, MissionState, Outcome
from aos_protocol.tracing import SpanOf, span_id, trace_id


class Span(NamedTuple):
    """One span: ids are hexadecimal, times nanoseconds since 1970. `error` is empty where nothing failed."""

    name: str
    service: str
    trace_id: str
    span_id: str
    parent_id: str
    start_ns: int
    end_ns: int
    attributes: dict[str, Any]
    error: str = ""


def spans_of_record(record: DecisionRecord) -> Iterator[Span]:
    """The span of a decision that was made; of one with its outcome the activation and the update."""
    outcome = record.outcome
    if outcome is None:
        begun_ns = record.stamp_ns - round(record.planning_s * 1e9)
        yield _of_step(record, "decision", "decide", begun_ns, record.stamp_ns, _decided(record))
        return
    if outcome.started_ns:
        is_good = outcome.status == "observed" and outcome.fault is None
        fault = outcome.fault.message if outcome.fault is not None else outcome.status
        yield _of_step(
            record,
            "activation",
            f"activate {record.skill}",
            outcome.started_ns,
            outcome.ended_ns,
            _activated(record, outcome),
            "" if is_good else fault,
        )
    begun_ns = record.stamp_ns - round(record.update_s * 1e9)
    yield _of_step(record, "update", "update belief", begun_ns, record.stamp_ns, _updated(record))


def span_of_mission(state: MissionState, begun_ns: int, ended_ns: int) -> Span:
    """The span of a mission that has ended, the root of the others."""
    attributes = {
        "aos.mission": state.mission,
        "aos.ending": state.ending,
        "aos.remark": state.remark,
        "aos.steps": state.step,
        "aos.goal_probability": state.goal_probability,
    }
    return Span(
        name="mission",
        service="aos.solver",
        trace_id=trace_id(state.mission),
        span_id=span_id(state.mission, "mission"),
        parent_id="",
        start_ns=min(begun_ns, ended_ns),
        end_ns=ended_ns,
        attributes=attributes,
        error=state.remark or state.code or "fault" if state.ending == "fault" else "",
    )


def _of_step(
    record: DecisionRecord,
    of: SpanOf,
    name: str,
    start_ns: int,
    end_ns: int,
    attributes: dict[str, Any],
    error: str = "",
) -> Span:
    common = {"aos.mission": record.mission, "aos.step": record.step, "aos.action": record.action}
    return Span(
        name=name,
        service="aos.middleware" if of == "activation" else "aos.solver",
        trace_id=trace_id(record.mission),
        span_id=span_id(record.mission, of, record.step),
        parent_id=span_id(record.mission, "mission"),
        start_ns=min(start_ns, end_ns),
        end_ns=end_ns,
        attributes=common | attributes,
        error=error,
    )


def _decided(record: DecisionRecord) -> dict[str, Any]:
    value = next((each for each in record.actions if each.action == record.action), None)
    worth = {"aos.value": value.q, "aos.value_stderr": value.stderr} if value is not None else {}
    return {
        "aos.chosen_by": record.chosen_by,
        "aos.planner": record.planner,
        "aos.simulations": record.simulations,
        "aos.preparation_s": record.preparation_s,
        "aos.goal_probability": record.belief.goal_probability,
        "aos.model_digest": record.model_digest,
        "aos.revision": record.revision,
        "aos.engine_starts": record.engine_starts,
        **worth,
    }


def _activated(record: DecisionRecord, outcome: Outcome) -> dict[str, Any]:
    return {
        "aos.skill": outcome.skill,
        "aos.parameters": msgspec.json.encode(record.parameters).decode(),
        "aos.status": outcome.status,
        "aos.response": outcome.response,
        "aos.stopped_by": outcome.stopped_by,
    }


def _updated(record: DecisionRecord) -> dict[str, Any]:
    return {
        "aos.response": record.outcome.response if record.outcome is not None else "",
        "aos.surprise_nats": record.surprise,
        "aos.is_impossible": record.is_impossible,
        "aos.goal_probability": record.belief.goal_probability,
        "aos.entropy": record.belief.entropy,
        "aos.remark": record.remark,
    }
