"""The answers of an engine child, as typed data."""

from __future__ import annotations

import math
from typing import Any

import msgspec

from aos_protocol.messages import ActionValue, BeliefSummary, PredictedObservation
from aos_solver.child.command_line import command_line

__all__ = [
    "BeliefCount",
    "BeliefUpdate",
    "Believed",
    "Conditioned",
    "EngineDescription",
    "EngineFault",
    "ExactValues",
    "ExportedBelief",
    "ExportedBeliefs",
    "GoalReach",
    "GroundedAction",
    "Listed",
    "Plan",
    "Prediction",
    "Progress",
    "Reach",
    "ReachedAction",
    "RewardTerm",
    "RewardTerms",
    "Risks",
    "SampleCount",
    "WorldStart",
    "WorldState",
    "WorldStep",
    "WorldSteps",
    "Worlds",
    "WrittenListing",
]


class GroundedAction(msgspec.Struct, frozen=True):
    """A skill with values for its parameters: `name` is `skill(parameter=value)`, the values plain data.

    `arguments` are the values as the name has them; a value of a state variable has the variable's name.
    """

    name: str
    skill: str
    parameters: dict[str, Any]
    arguments: dict[str, str] = {}


class EngineDescription(msgspec.Struct, frozen=True):
    """The model as the engine knows it; responses are listed for each skill, and for each of the monitors.

    `mission_parameters` are the values that it runs with, by the names of their parts.
    """

    project: str
    horizon: int
    discount: float
    actions: tuple[GroundedAction, ...]
    responses: dict[str, tuple[str, ...]]
    mission_parameters: dict[str, str] = {}
    monitors: tuple[str, ...] = ()


class Plan(msgspec.Struct, frozen=True):
    """A decision: the index of the best action, and what the search found about each, in their order.

    Skills that the search did without have no actions here; `place` is where the best one stands among those
    that have, None where that is its index. `planner` has made it with so many `threads`, and `why` says why
    that planner did. `known_simulations` were in the tree before the search. The search took `search_s` of
    processor time, and before it the lists, values and first bounds, which no budget counts, `preparation_s`.
    `by_thread` are the simulations of each thread where POMCP searched, and `pondered` those that were made
    since the plan before while an action was carried out.
    """

    index: int
    simulations: int
    horizon: int
    actions: tuple[ActionValue, ...]
    predicted: tuple[PredictedObservation, ...]
    seconds: float
    cpu_seconds: float = 0.0
    preparation_s: float = 0.0
    search_s: float = 0.0
    known_simulations: int = 0
    planner: str = ""
    why: str = ""
    threads: int = 1
    place: int | None = None
    by_thread: tuple[int, ...] = ()
    pondered: tuple[int, ...] = ()

    @property
    def best(self) -> ActionValue:
        return self.actions[self.index if self.place is None else self.place]


_ROUNDING = 1e-9


class Progress(msgspec.Struct, frozen=True):
    """The engine's progress with `what` before it can answer: `done` of `all`, which is 0 if unknown."""

    what: str
    done: int
    all: int = 0

    @property
    def text(self) -> str:
        """The progress for people: `listing states: 12,000 of 34,000`."""
        of_all = f" of {self.all:,}" if self.all else ""
        return f"{self.what}: {self.done:,}{of_all}"


class EngineFault(msgspec.Struct, frozen=True):
    """A fault of model code; `piece` is the number of the piece that ran, 0 where none did."""

    code: str
    text: str
    piece: int


class BeliefUpdate(msgspec.Struct, frozen=True):
    """The belief after an outcome, and log P(observation | belief, action) before it.

    `is_impossible` where no state of any belief explains it. `is_excluded` where the model does not: not
    where there may only have been too few particles, but also where a report that was excluded before is
    impossible in the cautious belief again.

    With numbers P is a density, in units of the numbers. `has_other_numbers` says that the model reports no
    such numbers with that response, so that the response counted alone. `uncorrected` is why the local
    variables of the outcome did not correct the belief. `remark` tells people of both. `is_foreign` says that
    the model has no such action or response, so that only time passed. `excludes_monitor` says that no state
    explains what a monitor said.
    """

    log_probability: float
    is_impossible: bool
    summary: BeliefSummary
    is_excluded: bool = False
    has_other_numbers: bool = False
    uncorrected: EngineFault | None = None
    remark: str = ""
    is_foreign: bool = False
    excludes_monitor: bool = False

    @property
    def probability(self) -> float:
        """P(observation | belief, action), or its density; 0 for an impossible observation."""
        return 0.0 if self.is_impossible else math.exp(self.log_probability)

    @property
    def surprise(self) -> float:
        """-log P(observation | belief, action) in nats; 0 for an impossible one, which is marked as such.

        Rounding makes no certain response surprising. A density may be above 1, and its surprise negative.
        """
        is_certain = abs(self.log_probability) < _ROUNDING
        return 0.0 if self.is_impossible or is_certain else -self.log_probability


