"""The numbers of decision records in a form that viewers can plot: maps in place of lists, of plain names."""

import math
import re
from collections.abc import Iterable
from typing import Any

from aos_protocol.messages import QUANTILES, DecisionRecord

BELIEF, VALUES = "/aos/plot/belief", "/aos/plot/values"

_QUANTILE_NAMES = tuple(f"p{100 * share:02.0f}" for share in QUANTILES)
_NOT_PLAIN = re.compile(r"[^A-Za-z0-9_]+")


def plain_name(text: str) -> str:
    """A name for a field: letters, digits and _ alone. `open(door=left)` is `open_door_left`."""
    return _NOT_PLAIN.sub("_", text).strip("_") or "_"


def belief_of(record: DecisionRecord) -> dict[str, Any]:
    """The belief of a record: after the outcome, with how surprising it was, or the one decided on."""
    belief = record.belief
    plain: dict[str, Any] = {
        "mission": record.mission,
        "step": record.step,
        "goal_probability": belief.goal_probability,
        "failure_probability": belief.failure_probability,
        "over_probability": belief.over_probability,
        "entropy": belief.entropy,
        "probability": {
            plain_name(marginal.variable): {
                plain_name(value): probability for value, probability in marginal.values.items()
            }
            for marginal in belief.marginals
        },
        "quantiles": {
            plain_name(marginal.variable): dict(zip(_QUANTILE_NAMES, marginal.quantiles, strict=True))
            for marginal in belief.marginals
            if marginal.quantiles
        },
    }
    if record.outcome is not None and not record.is_impossible:
        plain["surprise"] = record.surprise
    return _finite(plain)


def values_of(record: DecisionRecord) -> dict[str, Any]:
    """The worth of each action at a decision."""
    plain: dict[str, Any] = {
        "mission": record.mission,
        "step": record.step,
        "action": record.action,
        "chosen_by": record.chosen_by,
        "simulations": record.simulations,
        "planning_s": record.planning_s,
    }
    for field in ("q", "stderr", "n"):
        plain[field] = {plain_name(value.action): getattr(value, field) for value in record.actions}
    return _finite(plain)


def merged_schema(contents: Iterable[Any]) -> dict[str, Any]:
    """The schema of objects that have some of the same fields; of each field, of its first type."""
    properties: dict[str, Any] = {}
    for content in contents:
        _merge(properties, content)
    return {"type": "object", "properties": properties}


def _merge(properties: dict[str, Any], content: dict[str, Any]) -> None:
    for name, value in content.items():
        if isinstance(value, dict):
            known = properties.setdefault(name, {"type": "object", "properties": {}})
            _merge(known["properties"], value)
        else:
            kind = "string" if isinstance(value, str) else "number"
            properties.setdefault(name, {"type": kind})


def _finite(value: dict[str, Any]) -> dict[str, Any]:
    """The same without numbers that JSON does not have."""
    return {
        key: _finite(item) if isinstance(item, dict) else item
        for key, item in value.items()
        if not isinstance(item, float) or math.isfinite(item)
    }
