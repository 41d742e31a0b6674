"""The ids of OpenTelemetry's traces and spans, which follow from a mission's name and a step.

Solver, middleware and adapter need not hand them on: whoever knows an activation's id knows its span. Ids are
hexadecimal, as in W3C's trace context.
"""

from hashlib import sha256
from typing import Literal

from aos_protocol.messages import ActivationId

SpanOf = Literal["mission", "decision", "activation", "update"]


def trace_id(mission: str) -> str:
    """Returns the id of the trace that is a mission: 32 digits."""
    return sha256(f"aos trace {mission}".encode()).hexdigest()[:32]


def span_id(mission: str, of: SpanOf, step: int = 0) -> str:
    """Returns the id of a span of a step, or of the whole mission: 16 digits."""
    return sha256(f"aos span {of} {step} {mission}".encode()).hexdigest()[:16]


def traceparent(activation: ActivationId) -> str:
    """Returns W3C's `traceparent` of an activation, below which an adapter puts spans of its own."""
    return (
        f"00-{trace_id(activation.mission)}-{span_id(activation.mission, 'activation', activation.step)}-01"
    )
