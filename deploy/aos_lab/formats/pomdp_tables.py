"""The model that the tables of a `.pomdp` file say, in which outcomes share equal observations."""

from collections.abc import Callable, Mapping

import msgspec
import numpy as np

from aos_lab.formats.pomdp_rewards import RewardRules
from aos_solver.offline.explicit_model import ExplicitModel, Ragged, StartBelief

Distribution = dict[int, float]


class PomdpTables(msgspec.Struct, frozen=True):
    """The probabilities of next states by action and state, and of observations by action and next state; the
    rewards, and the start. Where all `is_seen`, whoever acts sees the state."""

    transitions: Mapping[tuple[int, int], Distribution]
    sensing: Mapping[tuple[int, int], Distribution]
    rewards: RewardRules
    start: Distribution
    is_seen: bool

    def sensing_of(self, action: int) -> Callable[[int], Distribution]:
        """The observations after an action, by the next state."""
        return lambda state: self.sensing[action, state]


def explicit_model(
    name: str, discount: float, names: Mapping[str, tuple[str, ...]], tables: PomdpTables
) -> ExplicitModel:
    """The model of complete tables; `names` are those of states, actions and observations."""
    actions, states = names["actions"], names["states"]
    known: dict[tuple[tuple[int, float], ...], int] = {}
    first, after, chances, sensings = [0], [], [], []
    rewards = np.zeros((len(states), len(actions)))
    for state in range(len(states)):
        for action in range(len(actions)):
            row = tables.transitions[action, state]
            for number, probability in sorted(row.items()):
                if probability <= 0:
                    continue
                sensing = tuple(sorted(tables.sensing[action, number].items()))
                after.append(number)
                chances.append(probability)
                sensings.append(known.setdefault(sensing, len(known)))
            first.append(len(after))
            rewards[state, action] = tables.rewards.expected(action, state, row, tables.sensing_of(action))
    likelihoods = Ragged(
        np.cumsum([0, *(len(row) for row in known)]),
        np.array([number for row in known for number, _ in row], dtype=np.int64),
        np.array([probability for row in known for _, probability in row]),
    )
    return ExplicitModel(
        name=name,
        discount=discount,
        states=states,
        actions=actions,
        observations=names["observations"],
        rewards=rewards,
        outcomes=Ragged(np.array(first), np.array(after), np.array(chances)),
        sensings=np.array(sensings),
        likelihoods=likelihoods,
        starts=_starts(tables),
    )


def _starts(tables: PomdpTables) -> tuple[StartBelief, ...]:
    if tables.is_seen:
        one = np.ones(1)
        return tuple(
            StartBelief(probability, np.array([state]), one)
            for state, probability in sorted(tables.start.items())
        )
    return (StartBelief(1.0, np.array(list(tables.start)), np.array(list(tables.start.values()))),)
