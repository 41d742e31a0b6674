"""Which observations there are.

Numbers are what learning programs take, and a model lists the responses of its skills; so an observation
is a number. Text observations have no list. They are given as their bytes, in an array of fixed length: what
is alike in two texts stays alike, which numbers in the order of appearance would lose.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from aos_deploy.gym.worlds import TEXT_BYTES, HiddenWorlds

__all__ = ["Observation", "observation_space"]

Observation = np.int64 | NDArray[np.uint8]


def observation_space(worlds: HiddenWorlds) -> gymnasium.spaces.Space[Any]:
    """`Discrete` over the responses, or `Box` of bytes where a skill's response is a text."""
    if worlds.has_texts:
        return gymnasium.spaces.Box(0, 255, (TEXT_BYTES,), np.uint8)
    return gymnasium.spaces.Discrete(len(worlds.responses))
