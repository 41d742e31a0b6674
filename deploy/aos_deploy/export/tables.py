"""Runs as tables: a row for each mission, step, value of an action, prediction, probability of a belief."""

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from aos_deploy.export.kept_missions import KeptMission, kept_missions
from aos_protocol.messages import QUANTILES, BeliefSummary, DecisionRecord
from aos_protocol.mission_rows import STATE

_KEY = {"run": str, "mission": str, "step": int}

TABLES: dict[str, dict[str, type[Any]]] = {
    "missions": {
        "run": str,
        "mission": str,
        "ending": str,
        "remark": str,
        "steps": int,
        "first_ns": int,
        "last_ns": int,
    },
    "steps": {
        **_KEY,
        "action": str,
        "skill": str,
        "parameters": str,
        "chosen_by": str,
        "planner": str,
        "simulations": int,
        "planning_s": float,
        "revision": int,
        "decided_ns": int,
        "status": str,
        "response": str,
        "numbers": str,
        "error": str,
        "surprise": float,
        "is_impossible": bool,
        "started_ns": int,
        "ended_ns": int,
        "goal_probability": float,
        "failure_probability": float,
        "over_probability": float,
        "entropy": float,
        "remark": str,
    },
    "values": {
        **_KEY,
        "action": str,
        "is_chosen": bool,
        "q": float,
        "stderr": float,
        "n": int,
        "at_least": float,
        "at_most": float,
    },
    "predictions": {**_KEY, "skill": str, "response": str, "probability": float, "is_seen": bool},
    "beliefs": {**_KEY, "moment": str, "variable": str, "value": str, "probability": float},
    "quantiles": {**_KEY, "moment": str, "variable": str, "probability": float, "value": float},
}
"""Each table with its columns and their types. Compounds are JSON; times are nanoseconds since 1970."""


class Row(NamedTuple):
    """A row of the table of this name; a column that it lacks is empty."""

    table: str
    cells: dict[str, Any]


def rows_of_runs(runs: Iterable[Path]) -> Iterator[Row]:
    """All rows of all tables of the runs; StorageError AOS702 at a damaged row of a journal."""
    for run in runs:
        for mission in kept_missions(run):
            yield from _rows_of_mission(run.resolve().name, mission)


def _rows_of_mission(run: str, mission: KeptMission) -> Iterator[Row]:
    key: dict[str, Any] = {"run": run, "mission": mission.name}
    pending: DecisionRecord | None = None
    for record in mission.decisions():
        if record.outcome is None:
            if pending is not None:
                yield Row("steps", _step(key, pending, None))
            pending = record
            yield from _decided(key, record)
        else:
            yield from _observed(key, pending or record, record)
            pending = None
    if pending is not None:
        yield Row("steps", _step(key, pending, None))
    yield Row("missions", {**key, **_ending(mission)})


def _ending(mission: KeptMission) -> dict[str, Any]:
    ending: dict[str, Any] = {}
    for row in mission.rows():
        ending.setdefault("first_ns", row.stamp_ns)
        ending["last_ns"] = row.stamp_ns
        if row.kind == STATE:
            state = json.loads(row.payload)
            ending |= {
                "ending": state.get("ending", ""),
                "remark": state.get("remark", ""),
                "steps": state["step"],
            }
    return ending


def _decided(key: dict[str, Any], record: DecisionRecord) -> Iterator[Row]:
    at = {**key, "step": record.step}
    for value in record.actions:
        cells = {name: getattr(value, name) for name in ("action", "q", "stderr", "n", "at_least", "at_most")}
        yield Row("values", {**at, **cells, "is_chosen": value.action == record.action})
    yield from _belief(at, "decided", record.belief)


def _observed(key: dict[str, Any], decided: DecisionRecord, record: DecisionRecord) -> Iterator[Row]:
    at, outcome = {**key, "step": record.step}, record.outcome
    assert outcome is not None
    yield Row("steps", _step(key, decided, record))
    predicted = {each.response: each.probability for each in decided.predicted}
    if outcome.status == "observed":
        predicted.setdefault(outcome.response, 0.0)
    for response, probability in predicted.items():
        seen = outcome.status == "observed" and response == outcome.response
        cells = {"skill": record.skill, "response": response, "probability": probability, "is_seen": seen}
        yield Row("predictions", {**at, **cells})
    yield from _belief(at, "observed", record.belief)


def _belief(at: dict[str, Any], moment: str, belief: BeliefSummary) -> Iterator[Row]:
    for marginal in belief.marginals:
        for value, probability in marginal.values.items():
            cells = {"variable": marginal.variable, "value": value, "probability": probability}
            yield Row("beliefs", {**at, "moment": moment, **cells})
        for share, number in zip(QUANTILES, marginal.quantiles, strict=False):
            cells = {"variable": marginal.variable, "probability": share, "value": number}
            yield Row("quantiles", {**at, "moment": moment, **cells})


def _step(key: dict[str, Any], decided: DecisionRecord, record: DecisionRecord | None) -> dict[str, Any]:
    last = record or decided
    cells = {
        **key,
        **{name: getattr(decided, name) for name in ("step", "action", "skill", "chosen_by", "planner")},
        **{name: getattr(decided, name) for name in ("simulations", "planning_s", "revision")},
        "parameters": json.dumps(decided.parameters),
        "decided_ns": decided.stamp_ns,
        **{name: getattr(last.belief, name) for name in ("goal_probability", "failure_probability")},
        **{name: getattr(last.belief, name) for name in ("over_probability", "entropy")},
        "remark": last.remark,
    }
    if record is None or record.outcome is None:
        return cells
    outcome = record.outcome
    return cells | {
        "status": outcome.status,
        "response": outcome.response,
        "numbers": json.dumps(outcome.numbers) if outcome.numbers else "",
        "error": f"{outcome.fault.code}: {outcome.fault.message}" if outcome.fault else "",
        "surprise": None if record.is_impossible else record.surprise,
        "is_impossible": record.is_impossible,
        "started_ns": outcome.started_ns,
        "ended_ns": outcome.ended_ns,
    }
