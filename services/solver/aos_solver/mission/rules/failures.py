"""The consequences of activations that failed: for the belief, and for the mission.

docs/when-a-skill-fails.md has all rules.
"""

import math
from collections.abc import Collection, Mapping
from typing import Annotated, Literal

import msgspec

from aos_protocol.errors import ANOTHER_MAY_MOVE, AosError
from aos_protocol.messages import DecisionRecord, Outcome

OnFailure = Literal["observe", "retry", "hold", "end"]
_Seconds = Annotated[float, msgspec.Meta(gt=0, le=1e9)]

RAN_PROBABILITY = 0.5
"""A skill of which nobody knows ran with this probability, unless the deploy file says otherwise."""


class SkillRule(msgspec.Struct, frozen=True, kw_only=True):
    """The consequences of a skill's failure, as the deploy file has them.

    The same action is tried again up to `retries` times, by default once for `retry` and else never. Then
    `observe` goes on, `hold` waits for `aos resume`, and `end` ends the mission. `ran_probability` is how
    probable it is that the skill ran nevertheless, also where it reports a failure; without it, 0 where it
    reports one and 0.5 where nobody knows. `timeout_s` is the mission's `activation_timeout_s` if not given,
    `set_aside_after` and `set_aside_s` are the mission's.
    """

    retries: Annotated[int, msgspec.Meta(ge=0)] | None = None
    timeout_s: _Seconds | None = None
    ran_probability: Annotated[float, msgspec.Meta(ge=0, le=1)] | None = None
    set_aside_after: Annotated[int, msgspec.Meta(ge=1, le=2**31 - 1)] | None = None
    set_aside_s: _Seconds | None = None
    on_failure: OnFailure = "observe"

    @property
    def tries_again(self) -> int:
        """The number of times that the same action is tried again before anything else follows."""
        return self.retries if self.retries is not None else int(self.on_failure == "retry")


class FailureRules(msgspec.Struct, frozen=True, kw_only=True):
    """The mission's rules, and those of single skills."""

    skills: Mapping[str, SkillRule] = {}
    failure_limit: int = 30
    set_aside_after: int = 3
    set_aside_s: float = 300.0


_USUAL = SkillRule()


class Failures:
    """Counts failures: of the mission, of each skill in a row, and of the action that is tried again.

    A failure is an activation that failed or that nobody observed, and a report that the model excludes.
    """

    def __init__(self, rules: FailureRules | None = None) -> None:
        self._rules = rules or FailureRules()
        self._count = 0
        self._tries = 0
        self._setting_aside = SettingAside()
        self._may_move = ("", "")
        self.to_retry: DecisionRecord | None = None
        self.to_hold = ""
        self.to_end = ""

    def rule(self, skill: str) -> SkillRule:
        return self._rules.skills.get(skill, _USUAL)

    def ran_probability(self, outcome: Outcome) -> float:
        """Returns how probable it is that a skill ran which brought no observation. Refused, nothing was
        begun."""
        if outcome.status == "refused":
            return 0.0
        usual = 0.0 if outcome.status == "failed" else RAN_PROBABILITY
        given = self.rule(outcome.skill).ran_probability
        return usual if given is None else given

    def set_aside(self, now_s: float, announced: Mapping[str, int]) -> dict[str, str]:
        """The skills that nobody decides for now, each with the reason."""
        return self._setting_aside.reasons(now_s, announced)

    def s_until_return(self, now_s: float) -> float:
        """Returns how long it takes until a skill that is set aside comes back by itself."""
        return self._setting_aside.s_until_return(now_s)

    def renew(self, skills: Collection[str]) -> None:
        """Somebody has mended these, or has written them anew."""
        for skill in skills:
            self._setting_aside.renew(skill)

    @property
    def retry_text(self) -> str:
        """The reason why the same action is taken once more."""
        assert self.to_retry is not None
        rule = self.rule(self.to_retry.skill)
        return f"it is tried again after a failure, {self._tries} of {rule.tries_again}"

    def take(
        self,
        decision: DecisionRecord,
        outcome: Outcome,
        *,
        is_excluded: bool,
        surprise: float,
        now_s: float,
        announced: Mapping[str, int],
    ) -> str:
        """Says in `to_retry`, `to_hold` and `to_end` what follows; returns what people should be told.

        `is_excluded` says that the model excludes what was observed, and else it was so surprising.
        """
        self.to_retry, self.to_hold, self.to_end = None, "", ""
        skill, rule = decision.skill, self.rule(decision.skill)
        to_blame, status = self._to_blame(outcome)
        is_observed = outcome.status == "observed"
        said = _said(outcome, is_excluded)
        text = f"{decision.action}: {said}"
        if is_observed and not is_excluded and outcome.fault is None:
            self._tries = 0
            self._setting_aside.end_row(skill)
            return ""
        is_told = is_observed and not is_excluded
        weight = SettingAside.weight_of_told(surprise) if is_told else 1.0
        self._setting_aside.count(to_blame, weight, announced.get(to_blame, 0), status)
        if is_observed:
            self._tries = 0
        if not is_told:
            self._count += 1
        if self._count >= self._rules.failure_limit:
            self.to_end = f"{self._count} activations of the mission have failed, the last {text}"
        elif not is_observed:
            self._follow_rule(rule, decision, text)
        if self.to_hold or self.to_end:
            # Whoever lets the mission go on has looked after the skill.
            self._setting_aside.end_row(skill)
            return ""
        own = self.rule(to_blame)
        after = self._rules.set_aside_after if own.set_aside_after is None else own.set_aside_after
        pause_s = self._rules.set_aside_s if own.set_aside_s is None else own.set_aside_s
        reason = self._setting_aside.set_aside(to_blame, after, pause_s, now_s, said)
        if reason and to_blame == skill:
            self.to_retry, self._tries = None, 0
        return reason

    def _to_blame(self, outcome: Outcome) -> tuple[str, str]:
        """Returns the skill that a failure counts for, and the status that it ended with.

        Where an activation is refused because another skill may still be moving, that is the last one that
        was called, since nothing is called after it until it stands still.
        """
        if outcome.fault is None or outcome.fault.code != ANOTHER_MAY_MOVE:
            if outcome.status not in ("refused", "failed"):
                self._may_move = outcome.skill, outcome.status
            return outcome.skill, outcome.status
        return self._may_move if self._may_move[0] else (outcome.skill, outcome.status)

    def _follow_rule(self, rule: SkillRule, decision: DecisionRecord, text: str) -> None:
        if self._tries < rule.tries_again:
            self._tries += 1
            self.to_retry = decision
            return
        self._tries = 0
        if rule.on_failure == "end":
            self.to_end = f"the deploy file ends the mission when {decision.skill} fails; {text}"
        elif rule.on_failure == "hold":
            self.to_hold = f"the mission holds: {text}"


