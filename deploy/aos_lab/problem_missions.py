"""Missions of a problem file that follow a policy of `aos solve`, with the exact belief."""

import hashlib
import math
from pathlib import Path

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from aos_lab.formats.problem_files import read_problem
from aos_solver.mission.rules.endings import Ending
from aos_solver.mission.simulation import SimulatedRun
from aos_solver.offline.explicit_model import Floats, Integers, over_states, with_stopping
from aos_solver.offline.policy import Policy

_LEFT_OUT = 1e-4
"""A mission without a step limit ends where a reward would count less than this share of a first one."""


class ProblemPlayer:
    """Plays the missions of a problem file by a policy that was solved for it.

    Returns are of expected immediate rewards. A mission ends in a state that nothing leaves and in which
    nothing is worth anything, or after `step_limit` steps.
    """

    def __init__(self, path: Path, policy: Policy, step_limit: int | None) -> None:
        """Raises DocumentError for a file with mistakes, AOS322 for another file's policy."""
        header = policy.header
        policy.check_model(hashlib.sha256(path.read_bytes()).hexdigest(), {})
        model = replace(read_problem(path), discount=header.discount)
        if header.stop_value is not None:
            model = with_stopping(model, header.stop_value)
        self.step_limit = step_limit or _steps_that_count(model.discount)
        self._model, self._policy = model, policy
        self._is_over = over_states(model)

    def play(self, seed: int, *, with_states: bool = False) -> SimulatedRun:
        """Plays a mission; the same seed gives the same."""
        model, draws = self._model, np.random.default_rng(seed)
        weights = np.array([start.weight for start in model.starts])
        start = model.starts[draws.choice(len(weights), p=weights / weights.sum())]
        belief = np.zeros(len(model.states))
        belief[start.states] = start.probabilities
        state = int(draws.choice(len(belief), p=belief / belief.sum()))
        seen, actions, observations = [state], list[str](), list[str]()
        total = discounted = 0.0
        while not self._is_over[state] and len(actions) < self.step_limit:
            action = self._policy.vectors.choose(belief).action
            reward = float(model.rewards[state, action])
            total += reward
            discounted += model.discount ** len(actions) * reward
            state, observation = self._step(state, action, draws)
            belief = self._updated(belief, action, observation)
            seen.append(state)
            actions.append(model.actions[action])
            observations.append(model.observations[observation])
        is_over = bool(self._is_over[state])
        return SimulatedRun(
            seed=seed,
            total=total,
            discounted_return=discounted,
            ending=Ending.OVER if is_over else Ending.STEP_LIMIT,
            steps=len(actions),
            actions=tuple(actions),
            observations=tuple(observations),
            states=tuple(model.states[each] for each in seen) if with_states else (),
            world_ending=Ending.OVER if is_over else None,
        )

    def _step(self, state: int, action: int, draws: np.random.Generator) -> tuple[int, int]:
        """The next state and what is observed there."""
        entries = self._entries(np.array([state]), action)
        probabilities = self._model.outcomes.probabilities[entries]
        entry = entries[draws.choice(len(entries), p=probabilities / probabilities.sum())]
        numbers, likelihoods = self._model.likelihoods.row(int(self._model.sensings[entry]))
        observation = numbers[draws.choice(len(numbers), p=likelihoods / likelihoods.sum())]
        return int(self._model.outcomes.numbers[entry]), int(observation)

    def _updated(self, belief: Floats, action: int, observation: int) -> Floats:
        """The belief after an action and what was observed, by Bayes' rule."""
        outcomes = self._model.outcomes
        support = np.flatnonzero(belief)
        entries = self._entries(support, action)
        rows = support * len(self._model.actions) + action
        lengths = outcomes.first[rows + 1] - outcomes.first[rows]
        weights = np.repeat(belief[support], lengths) * outcomes.probabilities[entries]
        sensings, which = np.unique(self._model.sensings[entries], return_inverse=True)
        likelihood = np.array([self._likelihood(int(sensing), observation) for sensing in sensings])
        after = np.zeros(len(belief))
        np.add.at(after, outcomes.numbers[entries], weights * likelihood[which])
        normalized: Floats = after / after.sum()
        return normalized

    def _likelihood(self, sensing: int, observation: int) -> float:
        numbers, likelihoods = self._model.likelihoods.row(sensing)
        return float(likelihoods[numbers == observation].sum())

    def _entries(self, states: Integers, action: int) -> NDArray[np.int64]:
        """The places of the outcomes of an action in these states, one state after the other."""
        first = self._model.outcomes.first
        rows = states * len(self._model.actions) + action
        return np.concatenate([np.arange(first[row], first[row + 1]) for row in rows])


def _steps_that_count(discount: float) -> int:
    return max(1, math.ceil(math.log(_LEFT_OUT) / math.log(discount))) if discount > 0 else 1
