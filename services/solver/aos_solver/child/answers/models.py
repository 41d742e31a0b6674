"""The answers of an engine child about its model, its plans and its values, as typed data."""

from typing import Any

import msgspec

from aos_protocol.messages import ActionValue, PredictedObservation


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
    that planner did. Where it `is_idle`, the action changes nothing and tells nothing. `known_simulations`
    were in the tree before the search. The search took `search_s` of processor time, and before it the
    lists, values and first bounds, which no budget counts, `preparation_s`. `by_thread` are the simulations
    of each thread where POMCP searched, and `pondered` those that were made since the plan before while an
    action was carried out.
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
    is_idle: bool = False

    @property
    def best(self) -> ActionValue:
        return self.actions[self.index if self.place is None else self.place]


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
    """The states and goals that the actions can lead to. `limit` says why a goal may have been missed, or a
    precondition that can be met, and is empty where none was.

    The search goes on only for a while when a goal and all preconditions are met; `is_whole` says whether it
    saw all states. `depth` counts actions from the start.
    """

    has_goal: bool
    actions: tuple[ReachedAction, ...]
    states: int
    depth: int
    limit: str
    is_whole: bool


class EndlessLoop(msgspec.Struct, frozen=True):
    """A loop that had no end in so many steps of a child, and the state before the first of them."""

    loop: int
    steps: int
    state: str

    @property
    def text(self) -> str:
        """The text for people, beside its place."""
        steps = "1 simulated step" if self.steps == 1 else f"{self.steps:,} simulated steps"
        return f"this loop never ends in {steps}, the first of them with {self.state}"


class EndlessSteps(msgspec.Struct, frozen=True):
    """The loops in which steps of a child did not come to an end."""

    loops: tuple[EndlessLoop, ...]


class GoalReach(msgspec.Struct, frozen=True):
    """The answer whether actions lead to a goal from the running states, by a list or by random walks."""

    is_reachable: bool


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


class Risks(msgspec.Struct, frozen=True):
    """The probabilities by action that it violates each of the mission's constraints at once.

    `is_sampled` says that steps could not be enumerated, so that some are estimates.
    """

    actions: tuple[tuple[float, ...], ...]
    is_sampled: bool


class RewardTerm(msgspec.Struct, frozen=True):
    """The part of an expected return that one statement gives: its number, or the skill whose precondition
    was violated."""

    place: int
    skill: str
    amount: float


class RewardTerms(msgspec.Struct, frozen=True):
    """The parts of an expected return, and all of it as the steps' rewards have it.

    Where steps cannot be enumerated, they are means of so many `drawn` ones.
    """

    total: float
    terms: tuple[RewardTerm, ...]
    drawn: int = 0
