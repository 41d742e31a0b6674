"""Steering as a fold of the journal: who holds a mission, what was asked for, what decisions do without.

Each change is a row of the journal before it counts. So a mission that is taken up is steered as it was.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
from msgspec.structs import replace

from aos_protocol.messages import ActionRefused, DecisionRecord, Steer

LIFTS = frozenset({"step", "resume", "act", "script"})
"""The verbs of somebody who has looked after what a mission holds for."""

_REMEMBERED = 100
"""A question that is asked again comes before so many others."""


class Asked(msgspec.Struct, frozen=True):
    """A grounded action that somebody has asked for, alone or as a part of a script."""

    action: str
    request: str
    by: str
    is_script: bool = False


class Steering(msgspec.Struct, frozen=True):
    """The state of a mission's steering.

    While `held_by` is somebody, the planner has `steps` decisions left, and then none. The `queue` is carried
    out first, also while the mission is held; `current` is the last of it that was decided for. `left_out`
    are skills and grounded actions, with who left them out. `to_stop` is why the mission is to end.
    `requests` are the newest ones, `refusals` those of them that were refused.
    """

    held_by: str = ""
    steps: int = 0
    queue: tuple[Asked, ...] = ()
    current: Asked | None = None
    left_out: Mapping[str, str] = {}
    to_stop: str = ""
    requests: tuple[str, ...] = ()
    refusals: Mapping[str, ActionRefused] = {}

    @property
    def waits(self) -> bool:
        """True where nothing is decided until somebody steers."""
        return bool(self.held_by) and not self.steps and not self.queue

    def is_queued(self, request: str) -> bool:
        """Returns whether some of what was asked for is still to be carried out."""
        return any(asked.request == request for asked in self.queue)

    def after(self, steer: Steer, *, is_holding: bool) -> Steering:
        """The state after somebody has steered a mission that holds, or not."""
        now = replace(self, requests=(*self.requests, steer.request)[-_REMEMBERED:])
        match steer.verb:
            case "hold":
                return replace(now, held_by=steer.by, steps=0, queue=())
            case "step":
                return replace(now, held_by=self.held_by or steer.by, steps=self.steps + 1)
            case "resume":
                return replace(now, held_by="", steps=0)
            case "stop":
                return replace(now, to_stop=steer.reason or f"stopped by {steer.by}")
            case "leave_out":
                return replace(now, left_out={**self.left_out, steer.name: steer.by})
            case "take_back":
                left = {name: by for name, by in self.left_out.items() if name != steer.name}
                return replace(now, left_out=left)
        is_script = steer.verb == "script"
        queue = [Asked(action, steer.request, steer.by, is_script) for action in steer.actions]
        # A mission that holds for a skill does not go on by itself after what an operator does about it.
        held_by = self.held_by or (steer.by if is_holding else "")
        return replace(now, queue=(*self.queue, *queue), held_by=held_by)

    def decided(self, decision: DecisionRecord) -> Steering:
        """The state after a decision."""
        if decision.chosen_by in ("operator", "script"):
            current = self.queue[0] if self.queue else None
            return replace(self, queue=self.queue[1:], current=current)
        return replace(self, steps=max(self.steps - 1, 0), current=None)

    def observed(self, record: DecisionRecord) -> Steering:
        """The state after an outcome: a script ends with an activation that brought no observation."""
        has_failed = record.outcome is not None and record.outcome.status != "observed"
        is_of_script = self.current is not None and self.current.is_script and record.chosen_by == "script"
        return self._without_script(self.current) if has_failed and is_of_script else self

    def refused(self, row: ActionRefused) -> Steering:
        """The state after an action was refused."""
        asked = next((asked for asked in self.queue if asked.request == row.request), None)
        refusals = {name: known for name, known in self.refusals.items() if name in self.requests}
        now = replace(self, refusals={**refusals, row.request: row})
        if asked is not None and asked.is_script:
            return now._without_script(asked)
        left = tuple(each for each in self.queue if each.request != row.request)
        return replace(now, queue=left)

    def _without_script(self, asked: Asked | None) -> Steering:
        assert asked is not None
        left = tuple(each for each in self.queue if each.request != asked.request)
        by = self.held_by or f"the script of {asked.by}"
        return replace(self, queue=left, held_by=by)
