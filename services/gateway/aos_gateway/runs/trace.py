"""A mission's steps for views: one row for each step, small enough to hold a thousand of them.

A decision record says all of one step. Views over time need little of each: what was chosen, by how much,
what was expected and seen, and the belief. A row has of the belief what is another than in the row before.
"""

import math
from collections.abc import Iterable

import msgspec

from aos_protocol.messages import ActionValue, BeliefSummary, DecisionRecord, Marginal, ModelDrift

_DIGITS = 4
_SHOWN_VALUES = 8
_SHOWN_RESPONSES = 50
_CERTAIN = 1e-9
_KEPT_TRACES = 8

Told = dict[str, float] | tuple[float, ...]
"""The distribution of a variable: probabilities of values, or quantiles."""


class Endings(msgspec.Struct, frozen=True, omit_defaults=True):
    """The chances of the endings in a belief, and its entropy in nats."""

    goal: float
    failure: float = 0.0
    over: float = 0.0
    entropy: float = 0.0


class Step(msgspec.Struct, omit_defaults=True):
    """One step of a mission.

    `sequence` is that of the newest record about it. `value` and `error` are of the chosen action, `second`
    is the best of the others, `margin` is how much better the chosen one is, and `is_proven` says that it is
    proven to be no worse. `predicted` are the likeliest responses with their probabilities, and `…` stands
    for all others; `seen` is the response, `expected` its probability. `belief` are the variables
    whose distribution is another one than before this decision, `after` those that the outcome has changed:
    value to probability, with `…` for all values that are not listed, or the quantiles of a number, as in
    Marginal. `drift` are the alarms that stand of
    the skill, as in DecisionRecord.
    """

    step: int
    sequence: int
    action: str
    skill: str
    decided_ms: int
    value: float | None = None
    error: float | None = None
    second: str = ""
    second_value: float | None = None
    second_error: float | None = None
    margin: float | None = None
    is_proven: bool = False
    actions: int = 0
    planner: str = ""
    simulations: int = 0
    planning_s: float = 0.0
    revision: int = 0
    chosen_by: str = ""
    adopted: str = ""
    predicted: dict[str, float] = {}
    endings: Endings | None = None
    belief: dict[str, Told] = {}
    status: str = ""
    seen: str = ""
    expected: float | None = None
    surprise: float = 0.0
    impossible: bool = False
    stopped_by: str = ""
    fault: str = ""
    remark: str = ""
    started_ms: int = 0
    ended_ms: int = 0
    endings_after: Endings | None = None
    after: dict[str, Told] = {}
    drift: tuple[ModelDrift, ...] = ()


class Trace(msgspec.Struct, frozen=True):
    """The steps of a mission up to the record before `next`, the sequence number to go on from.

    Where `first` is not 1, the steps before it are left out. `draws` says that the documents of the last one
    draw the state.
    """

    mission: str
    next: int
    first: int
    steps: tuple[Step, ...]
    draws: bool = False


class Steps:
    """Rows out of records, one after the other. `whole` rows name every variable, not only changed ones."""

    def __init__(self, *, whole: bool = False) -> None:
        self._whole = whole
        self._known: dict[str, Told] = {}
        self.by_number: dict[int, Step] = {}
        self.next = 0

    def take(self, record: DecisionRecord) -> Step:
        """The row of the step that the record is about, with what the record adds to it."""
        self.next = record.sequence + 1
        row = self.by_number.get(record.step)
        if row is None or record.outcome is None:
            row = self.by_number[record.step] = self._decided(record)
        if record.outcome is not None:
            self._observed(row, record)
        return row

    def _decided(self, record: DecisionRecord) -> Step:
        chosen = next((value for value in record.actions if value.action == record.action), None)
        second = _second(record)
        row = Step(
            step=record.step,
            sequence=record.sequence,
            action=record.action,
            skill=record.skill,
            decided_ms=record.stamp_ns // 1_000_000,
            actions=len(record.actions),
            planner=record.planner,
            simulations=record.simulations,
            planning_s=_short(record.planning_s) or 0.0,
            revision=record.revision,
            chosen_by="" if record.chosen_by == "planner" else record.chosen_by,
            predicted=_likeliest(record),
        )
        if chosen is not None:
            row.value, row.error = _short(chosen.q), _short(chosen.stderr)
        if second is not None:
            row.second, row.second_value, row.second_error = (
                second.action,
                _short(second.q),
                _short(second.stderr),
            )
            row.margin = _short(chosen.q - second.q) if chosen is not None else None
            row.is_proven = chosen is not None and _is_proven(chosen, second)
        if record.adopted is not None:
            row.adopted = f"revision {record.adopted.revision}, its belief by {record.adopted.by}"
        if record.outcome is None:
            row.endings, row.belief = _endings(record.belief), self._changed(record.belief)
        return row

    def _observed(self, row: Step, record: DecisionRecord) -> None:
        outcome = record.outcome
        assert outcome is not None
        row.sequence = record.sequence
        row.status, row.seen = outcome.status, outcome.response
        predicted = {each.response: each.probability for each in record.predicted}
        if outcome.response in predicted:
            row.expected = _probability(predicted[outcome.response])
        row.surprise, row.impossible = _short(record.surprise) or 0.0, record.is_impossible
        row.stopped_by, row.remark, row.drift = outcome.stopped_by, record.remark, record.drift
        row.fault = outcome.fault.message if outcome.fault is not None else ""
        row.started_ms, row.ended_ms = outcome.started_ns // 1_000_000, outcome.ended_ns // 1_000_000
        row.endings_after, row.after = _endings(record.belief), self._changed(record.belief)

    def _changed(self, belief: BeliefSummary) -> dict[str, Told]:
        changed = {}
        for marginal in belief.marginals:
            told = _told(marginal)
            if self._whole or self._known.get(marginal.variable) != told:
                changed[marginal.variable] = self._known[marginal.variable] = told
        return changed


