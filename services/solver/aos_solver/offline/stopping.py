"""The choice to end the mission at any time, as one more action."""

from __future__ import annotations

import msgspec
import numpy as np
from numpy.typing import NDArray

from aos_solver.offline.explicit_model import ExplicitModel, Ragged

__all__ = ["STOP", "with_stopping"]

STOP = "stop"


def with_stopping(model: ExplicitModel, value: float) -> ExplicitModel:
    """The model with a last action `stop`, which is worth `value` wherever the mission goes on.

    It leads to one more state, the last one, that nothing leaves and nothing is worth anything in.
    """
    states, actions = len(model.states), len(model.actions)
    stopped, nothing = states, len(model.observations)
    lengths = np.diff(model.outcomes.first).reshape(states, actions)
    lengths = np.hstack([lengths, np.ones((states, 1), dtype=np.int64)])
    lengths = np.vstack([lengths, np.ones((1, actions + 1), dtype=np.int64)])
    first = np.r_[0, np.cumsum(lengths)]
    silent = len(model.likelihoods)
    is_new = np.ones(int(first[-1]), dtype=bool)
    rows = model.outcomes.row_numbers
    old_state, old_action = np.divmod(rows, actions)
    offset = np.arange(len(rows)) - model.outcomes.first[rows]
    kept = first[old_state * (actions + 1) + old_action] + offset
    is_new[kept] = False
    after = np.full(len(is_new), stopped)
    sensings = np.full(len(is_new), silent)
    probabilities = np.ones(len(is_new))
    after[kept], sensings[kept] = model.outcomes.numbers, model.sensings
    probabilities[kept] = model.outcomes.probabilities
    rewards = np.zeros((states + 1, actions + 1))
    rewards[:states, :actions] = model.rewards
    rewards[:states, actions] = np.where(_is_over(model), 0.0, value)
    likelihoods = Ragged(
        np.r_[model.likelihoods.first, len(model.likelihoods.numbers) + 1],
        np.r_[model.likelihoods.numbers, nothing],
        np.r_[model.likelihoods.probabilities, 1.0],
    )
    return msgspec.structs.replace(
        model,
        states=(*model.states, "stopped"),
        actions=(*model.actions, STOP),
        observations=(*model.observations, "stopped"),
        rewards=rewards,
        outcomes=Ragged(first, after, probabilities),
        sensings=sensings,
        likelihoods=likelihoods,
    )


def _is_over(model: ExplicitModel) -> NDArray[np.bool_]:
    """The states that nothing leaves and in which nothing is worth anything."""
    actions = len(model.actions)
    state = model.outcomes.row_numbers // actions
    is_left = np.zeros(len(model.states), dtype=bool)
    is_left[state[model.outcomes.numbers != state]] = True
    is_free: NDArray[np.bool_] = (model.rewards == 0).all(axis=1)
    return ~is_left & is_free
