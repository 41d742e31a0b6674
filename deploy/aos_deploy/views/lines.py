"""One line for each event: for pipes and logs, and as JSON for programs."""

import math
import sys
import time
from collections.abc import Mapping
from typing import Any, Self

from aos_deploy.events import Event, ServiceChanged, Told, event_json
from aos_deploy.views.values import Digits, by_worth
from aos_protocol import messages
from aos_protocol.chances import chance_text
from aos_protocol.diagnostics import render

_TELLING_AGAIN_S = 5.0
_SHOWN_MOVES = 8
_SHOWN_ACTIONS = 6
"""The best of them; with more, a line of a terminal becomes a paragraph. `--json` has all."""

_SHOWN_PREPARATION_S = 0.1
_LONGEST_WORDS = 600
"""A robot's error may have kilobytes. With hints, and errors of several skills, ours have less."""


class _Lines:
    """A view that has nothing to end."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return


class PlainView(_Lines):
    """Prints `lines_of` each event but a skill's progress. Of a mission's state it prints what is news.

    How far a decision is, is news every five seconds, and when the solver does something else for it.
    """

    def __init__(self) -> None:
        self._last = ("", 0, "")
        """The mission, step and remark that were told last."""
        self._last_told_s = 0.0

    def __call__(self, event: Event) -> None:
        if isinstance(event, messages.SkillProgress):
            return
        if isinstance(event, messages.MissionState):
            # What acts is in the decision's own line.
            told = (event.mission, event.step, event.remark)
            if not event.remark or told == self._last or event.phase == "acting":
                return
            if event.phase == "planning" and not self._is_due(event.remark):
                return
            self._last = told
            self._last_told_s = time.monotonic()
        for line in lines_of(event):
            print(line, flush=True)

    def _is_due(self, remark: str) -> bool:
        is_the_same_work = remark.partition(":")[0] == self._last[2].partition(":")[0]
        return not is_the_same_work or time.monotonic() >= self._last_told_s + _TELLING_AGAIN_S


class JsonView(_Lines):
    """Prints each event as one JSON object."""

    def __call__(self, event: Event) -> None:
        sys.stdout.write(event_json(event) + "\n")
        sys.stdout.flush()


def lines_of(event: Event) -> list[str]:
    """An event as text for people."""
    return [
        line if isinstance(event, Told | messages.BundleReport) else on_one_line(line)
        for line in _lines(event)
    ]


def on_one_line(text: str) -> str:
    """The text without line ends, and without letters that a terminal takes for commands: robots say both."""
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() else " " for letter in text)


def shortened(text: str) -> str:
    """The text, of a long one its beginning, and where all of it is."""
    left = len(text) - _LONGEST_WORDS
    return text if left <= 0 else f"{text[:_LONGEST_WORDS]}... and {left} letters more: aos decisions --json"


def _lines(event: Event) -> list[str]:
    match event:
        case ServiceChanged():
            detail = f": {event.detail}" if event.detail else ""
            return [f"{event.after_s:7.2f} s  {event.service} {event.state}{detail}"]
        case Told():
            return [event.text]
        case messages.DecisionRecord():
            return [*([] if event.adopted is None else [adopted_line(event.adopted)]), decision_line(event)]
        case messages.MissionState():
            remark = shortened(event.remark)
            return [f"mission {event.phase}: {remark}" if remark else f"mission {event.phase}"]
        case messages.BundleReport():
            return _report_lines(event)
        case messages.SkillProgress():
            return [f"{event.path} {event.state} {event.progress:.0%} {event.text}".rstrip()]


def adopted_line(adopted: messages.ModelAdopted) -> str:
    """Says which model has taken over, how it came to its belief, and which variables that has moved."""
    by: str = adopted.by
    if adopted.by == "replay":
        foreign = f", {adopted.foreign} of them counted for nothing" if adopted.foreign else ""
        by = f"replay of {adopted.steps} steps{foreign}"
    moved = sorted(adopted.moved.items(), key=lambda each: -each[1])
    shown = [f"{name} by {distance:.3f}" for name, distance in moved[:_SHOWN_MOVES]]
    more = f" and {len(moved) - _SHOWN_MOVES} more" if len(moved) > _SHOWN_MOVES else ""
    what = f"; moved: {', '.join(shown)}{more}" if shown else ""
    why = f" ({adopted.why})" if adopted.why else ""
    return f"revision {adopted.revision} takes over from {adopted.before}, its belief by {by}{why}{what}"


def decision_line(record: messages.DecisionRecord) -> str:
    """A decision with what the best actions are worth, or what came of it."""
    head = f"step {record.step:2}: {record.action}"
    if record.outcome is None:
        others = by_worth(record.actions, record.simulations)
        best = others[:_SHOWN_ACTIONS]
        digits = Digits.of((action.q for action in best), 2)
        shown = [_value(action, digits) for action in best]
        if len(others) > len(shown):
            shown.append(f"{len(others) - len(shown)} more")
        values = f"[{', '.join(shown)}]  " if shown else ""
        risks = "".join(f"  ({risk_text(constraint)})" for constraint in record.constraints)
        worth = max((action.q for action in others if action.action == record.action), default=math.inf)
        is_kept_back = bool(others) and others[0].q > worth and effort_text(record) != record.why
        why = f"  ({record.why})" if is_kept_back and record.why else ""
        return f"{head}  {values}{effort_text(record)}{risks}{why}"
    outcome = record.outcome
    is_observed = outcome.status == "observed"
    what = observation_text(outcome.response, outcome.numbers) if is_observed else outcome.status
    if outcome.stopped_by:
        what = f"{what} (stopped by {outcome.stopped_by})"
    if outcome.fault is not None:
        what = f"{what} ({shortened(outcome.fault.message)})"
    what += "".join(f", {monitor}: {response}" for monitor, response in outcome.monitors.items())
    surprise = "held impossible by the model" if record.is_impossible else f"surprise {record.surprise:.2f}"
    remark = f"  ({shortened(record.remark)})" if record.remark else ""
    return f"{head} -> {what}  {surprise}  {endings_text(record.belief)}{remark}"


def _value(action: messages.ActionValue, digits: Digits) -> str:
    """`pick +2.71 ± 0.04`; an error that rounds to nothing is left out."""
    error = f" ± {digits.plain(action.stderr)}" if action.stderr >= digits.half_unit else ""
    return f"{action.action} {digits.signed(action.q)}{error}"


def effort_text(record: messages.DecisionRecord) -> str:
    """Says who decided, and with how much work; short."""
    if record.chosen_by in ("operator", "script"):
        return record.why
    took, prepared_s = f"in {record.planning_s:.2f} s", record.preparation_s
    prepared = f", {prepared_s:.2f} of them preparation" if prepared_s > _SHOWN_PREPARATION_S else ""
    if not record.simulations:
        by = f"{record.planner} without a search" if record.planner else ""
        return f"{by} {took}{prepared}"
    by = f"{record.planner}, " if record.planner else ""
    threads = f" by {record.threads} threads" if record.threads > 1 else ""
    return f"{by}{record.simulations} simulations {took}{threads}{prepared}"


def risk_text(constraint: messages.ConstraintRisk) -> str:
    """Says what a decision risks, and what it may."""
    sign = "about " if constraint.is_sampled else ""
    bound = f"{constraint.left:.3g} left of {constraint.probability:g}"
    return f"risks {sign}{constraint.risk:.3g}, {bound}: never {constraint.never}"


def endings_text(belief: messages.BeliefSummary) -> str:
    """Says how probable the goal is, and each other ending that is likelier than one in two thousand.

    In brackets stands how probable the goal is if nothing ran that was not observed, where that differs.
    """
    others = {"over": belief.over_probability, "failure": belief.failure_probability}
    shown = [f"{name} {chance_text(odds)}" for name, odds in others.items() if odds >= 0.0005]
    of_cautious = belief.cautious
    cautious = "" if of_cautious is None else f" (cautious {chance_text(of_cautious.goal_probability)})"
    return "  ".join([f"goal {chance_text(belief.goal_probability)}{cautious}", *shown])


def _report_lines(report: messages.BundleReport) -> list[str]:
    lines = [render(diagnostic) for diagnostic in report.diagnostics]
    if not report.is_accepted:
        waits = "; it is tried again when the project changes" if report.is_waiting else ""
        subject = f"bundle {report.source}" if report.source else f"a change of {report.project}"
        return [*lines, f"{subject} refused, nothing has changed{waits}"]
    revision = f"{report.project} revision {report.revision}"
    subject = f"bundle {report.source}: " if report.source else ""
    return [*lines, f"{subject}{revision}, {changes_text(report)}"]


def changes_text(report: messages.BundleReport) -> str:
    """Says which skills a bundle has brought, changed or taken away."""
    changes = {"added": report.added, "changed": report.changed, "removed": report.removed}
    new = [f"{verb} {', '.join(names)}" for verb, names in changes.items() if names]
    return "; ".join(new) or "nothing new"


def observation_text(response: str, numbers: Mapping[str, Any]) -> str:
    """`scanned (beams = 1.2 3.4, tilt = 0.12)`; a number that is missing in an array is a dash, an empty
    text `""`."""
    response = response or '""'
    shown = ", ".join(f"{name} = {_numbers(value)}" for name, value in numbers.items())
    return f"{response} ({shown})" if shown else response


def _numbers(value: Any) -> str:
    values = value if isinstance(value, list | tuple) else [value]
    return " ".join("-" if element is None else f"{element:.4g}" for element in values)
