"""Records of what decides and of what came: searches, whole beliefs, and model against reality."""

from typing import Literal

from aos_protocol.messages.base import Message

ChosenBy = Literal["planner", "policy", "retry", "operator", "script"]
"""The chooser of an action: a search, a policy file, the rule that tries a failed action again, a person, or
a person's script of actions."""


class SearchMade(Message, frozen=True):
    """One search for a decision, also one whose result was dropped (`is_dropped`), and one that went on while
    a skill ran (`is_pondering`). A policy file that was asked counts as a search without simulations.

    `simulations` has the number of each thread, and `known` is how many the tree held before. The search was
    for none of the actions that are `barred`, each with the reason, and did altogether `without` skills and
    grounded actions. With `is_cautious` it was for the belief in which nothing ran that was not observed.
    `engine` is how often the engine's process had been started.
    """

    planner: str
    simulations: tuple[int, ...]
    known: int = 0
    barred: dict[str, str] = {}
    without: tuple[str, ...] = ()
    is_cautious: bool = False
    is_dropped: bool = False
    is_pondering: bool = False
    engine: int = 1


class WeightedStates(Message, frozen=True):
    """One distribution over states, as the engine of the same model reads it.

    Each of `particles` is a weight and the text of a state; `constants` are the variables that nothing
    changes. No event's probability is further than `error_bound` from what Bayes' rule gives. `history` tells
    how the states of a sampled belief (`is_drawn`) came to be.
    """

    particles: tuple[tuple[float, str], ...]
    constants: dict[str, str] = {}
    error_bound: float = 0.0
    is_drawn: bool = False
    history: str = ""


class BeliefRow(Message, frozen=True):
    """The journal's row of a whole belief: that after `step` steps, 0 before the first.

    `beliefs` are that of each hypothesis about what ran unobserved, and the cautious one; `words` tell them
    apart. `digest` is that of the summary, and `model_digest` the model's.
    """

    step: int
    model_digest: str
    beliefs: tuple[WeightedStates, ...]
    words: str = ""
    digest: str = ""


class ModelDrift(Message, frozen=True):
    """An alarm: a skill's response comes more often, or more rarely, than the model predicts.

    Of so many `uses`, the share `seen` had this response; the mean of the probabilities predicted for it
    before each of them is `modelled`. With `is_new` the alarm has begun with this use, and it stays.
    """

    skill: str
    response: str
    modelled: float
    seen: float
    uses: int
    is_new: bool = False


class DriftTest(Message, frozen=True):
    """The state of the test of one response: its uses, how often it was seen, the sum of the predicted
    probabilities, and the logarithms of what each bet has won."""

    skill: str
    response: str
    uses: int = 0
    seen: int = 0
    expected: float = 0.0
    log_wealth: tuple[float, ...] = ()
    is_alarm: bool = False


class DriftTests(Message, frozen=True):
    """The journal's row with which a model's tests begin, or go over from the mission before.

    `count` is the number of tests that are not each other's complements: all share one rate of false alarms.
    """

    model_digest: str
    count: int
    tests: tuple[DriftTest, ...]
