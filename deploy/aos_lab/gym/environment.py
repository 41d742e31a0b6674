"""One world as a `gymnasium.Env`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import gymnasium
import numpy as np
from numpy.typing import NDArray

from aos_lab.gym.worlds import (
    ENDINGS,
    HiddenWorlds,
    Numbers,
    Observation,
    check_at_least_one,
    observation_space,
    observations,
)

MAX_SEED = 2**63 - 1


class AosEnv(gymnasium.Env[Observation, np.int64]):
    """A bundle's model. An action is the number of a grounded action, an observation that of a response.

    An episode terminates when the mission does, and is truncated after `max_episode_steps` if given. `info`
    has the `action`, the `response` and the `ending` in words. In a bundle with text observations these are
    bytes, and with numbers beside responses dicts: see `aos_lab.gym.worlds`. `number_names` has the names
    of these numbers; of an array there are the first `array_room`. `mission_values` are those of mission
    parameters, as `{"target": "alice"}`.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}

    def __init__(
        self,
        bundle: str | Path,
        *,
        max_episode_steps: int | None = None,
        array_room: int = 16,
        mission_values: Mapping[str, Any] | None = None,
    ) -> None:
        check_at_least_one("max_episode_steps", max_episode_steps)
        self._worlds = HiddenWorlds(Path(bundle), array_room, mission_values)
        self._max_steps = max_episode_steps
        self._steps = 0
        self.action_names = self._worlds.actions
        self.response_names = self._worlds.responses
        self.number_names = self._worlds.number_names
        self.discount = self._worlds.discount
        self.action_space = gymnasium.spaces.Discrete(len(self.action_names))
        self.observation_space = observation_space(self._worlds)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """A new episode; the same seed, the same episodes from there on."""
        super().reset(seed=seed)
        self._worlds.start([int(self.np_random.integers(MAX_SEED))])
        self._steps = 0
        return self._observation(*self._worlds.nothing_observed(1)), {}

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Runs a grounded action."""
        done = self._worlds.step(self._worlds.numbers_of([action], 1))
        self._steps += 1
        text = done.texts[0] if done.texts else ""
        info = {
            "action": self.action_names[int(action)],
            "response": text or self.response_names[done.observations[0]],
            "ending": ENDINGS[done.endings[0]],
        }
        is_cut = self._max_steps is not None and self._steps >= self._max_steps
        observation = self._observation(done.observations, done.texts, done.numbers)
        return observation, float(done.rewards[0]), bool(done.endings[0]), is_cut, info

    def close(self) -> None:
        """Ends the child process."""
        self._worlds.close()

    def _observation(self, responses: NDArray[np.int64], texts: list[str], numbers: Numbers) -> Observation:
        rows = observations(self._worlds, responses, texts, numbers)
        if isinstance(rows, dict):
            return {name: values[0] for name, values in rows.items()}
        observation: Observation = rows[0]
        return observation