class ExactValue(msgspec.Struct, frozen=True):
    action: str
    q: float


class ExactValues(msgspec.Struct, frozen=True):
    """Finite-horizon values of all actions, and how many beliefs and states it took.

    Rounding, and what the belief and endless loops leave out, have moved no value by more than `error`.
    """

    actions: tuple[ExactValue, ...]
    beliefs: int
    states: int
    error: float = 0.0

    @property
    def values(self) -> list[ActionValue]:
        return [
            ActionValue(value.action, value.q, 0, 0.0, value.q - self.error, value.q + self.error)
            for value in self.actions
        ]


class ReachedAction(msgspec.Struct, frozen=True):
    """An action, and whether some state that can be reached meets its precondition."""

    name: str
    skill: str
    is_met: bool


class Reach(msgspec.Struct, frozen=True):
    """The states and goals that the actions can lead to. `limit` says why there may be more, and is empty
    where there is no more.

    The search ends early when a goal and all preconditions are met. `depth` counts actions from the start.
    """

    has_goal: bool
    actions: tuple[ReachedAction, ...]
    states: int
    depth: int
    limit: str


class GoalReach(msgspec.Struct, frozen=True):
    """The answer whether actions lead to a goal from a belief's running states; random walks leave it
    unproven."""

    is_reachable: bool
    is_proven: bool


class Listed(msgspec.Struct, frozen=True):
    """The number of states listed with all that their actions lead to, and of those that are known."""

    listed: int
    known: int


class WrittenListing(msgspec.Struct, frozen=True):
    """The size of the written model, the texts of observations, and the names of variables by which states
    are not told apart."""

    model_bytes: int
    observations: tuple[str, ...]
    left_out: tuple[str, ...]


class Prediction(msgspec.Struct, frozen=True):
    """The responses that may be observed after an action, the likeliest first."""

    predicted: tuple[PredictedObservation, ...]


class Risks(msgspec.Struct, frozen=True):
    """The probabilities by action that it violates each of the mission's constraints at once.

    `is_sampled` says that steps could not be enumerated, so that some are estimates.
    """

    actions: tuple[tuple[float, ...], ...]
    is_sampled: bool


class ExportedBelief(msgspec.Struct, frozen=True):
    """A belief that another engine with the same state layout can take: weights, and states as text.

    `constants` are the variables that no code of the model changes, as text; states hold the others.
    `history` tells how the states of a drawn belief came to be; it is empty where the engine does not know.
    """

    error_bound: float
    is_drawn: bool
    states: int
    constants: dict[str, str]
    history: str
    particles: tuple[tuple[float, str], ...]

    @property
    def is_exact(self) -> bool:
        return self.error_bound == 0

    @property
    def command(self) -> str:
        """The command by which an engine takes it over."""
        return self.command_with()

    def command_with(self, **fields: object) -> str:
        """The same with further fields."""
        items = [item for pair in (*self.constants.items(), *self.particles) for item in pair]
        return command_line(
            "import_belief",
            items,
            error_bound=self.error_bound,
            is_drawn=self.is_drawn,
            history=self.history,
            constants=len(self.constants),
            **fields,
        )


class ExportedBeliefs(msgspec.Struct, frozen=True):
    """All that an engine believes: each hypothesis' belief, and the cautious one. `words` tell them apart."""

    words: str
    beliefs: tuple[ExportedBelief, ...]

    @property
    def commands(self) -> list[str]:
        """The commands by which an engine takes them over; the last one changes what it believes."""
        count = len(self.beliefs)
        return [
            belief.command_with(
                is_first=number == 0, left=count - number - 1, beliefs=count, words=self.words
            )
            for number, belief in enumerate(self.beliefs)
        ]


class BeliefCount(msgspec.Struct, frozen=True):
    """The number of beliefs to export, and of the words that go with them."""

    beliefs: int
    words: str


class Conditioned(msgspec.Struct, frozen=True):
    """The probability of what a belief was conditioned on, and the belief after it.

    Where the probability is 0, the belief is the one before.
    """

    probability: float
    summary: BeliefSummary


class Believed(msgspec.Struct, frozen=True):
    """The probability that a variable had a value before another was supposed, and the belief after it."""

    probability: float
    has_variable: bool
    summary: BeliefSummary


class RewardTerm(msgspec.Struct, frozen=True):
    """The part of an expected return that one statement gives: its number, or the skill whose precondition
    was violated."""

    place: int
    skill: str
    amount: float


class RewardTerms(msgspec.Struct, frozen=True):
    """The parts of an expected return, and all of it as the steps' rewards have it."""

    total: float
    terms: tuple[RewardTerm, ...]


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