class Traces:
    """The traces that were asked for last: pages are loaded anew, and several look at one mission."""

    def __init__(self) -> None:
        self._kept: dict[tuple[str, int], Trace] = {}

    def get(self, mission: str, steps: int) -> Trace | None:
        """The trace of at most so many steps as it was made last; None if it is not there."""
        return self._kept.get((mission, steps))

    def keep(self, steps: int, trace: Trace) -> None:
        """Keeps a trace, and lets go of the oldest."""
        self._kept.pop((trace.mission, steps), None)
        self._kept[trace.mission, steps] = trace
        while len(self._kept) > _KEPT_TRACES:
            del self._kept[next(iter(self._kept))]


def steps_of(mission: str, records: Iterable[DecisionRecord]) -> Trace:
    """The trace of records in order."""
    steps = Steps()
    for record in records:
        steps.take(record)
    rows = tuple(steps.by_number[number] for number in sorted(steps.by_number))
    return Trace(mission, steps.next, rows[0].step if rows else 1, rows)


def _second(record: DecisionRecord) -> ActionValue | None:
    """The best of the other actions that could have been chosen."""
    barred = record.deciding_search.barred if record.deciding_search is not None else {}
    known = (value for value in record.actions if value.is_known(record.simulations))
    others = (value for value in known if value.action != record.action and value.action not in barred)
    return max(others, key=lambda value: value.q, default=None)


def _is_proven(chosen: ActionValue, second: ActionValue) -> bool:
    """Returns whether what is proven of both actions tells that the chosen one is no worse."""
    least, most = chosen.at_least, second.at_most
    return least is not None and most is not None and least >= most


def _likeliest(record: DecisionRecord) -> dict[str, float]:
    likely = sorted(record.predicted, key=lambda each: -each.probability)
    found = {each.response: _probability(each.probability) for each in likely[:_SHOWN_RESPONSES]}
    if rest := likely[_SHOWN_RESPONSES:]:
        found["…"] = _probability(sum(each.probability for each in rest))
    return found


def _told(marginal: Marginal) -> Told:
    if marginal.quantiles:
        return tuple(float(f"{each:.5g}") for each in marginal.quantiles)
    likely = list(marginal.values.items())
    values = {value: _probability(each) for value, each in likely[:_SHOWN_VALUES] if each >= 0.00005}
    others = marginal.others + sum(each for _, each in likely[_SHOWN_VALUES:])
    if others >= 0.00005:
        values["…"] = _probability(others)
    return values


def _endings(belief: BeliefSummary) -> Endings:
    return Endings(
        _probability(belief.goal_probability),
        _probability(belief.failure_probability),
        _probability(belief.over_probability),
        _short(belief.entropy) or 0.0,
    )


def _probability(value: float) -> float:
    """Four digits; what is not certain, to a billionth, is not rounded to certainty."""
    rounded = round(value, _DIGITS)
    return 0.9999 if rounded == 1.0 and value < 1.0 - _CERTAIN else rounded


def _short(value: float) -> float | None:
    """Nine digits: the two decimals that people see are those of the record, of thousands, too."""
    return float(f"{value:.9g}") if math.isfinite(value) else None
