"""The rule for what operators want of a mission: the same fold of the journal as the mission's own."""

from collections.abc import Callable
from typing import Any

from aos_protocol.messages import ActionRefused, DecisionRecord, MissionState, Steer
from aos_solver.mission.control.steering import Asked, Steering

_RULE = "steering"


class SteeringRules:
    """Takes the journal's rows in their order."""

    def __init__(self) -> None:
        self._steering = Steering()
        self._is_holding = False

    def take(self, message: Any, found: Callable[[str, str], None]) -> None:
        """One row's message; what is wrong is told to `found`."""
        if isinstance(message, MissionState):
            self._is_holding = message.phase == "holding"
        elif isinstance(message, Steer):
            self._steering = self._steering.after(message, is_holding=self._is_holding)
        elif isinstance(message, ActionRefused):
            if not self._steering.is_queued(message.request):
                found(_RULE, f"{message.action} is refused, and nobody has asked for it")
            self._steering = self._steering.refused(message)
        elif isinstance(message, DecisionRecord) and message.outcome is None:
            self._check(message, found)
            self._steering = self._steering.decided(message)
        elif isinstance(message, DecisionRecord):
            self._steering = self._steering.observed(message)

    def _check(self, decision: DecisionRecord, found: Callable[[str, str], None]) -> None:
        now, step = self._steering, f"step {decision.step}"
        asked = now.queue[0] if now.queue else None
        if decision.chosen_by in ("operator", "script"):
            if asked is None or (asked.action, _chosen_by(asked)) != (decision.action, decision.chosen_by):
                found(_RULE, f"{step}: nobody has asked for {decision.action}")
        elif asked is not None:
            found(_RULE, f"{step} is decided before {asked.action}, which {asked.by} has asked for")
        elif now.waits:
            found(_RULE, f"{step} is decided while {now.held_by} holds the mission")
        for name in {decision.skill, decision.action} & now.left_out.keys():
            found(_RULE, f"{step} is decided for {name}, which {now.left_out[name]} has left out")


def _chosen_by(asked: Asked) -> str:
    return "script" if asked.is_script else "operator"
