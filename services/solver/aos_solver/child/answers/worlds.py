"""The answers of an engine child about simulated worlds and samples of steps, as typed data."""

import msgspec


class WorldStart(msgspec.Struct, frozen=True):
    """The hidden state of a new simulated world; `ending` is empty, `goal`, `failure` or `over`.

    `conditions` has a bit for each condition of the model that holds in the state: see `conditions.py`.
    """

    ending: str
    conditions: int = 0


class WorldState(msgspec.Struct, frozen=True):
    """The hidden state as text: by the documents' print function, or else all variables with their values."""

    state: str


class EngineStep(msgspec.Struct, frozen=True):
    """One step of the simulated world; its numbers are name, index and value."""

    reward: float
    response: str
    ending: str
    numbers: tuple[tuple[int, int, float], ...] = ()
    violations: int = 0


class WorldStep(msgspec.Struct, frozen=True):
    """One step of the simulated world; `numbers` are what was observed beside the response, by name.

    `violations` has a bit for each of the mission's constraints that the step violated.
    """

    reward: float
    response: str
    ending: str
    numbers: dict[str, float | list[float | None]] = {}
    violations: int = 0


class Worlds(msgspec.Struct, frozen=True):
    """The observations that worlds can give, by number; 0 is none. With `has_texts` there are texts too."""

    observations: tuple[str, ...]
    has_texts: bool


class WorldSteps(msgspec.Struct, frozen=True):
    """One step of all worlds, an entry for each in every array.

    `endings` are bytes, 0 running, 1 goal, 2 failure, 3 over; `rewards` of type float64, `observations` of
    int32. The bytes of each array are as the machine has them. `texts` are empty unless the model has text
    observations.
    The arrays of observed numbers have an entry for each of these: the world, of int32, the key, of uint32,
    which is the name's place times 65536 and the index, and the value, of float64.
    """

    endings: bytes
    rewards: bytes
    observations: bytes
    texts: list[str]
    number_worlds: bytes = b""
    number_keys: bytes = b""
    number_values: bytes = b""


class SampleCount(msgspec.Struct, frozen=True):
    """The number of samples (next state, observation, reward) that were drawn, and the time they took."""

    samples: int
    seconds: float
    mean_reward: float
    cpu_seconds: float = 0.0
