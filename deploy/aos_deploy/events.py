"""The events that aos-up tells while a mission runs: to the live view, as plain lines, or as JSON."""

from collections.abc import Callable
from typing import Any

import msgspec

from aos_protocol.messages import BundleReport, DecisionRecord, MissionState, SkillProgress


class ServiceChanged(msgspec.Struct, frozen=True):
    """A service is now `starting`, `ready`, `silent`, `frozen`, `stopping` or `ended`.

    `after_s` counts from aos-up's start.
    """

    service: str
    state: str
    after_s: float
    detail: str = ""


class Told(msgspec.Struct, frozen=True):
    """A line for people: what is being waited for, where things are."""

    text: str


Event = ServiceChanged | Told | MissionState | DecisionRecord | BundleReport | SkillProgress
Report = Callable[[Event], None]

_NAMES: dict[type[Any], str] = {
    ServiceChanged: "service",
    Told: "remark",
    MissionState: "mission",
    DecisionRecord: "decision",
    BundleReport: "bundle",
    SkillProgress: "progress",
}


def event_json(event: Event) -> str:
    """One line: an object whose `event` names the kind, with the event's own fields beside it."""
    fields = msgspec.to_builtins(event, builtin_types=())
    return msgspec.json.encode({"event": _NAMES[type(event)], **fields}).decode()
