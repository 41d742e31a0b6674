"""Writes `.pomdp` and `.pomdpx`, where action and next state alone decide about the observation."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from xml.sax.saxutils import escape

import msgspec
import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from aos_lab.formats import problem_ending
from aos_lab.formats.symbols import symbols
from aos_protocol.errors import PlanningError
from aos_solver.offline.explicit_model import ExplicitModel, Integers, Ragged, StartBelief

NEVER = -1


class SensingByState(msgspec.Struct, frozen=True):
    """A model, and for (action, state) the row of `model.likelihoods`; NEVER where no outcome needs it."""

    model: ExplicitModel
    rows: Integers


def with_sensing_by_state(model: ExplicitModel) -> SensingByState:
    """The model; states in which more than the action decides are there once for each way to sense.

    Values and policies stay the same: such copies differ only in what was observed on the way to them.
    """
    actions = len(model.actions)
    after, sensing = model.outcomes.numbers, model.sensings
    action = model.outcomes.row_numbers % actions
    combinations = np.unique(np.stack([after, action, sensing], axis=1), axis=0)
    same = (combinations[1:, :2] == combinations[:-1, :2]).all(axis=1)
    split = np.unique(combinations[1:][same][:, 0])
    if not len(split):
        rows = np.full((actions, len(model.states)), NEVER)
        rows[action, after] = sensing
        return SensingByState(model, rows)
    return _split(model, action, np.isin(after, split))


def _split(model: ExplicitModel, action: Integers, is_split: NDArray[np.bool_]) -> SensingByState:
    """A copy for every sensing of the states that need one; outcomes lead to their own copy."""
    actions = len(model.actions)
    after = model.outcomes.numbers
    kept = np.setdiff1d(np.arange(len(model.states)), after[is_split])
    pairs = np.unique(np.stack([after[is_split], model.sensings[is_split]], axis=1), axis=0)
    originals = np.concatenate([kept, pairs[:, 0]])
    order = np.argsort(originals, kind="stable")
    originals = originals[order]
    ways = np.concatenate([np.full(len(kept), NEVER), pairs[:, 1]])[order]
    first = np.searchsorted(originals, np.arange(len(model.states)))
    number = {(int(s), int(way)): place for place, (s, way) in enumerate(zip(originals, ways, strict=True))}
    target = np.array(
        [
            number[state, way if copied else NEVER]
            for state, way, copied in zip(after.tolist(), model.sensings.tolist(), is_split, strict=True)
        ]
    )
    rows = np.full((actions, len(originals)), NEVER)
    rows[action, target] = model.sensings
    copied_rows = (originals[:, None] * actions + np.arange(actions)).ravel()
    lengths = np.diff(model.outcomes.first)[copied_rows]
    elements = _ranges(model.outcomes.first[copied_rows], lengths)
    outcomes = Ragged(np.r_[0, np.cumsum(lengths)], target[elements], model.outcomes.probabilities[elements])
    copies = replace(
        model,
        states=tuple(model.states[s] for s in originals),
        rewards=model.rewards[originals],
        outcomes=outcomes,
        sensings=model.sensings[elements],
        starts=tuple(
            StartBelief(start.weight, first[start.states], start.probabilities) for start in model.starts
        ),
    )
    return SensingByState(copies, rows)


def _ranges(first: Integers, lengths: Integers) -> Integers:
    """The numbers `first[k]`, `first[k] + 1`, ... of all k, `lengths[k]` each."""
    begins = np.r_[0, np.cumsum(lengths)[:-1]]
    return np.repeat(first - begins, lengths) + np.arange(int(lengths.sum()))


_LATER = "later"


def write_problem(model: ExplicitModel, path: Path) -> None:
    """Writes the model in the format that the file's name says.

    PlanningError AOS320 for a name or a model that no format is for, AOS101 where the disk refuses.
    """
    if problem_ending(path) not in WRITERS:
        formats = " or ".join(WRITERS)
        raise PlanningError(f"{path} names no format", code="AOS320", hint=f"Let it end in {formats}")
    lines = WRITERS[problem_ending(path)](with_sensing_by_state(model))
    try:
        with path.open("w") as file:
            file.writelines(f"{line}\n" for line in lines)
    except OSError as error:
        raise PlanningError(f"cannot write {path}: {error.strerror}", code="AOS101") from error


class _Names:
    """The names of states, actions and observations in the file."""

    def __init__(self, model: ExplicitModel) -> None:
        self.states = symbols(model.states)
        self.actions = symbols(model.actions)
        self.observations = symbols(model.observations)


def _transitions(model: ExplicitModel, names: _Names) -> Iterator[tuple[str, str, str, float]]:
    """Action, state, next state and probability."""
    for row in range(len(model.outcomes)):
        state, action = divmod(row, len(model.actions))
        for after, probability in zip(*model.outcomes.row(row), strict=True):
            yield names.actions[action], names.states[state], names.states[after], float(probability)


def _observations(sensing: SensingByState, names: _Names) -> Iterator[tuple[str, str, str, float]]:
    """Action, next state, observation and probability, where there is a rule."""
    for action, rows in enumerate(sensing.rows):
        for state, row in enumerate(rows):
            if row == NEVER:
                # Never reached by this action; the formats want a distribution all the same.
                yield names.actions[action], names.states[state], names.observations[0], 1.0
                continue
            for observation, probability in zip(*sensing.model.likelihoods.row(row), strict=True):
                yield (
                    names.actions[action],
                    names.states[state],
                    names.observations[observation],
                    float(probability),
                )


def _rewards(model: ExplicitModel, names: _Names) -> Iterator[tuple[str, str, float]]:
    """Action, state and reward, where it is not 0."""
    for state, action in zip(*model.rewards.nonzero(), strict=True):
        yield names.actions[action], names.states[state], float(model.rewards[state, action])


def _pomdp(sensing: SensingByState) -> Iterator[str]:
    model = sensing.model
    if len(model.starts) > 1:
        message = f"the robot is told at the start of {model.name} where it is, which .pomdp cannot say"
        raise PlanningError(message, code="AOS320", hint="Write a .pomdpx file")
    names = _Names(model)
    yield f"# {model.name}"
    yield f"discount: {model.discount!r}"
    yield "values: reward"
    yield f"states: {' '.join(names.states)}"
    yield f"actions: {' '.join(names.actions)}"
    yield f"observations: {' '.join(names.observations)}"
    yield f"start: {' '.join(repr(float(p)) for p in model.start_distribution())}"
    for action, state, after, probability in _transitions(model, names):
        yield f"T: {action} : {state} : {after} {probability!r}"
    for action, state, observation, probability in _observations(sensing, names):
        yield f"O: {action} : {state} : {observation} {probability!r}"
    for action, state, reward in _rewards(model, names):
        yield f"R: {action} : {state} : * : * {reward!r}"


def _pomdpx(sensing: SensingByState) -> Iterator[str]:
    """One state variable for all; a second one only tells how the robot starts, where it is told."""
    model = sensing.model
    names = _Names(model)
    is_reported = len(model.starts) > 1
    starts = [f"start{number}" for number in range(len(model.starts))]
    yield '<?xml version="1.0" encoding="utf-8"?>'
    yield '<pomdpx version="1.0">'
    yield f"<Description>{escape(model.name)}</Description>"
    yield f"<Discount>{model.discount!r}</Discount>"
    yield "<Variable>"
    yield from _variable("StateVar", 'vnamePrev="state_0" vnameCurr="state_1" fullyObs="false"', names.states)
    if is_reported:
        attributes = 'vnamePrev="reported_0" vnameCurr="reported_1" fullyObs="true"'
        yield from _variable("StateVar", attributes, [*starts, _LATER])
    yield from _variable("ObsVar", 'vname="observation"', names.observations)
    yield from _variable("ActionVar", 'vname="action"', names.actions)
    yield '<RewardVar vname="reward"/>'
    yield "</Variable>"
    yield "<InitialStateBelief>"
    if is_reported:
        weights = [(name, start.weight) for name, start in zip(starts, model.starts, strict=True)]
        yield from _table("CondProb", "reported_0", "null", "ProbTable", weights)
    yield from _table(
        "CondProb",
        "state_0",
        "reported_0" if is_reported else "null",
        "ProbTable",
        (
            (f"{name} {names.states[state]}" if is_reported else names.states[state], float(probability))
            for name, start in zip(starts, model.starts, strict=True)
            for state, probability in zip(start.states, start.probabilities, strict=True)
        ),
    )
    yield "</InitialStateBelief>"
    yield "<StateTransitionFunction>"
    transitions = _by_place(_transitions(model, names))
    yield from _table("CondProb", "state_1", "action state_0", "ProbTable", transitions)
    if is_reported:
        yield from _table("CondProb", "reported_1", "null", "ProbTable", [(_LATER, 1.0)])
    yield "</StateTransitionFunction>"
    yield "<ObsFunction>"
    observations = _by_place(_observations(sensing, names))
    yield from _table("CondProb", "observation", "action state_1", "ProbTable", observations)
    yield "</ObsFunction>"
    yield "<RewardFunction>"
    rewards = _by_place(_rewards(model, names))
    yield from _table("Func", "reward", "action state_0", "ValueTable", rewards)
    yield "</RewardFunction>"
    yield "</pomdpx>"


def _variable(tag: str, attributes: str, values: Iterable[str]) -> Iterator[str]:
    yield f"<{tag} {attributes}>"
    yield f"<ValueEnum>{' '.join(values)}</ValueEnum>"
    yield f"</{tag}>"


def _by_place(entries: Iterable[tuple[*tuple[str, ...], float]]) -> Iterator[tuple[str, float]]:
    return ((" ".join(where), number) for *where, number in entries)


def _table(
    tag: str, own: str, parents: str, numbers: str, entries: Iterable[tuple[str, float]]
) -> Iterator[str]:
    yield f"<{tag}>"
    yield f"<Var>{own}</Var>"
    yield f"<Parent>{parents}</Parent>"
    yield '<Parameter type="TBL">'
    for instance, number in entries:
        yield f"<Entry><Instance>{instance}</Instance><{numbers}>{number!r}</{numbers}></Entry>"
    yield "</Parameter>"
    yield f"</{tag}>"


WRITERS = {".pomdp": _pomdp, ".pomdpx": _pomdpx}
"""The formats by the ending of a file's name."""
