"""The choice to end the mission at any time, as one more action."""

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from aos_solver.offline.explicit_model import ExplicitModel, with_more_outcomes

STOP = "stop"


def with_stopping(model: ExplicitModel, value: float) -> ExplicitModel:
    """The model with a last action `stop`, which is worth `value` wherever the mission goes on.

    It leads to one more state, the last one, that nothing leaves and nothing is worth anything in.
    """
    states, actions = len(model.states), len(model.actions)
    state, action = np.divmod(model.outcomes.row_numbers, actions)
    stops = np.arange(states) * (actions + 1) + actions
    more = np.r_[stops, states * (actions + 1) + np.arange(actions + 1)]
    rows, row_count = state * (actions + 1) + action, (states + 1) * (actions + 1)
    outcomes, sensings = with_more_outcomes(model, rows, row_count, more, states, np.ones(len(more)))
    rewards = np.zeros((states + 1, actions + 1))
    rewards[:states, :actions] = model.rewards
    rewards[:states, actions] = np.where(over_states(model), 0.0, value)
    return replace(
        model,
        states=(*model.states, "stopped"),
        actions=(*model.actions, STOP),
        observations=(*model.observations, "stopped"),
        rewards=rewards,
        outcomes=outcomes,
        sensings=sensings,
        likelihoods=model.likelihoods.with_certain_row(len(model.observations)),
    )


def over_states(model: ExplicitModel) -> NDArray[np.bool_]:
    """The states that nothing leaves and in which nothing is worth anything."""
    actions = len(model.actions)
    state = model.outcomes.row_numbers // actions
    is_left = np.zeros(len(model.states), dtype=bool)
    is_left[state[model.outcomes.numbers != state]] = True
    is_free: NDArray[np.bool_] = (model.rewards == 0).all(axis=1)
    return ~is_left & is_free
