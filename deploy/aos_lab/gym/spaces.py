"""The observations that there are.

Numbers are what learning programs take, and a model lists the responses of its skills; so an observation
is a number. Text observations have no list. They are given as their bytes, in an array of fixed length: what
is alike in two texts stays alike, which numbers in the order of appearance would lose. Where skills report
numbers beside their responses, an observation is a dict of both.
"""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from aos_lab.gym.worlds import TEXT_BYTES, HiddenWorlds, Numbers, as_bytes

Observation = np.int64 | NDArray[np.uint8] | dict[str, Any]


def observation_space(worlds: HiddenWorlds) -> gymnasium.spaces.Space[Any]:
    """`Discrete` over the responses, or `Box` of bytes where a skill's response is a text.

    With numbers it is a `Dict` of this `response`, of the `numbers`, and of which of them were `reported`.
    """
    response: gymnasium.spaces.Space[Any] = gymnasium.spaces.Discrete(len(worlds.responses))
    if worlds.has_texts:
        response = gymnasium.spaces.Box(0, 255, (TEXT_BYTES,), np.uint8)
    if not worlds.number_names:
        return response
    count = len(worlds.number_names)
    numbers = gymnasium.spaces.Box(-np.inf, np.inf, (count,), np.float64)
    reported = gymnasium.spaces.MultiBinary(count)
    return gymnasium.spaces.Dict({"response": response, "numbers": numbers, "reported": reported})


def observations(
    worlds: HiddenWorlds, responses: NDArray[np.int64], texts: list[str], numbers: Numbers
) -> Any:
    """The observations of all worlds: an array with a row for each, or a dict of such."""
    given = as_bytes(texts) if worlds.has_texts else responses
    if not worlds.number_names:
        return given
    return {"response": given, "numbers": numbers.values, "reported": numbers.is_reported}
