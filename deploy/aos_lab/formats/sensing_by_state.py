"""Models as problem files want them: action and next state alone decide about the observation."""

import msgspec
import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

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
