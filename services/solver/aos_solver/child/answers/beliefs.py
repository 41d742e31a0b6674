"""The answers of an engine child about beliefs, as typed data."""

import math
from collections.abc import Iterable

import msgspec

from aos_protocol.messages import BeliefSummary, PredictedObservation, WeightedStates
from aos_solver.child.answers.models import EngineFault
from aos_solver.child.lines.command_line import command_line

_ROUNDING = 1e-9


class BeliefUpdate(msgspec.Struct, frozen=True):
    """The belief after an outcome, and log P(observation | belief, action) before it.

    `is_impossible` where no state of any belief explains it. `is_excluded` where the model does not: not
    where there may only have been too few particles, but also where a report that was excluded before is
    impossible in the cautious belief again.

    With numbers P is a density, in units of the numbers. `has_other_numbers` says that the model reports no
    such numbers with that response, so that the response counted alone. `uncorrected` is why the local
    variables of the outcome did not correct the belief. `remark` tells people of both. `is_foreign` says that
    the model has no such action or response, so that only time passed. `excludes_monitor` says that no state
    explains what a monitor said. `effort` tells in counts what the update took.
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
    effort: str = ""

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


class Prediction(msgspec.Struct, frozen=True):
    """The responses that may be observed after an action, the likeliest first."""

    predicted: tuple[PredictedObservation, ...]


class BeliefPiece(WeightedStates, frozen=True):
    """A belief, of whose states only some may be told; `states` is how many there are."""

    states: int = 0

    def with_states(self, particles: Iterable[tuple[float, str]]) -> WeightedStates:
        """The belief with all its states."""
        rest = self.constants, self.error_bound, self.is_drawn, self.history
        return WeightedStates(tuple(particles), *rest)


def import_command(belief: WeightedStates, **fields: object) -> str:
    """The command by which an engine with the same state layout takes a belief over."""
    items = [item for pair in (*belief.constants.items(), *belief.particles) for item in pair]
    return command_line(
        "import_belief",
        items,
        error_bound=belief.error_bound,
        is_drawn=belief.is_drawn,
        history=belief.history,
        constants=len(belief.constants),
        **fields,
    )


class ExportedBeliefs(msgspec.Struct, frozen=True):
    """All that an engine believes: each hypothesis' belief, and the cautious one. `words` tell them apart."""

    words: str
    beliefs: tuple[WeightedStates, ...]

    @property
    def commands(self) -> list[str]:
        """The commands by which an engine takes them over; the last one changes what it believes."""
        count = len(self.beliefs)
        return [
            import_command(
                belief, is_first=number == 0, left=count - number - 1, beliefs=count, words=self.words
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
