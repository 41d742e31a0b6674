"""What follows from activations that brought no observation: try again, go on, hold or end."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import msgspec

from aos_protocol.messages import DecisionRecord, Outcome

__all__ = ["Failures", "OnFailure", "SkillRule"]

OnFailure = Literal["observe", "retry", "hold", "end"]


class SkillRule(msgspec.Struct, frozen=True, kw_only=True):
    """What the deploy file says about one skill; see docs/deploy-file.md.

    Where `timeout_s` is None the mission's limit counts. Where `retries` is None the action is tried again
    once with `retry`, and else not.
    """

    retries: int | None = None
    timeout_s: float | None = None
    on_failure: OnFailure = "observe"

    @property
    def tries_again(self) -> int:
        """How often the same action is tried again before anything else follows."""
        return self.retries if self.retries is not None else int(self.on_failure == "retry")


_USUAL = SkillRule()


class Failures:
    """Counts failures in a row, of all skills and of the action that is tried again."""

    def __init__(self, rules: Mapping[str, SkillRule], limit: int) -> None:
        self._rules = rules
        self._limit = limit
        self._in_a_row = 0
        self._tries = 0
        self.to_retry: DecisionRecord | None = None
        self.to_hold = ""
        self.to_end = ""

    def rule(self, skill: str) -> SkillRule:
        return self._rules.get(skill, _USUAL)

    @property
    def retry_text(self) -> str:
        """Why the same action is taken once more."""
        assert self.to_retry is not None
        rule = self.rule(self.to_retry.skill)
        return f"it is tried again after a failure, {self._tries} of {rule.tries_again}"

    def take(self, decision: DecisionRecord, outcome: Outcome) -> None:
        """Says in `to_retry`, `to_hold` and `to_end` what follows."""
        self.to_retry, self.to_hold = None, ""
        if outcome.status == "observed":
            self._in_a_row = self._tries = 0
            return
        self._in_a_row += 1
        rule = self.rule(decision.skill)
        text = f"{decision.action}: {_said(outcome)}"
        if self._in_a_row >= self._limit:
            self.to_end = f"{self._in_a_row} activations in a row brought no observation, the last {text}"
        elif self._tries < rule.tries_again:
            self._tries += 1
            self.to_retry = decision
        else:
            self._tries = 0
            if rule.on_failure == "end":
                self.to_end = f"the deploy file ends the mission when {decision.skill} fails; {text}"
            elif rule.on_failure == "hold":
                self.to_hold = f"the mission holds: {text}"


def _said(outcome: Outcome) -> str:
    if outcome.fault is None:
        return outcome.status
    hint = f". {outcome.fault.hint}" if outcome.fault.hint else ""
    return f"{outcome.status}, {outcome.fault.code}: {outcome.fault.message}{hint}"
