"""Many worlds as a `gymnasium.vector.VectorEnv`: one call steps them all, in one process beside."""

from pathlib import Path
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from aos_lab.gym.environment import MAX_SEED
from aos_lab.gym.worlds import HiddenWorlds, ValuesToSet, check_at_least_one, observation_space, observations

Numbers = NDArray[Any]


class AosVectorEnv(gymnasium.vector.VectorEnv[Any, Numbers, Numbers]):
    """`num_envs` worlds of a bundle's model, in which `AosEnv`'s spaces hold for each.

    A world whose episode is over starts anew in the next step, whose action for it is ignored.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        bundle: str | Path,
        num_envs: int,
        *,
        max_episode_steps: int | None = None,
        array_room: int = 16,
        mission_values: ValuesToSet = None,
    ) -> None:
        check_at_least_one("num_envs", num_envs)
        check_at_least_one("max_episode_steps", max_episode_steps)
        self._worlds = HiddenWorlds(Path(bundle), array_room, mission_values)
        self._max_steps = max_episode_steps
        self.num_envs = num_envs
        self.action_names = self._worlds.actions
        self.response_names = self._worlds.responses
        self.number_names = self._worlds.number_names
        self.discount = self._worlds.discount
        self.single_action_space = gymnasium.spaces.Discrete(len(self.action_names))
        self.single_observation_space = observation_space(self._worlds)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._steps = np.zeros(num_envs, np.int64)
        self._is_over = np.zeros(num_envs, np.bool_)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """New episodes everywhere; a list gives each world a seed of its own."""
        if isinstance(seed, list):
            if len(seed) != self.num_envs:
                raise ValueError(f"{self.num_envs} seeds are needed, one for each world, and not {len(seed)}")
            seeds = [int(np.random.default_rng(number).integers(MAX_SEED)) for number in seed]
        else:
            super().reset(seed=seed)
            seeds = self.np_random.integers(MAX_SEED, size=self.num_envs).tolist()
        self._worlds.start(seeds)
        self._steps[:] = 0
        self._is_over[:] = False
        return observations(self._worlds, *self._worlds.nothing_observed(self.num_envs)), {}

    def step(self, actions: Numbers) -> tuple[Any, Numbers, Numbers, Numbers, dict[str, Any]]:
        """Runs an action in each world."""
        done = self._worlds.step(self._worlds.numbers_of(actions, self.num_envs, self._is_over))
        self._steps = np.where(self._is_over, 0, self._steps + 1)
        is_terminated = done.endings != 0
        is_truncated = np.zeros(self.num_envs, np.bool_)
        if self._max_steps is not None:
            is_truncated = self._steps >= self._max_steps
        self._is_over = is_terminated | is_truncated
        observed = observations(self._worlds, done.observations, done.texts, done.numbers)
        return observed, done.rewards, is_terminated, is_truncated, {}

    def close_extras(self, **_: Any) -> None:
        """Ends the child process."""
        self._worlds.close()
