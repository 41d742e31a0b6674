"""One world as a `gymnasium.Env`."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import gymnasium
import numpy as np
from numpy.typing import NDArray

from aos_deploy.gym.spaces import Observation, observation_space
from aos_deploy.gym.worlds import ENDINGS, HiddenWorlds, as_bytes

__all__ = ["AosEnv"]

MOST_SEEDS = 2**63 - 1


class AosEnv(gymnasium.Env[Observation, np.int64]):
    """A bundle's model. An action is the number of a grounded action, an observation that of a response.

    An episode terminates when the mission does, and is truncated after `max_episode_steps` if given. `info`
    has the `action`, the `response` and the `ending` in words. In a bundle with text observations these are
    bytes: see `aos_deploy.gym.spaces`.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}

    def __init__(self, bundle: str | Path, *, max_episode_steps: int | None = None) -> None:
        self._worlds = HiddenWorlds(Path(bundle))
        self._most_steps = max_episode_steps
        self._steps = 0
        self.action_names = self._worlds.actions
        self.response_names = self._worlds.responses
        self.discount = self._worlds.discount
        self.action_space = gymnasium.spaces.Discrete(len(self.action_names))
        self.observation_space = observation_space(self._worlds)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """A new episode; the same seed, the same episodes from there on."""
        super().reset(seed=seed)
        self._worlds.start([int(self.np_random.integers(MOST_SEEDS))])
        self._steps = 0
        return self._observation(np.int64(0), ""), {}

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Runs a grounded action."""
        done = self._worlds.step(np.array([action]))
        self._steps += 1
        text = done.texts[0] if done.texts else ""
        info = {
            "action": self.action_names[int(action)],
            "response": text or self.response_names[done.observations[0]],
            "ending": ENDINGS[done.endings[0]],
        }
        is_cut = self._most_steps is not None and self._steps >= self._most_steps
        observation = self._observation(done.observations[0], text)
        return observation, float(done.rewards[0]), bool(done.endings[0]), is_cut, info

    def close(self) -> None:
        """Ends the child process."""
        self._worlds.close()

    def _observation(self, number: np.int64, text: str) -> Observation:
        if not self._worlds.has_texts:
            return number
        row: NDArray[np.uint8] = as_bytes([text])[0]
        return row