def _said(outcome: Outcome, is_excluded: bool) -> str:
    if is_excluded:
        said = outcome.response or "an empty text"
        return f"{said}, which the model excludes"
    what = outcome.response or outcome.status
    if outcome.fault is None:
        return what
    fault = outcome.fault
    return f"{what}, {AosError(fault.message, code=fault.code, hint=fault.hint)}"


_COUNTS_FULLY = math.log(10)
"""The surprise from which on a failure that a rule has told counts as a whole one: one in ten."""

_NOBODY_KNOWS = ("unknown", "timed_out", "cancelled")
"""The statuses after which an adapter may have ended, or still has to."""


class _Row(msgspec.Struct):
    """Failures in a row of one skill, and how often its adapter had announced itself by then.

    `restarts` counts the announcements between failures of which nobody knows how they ended: an adapter that
    has ended in a call, or after one, was started again.
    """

    announced: int
    failures: int = 0
    weight: float = 0.0
    restarts: int = 0
    last: str = ""

    @property
    def is_of_adapter(self) -> bool:
        """True where the adapter's start is part of the failure, and says nothing new of the skill."""
        return self.last == "unknown" or (self.last in _NOBODY_KNOWS and self.restarts > 0)


class _Pause(msgspec.Struct, frozen=True):
    ends_at_s: float
    announced: int | None
    """None where an announcement does not end it."""
    reason: str


class SettingAside:
    """Counts each skill's failures in a row, whatever else ran between, and knows which are set aside.

    An adapter that announces itself anew begins a new row, and ends the pause of its skills, unless its start
    is what follows from the failures themselves.
    """

    def __init__(self) -> None:
        self._rows: dict[str, _Row] = {}
        self._pauses: dict[str, _Pause] = {}

    @staticmethod
    def weight_of_told(surprise: float) -> float:
        """Returns the weight of a failure that a rule has told: the more probable the model holds it, the
        less."""
        return min(max(surprise, 0.0) / _COUNTS_FULLY, 1.0)

    def count(self, skill: str, weight: float, announced: int, status: str) -> None:
        """One more failure in a row, with the status of its outcome."""
        row = self._rows.get(skill)
        if row is None or (row.announced != announced and row.last not in _NOBODY_KNOWS):
            row = self._rows[skill] = _Row(announced)
        row.restarts += row.announced != announced
        row.announced = announced
        # What is refused has begun nothing: it tells nothing of how the adapter ended.
        if status != "refused" or not row.last:
            row.last = status
        row.failures += 1
        row.weight += weight

    def end_row(self, skill: str) -> None:
        """The skill did what it should, or somebody has looked after it."""
        self._rows.pop(skill, None)

    def renew(self, skill: str) -> None:
        """The skill is another one: its row and its pause are over."""
        self.end_row(skill)
        self._pauses.pop(skill, None)

    def set_aside(self, skill: str, after: int, pause_s: float, now_s: float, last: str) -> str:
        """Sets a skill aside whose row counts for `after` failures; the reason, empty if it does not."""
        row = self._rows.get(skill)
        if row is None or row.weight < after - 1e-9:
            return ""
        count = f"{row.failures} failures in a row" if row.failures > 1 else "a failure"
        reason = f"{skill} is set aside for {pause_s:g} s after {count}, the last {last}"
        announced = None if row.is_of_adapter else row.announced
        self._pauses[skill] = _Pause(now_s + pause_s, announced, reason)
        return reason

    def reasons(self, now_s: float, announced: Mapping[str, int]) -> dict[str, str]:
        for skill, pause in list(self._pauses.items()):
            has_come_anew = pause.announced not in (None, announced.get(skill, 0))
            if has_come_anew:
                self._rows.pop(skill, None)
            if has_come_anew or now_s >= pause.ends_at_s:
                del self._pauses[skill]
        return {skill: pause.reason for skill, pause in self._pauses.items()}

    def s_until_return(self, now_s: float) -> float:
        """Returns how long it takes until the next skill comes back by itself; infinite where none is set
        aside."""
        return min((pause.ends_at_s - now_s for pause in self._pauses.values()), default=math.inf)
