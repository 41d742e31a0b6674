"""Questions about a decision: why it was made, what another one would be, how it looks ahead.

Whoever answers has an engine of its own for them; no mission is touched. A `step` is that of a decision, and
an empty `mission` is the newest one.
"""

from __future__ import annotations

from typing import Annotated

import msgspec

from aos_protocol.messages.base import Message
from aos_protocol.messages.mission import ActionValue, BeliefSummary


class WhyQuery(Message, frozen=True):
    """Asks why a decision was made, and not `instead` another action; by default the runner-up.

    In all questions step 0 is the newest decision.
    """

    step: int
    instead: str = ""
    mission: str = ""


class Consequence(Message, frozen=True):
    """A response that the action may bring, with its probability, and what would be done after it.

    `action` is the best one then, with its `value` and standard error; it is empty where the mission would be
    over, or where the budget of the study did not last. `is_seen` marks the response that came.
    """

    response: str
    probability: float
    is_seen: bool = False
    goal_probability: float = 0.0
    action: str = ""
    value: float = 0.0
    stderr: float = 0.0


class ValueTerm(Message, frozen=True):
    """The part of both values that one statement of the documents gives: `place` is its file and line."""

    place: str
    value: float
    other: float


class Flip(Message, frozen=True):
    """The probability of a variable's value at which the choice changes: the other action becomes the better
    one, or where that is the better one now, this action.

    The probability is `now`; all ratios among the states with the value are kept, and among those without it
    (Jeffrey's rule). The choice changes between `low` and `high`. `is_checked`: planning on both sides gave
    the one action and the other. Where values are searched, neither action is better for certain between
    `low` and `high`, and without `is_checked` the choice may not change at all.
    """

    variable: str
    value: str
    now: float
    low: float
    high: float
    is_checked: bool = False


class Why(Message, frozen=True):
    """A decision explained: the action's value, that of another action, and their margin.

    Where an operator or a script has chosen it (`chosen_by`), the `margin` may be negative: the other action
    is worth more. Values are exact where `is_exact`. `is_close`: the margin is within two standard errors,
    and about `simulations_to_tell` would tell, where any number would. `terms` add up to the values, up to
    `rest` and `other_rest`, which are what later steps are worth where only the first step's rewards could be
    told apart. `flips` are the nearest first. `update_s` and `update_effort` are of the belief update after
    the outcome, as the record has them. `remark` says what could not be told, and why.
    """

    mission: str
    step: int
    action: str
    value: float
    stderr: float
    other: str
    other_value: float
    other_stderr: float
    margin: float
    margin_stderr: float
    is_exact: bool
    is_close: bool
    simulations_to_tell: int
    horizon: int
    planner: str
    chosen_by: str
    belief: BeliefSummary
    expected: tuple[Consequence, ...] = ()
    terms: tuple[ValueTerm, ...] = ()
    rest: float = 0.0
    other_rest: float = 0.0
    flips: tuple[Flip, ...] = ()
    update_s: float = 0.0
    update_effort: str = ""
    remark: str = ""


class WhatIfQuery(Message, frozen=True):
    """Asks for the decision of a step under other circumstances.

    Without the `forbid` actions now, `without` skills for good, with other probabilities for values
    (`believe`, each as `variable=value:p`), and with other numbers in the documents (`change`, each as
    `file:line=number`).
    """

    step: int
    forbid: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    believe: tuple[str, ...] = ()
    change: tuple[str, ...] = ()
    mission: str = ""


class WhatIf(Message, frozen=True):
    """The decision that would be made, and the one that was: `before`, with its value.

    `actions` are the values then. `supposed` says for each thing that was believed otherwise how probable it
    was, and for each number that was changed what it was. `remark` says what was excluded.
    """

    mission: str
    step: int
    action: str
    value: float
    stderr: float
    before: str
    value_before: float
    actions: tuple[ActionValue, ...]
    belief: BeliefSummary
    planner: str = ""
    why: str = ""
    supposed: tuple[str, ...] = ()
    remark: str = ""


class TreeQuery(Message, frozen=True):
    """Asks how a decision looks ahead: the `branches` best actions and likeliest responses, to a `depth`."""

    step: int
    depth: Annotated[int, msgspec.Meta(ge=1, le=6)] = 2
    branches: Annotated[int, msgspec.Meta(ge=1, le=10)] = 3
    mission: str = ""


class TreeNode(Message, frozen=True):
    """A belief of the tree and its best actions; none where the mission would be over there.

    `goal_probability` is that of the belief, and `horizon` the number of decisions to go.
    """

    goal_probability: float
    horizon: int
    actions: tuple[TreeBranch, ...] = ()


class TreeBranch(Message, frozen=True):
    """An action with its value and how often it was tried, and what may be observed after it.

    `after` has for each response its probability and the belief after it; it is empty at the depth that was
    asked for.
    """

    action: str
    q: float
    n: int
    stderr: float
    after: tuple[tuple[str, float, TreeNode], ...] = ()


class DecisionTree(Message, frozen=True):
    """The tree below a decision, each belief planned anew. `is_whole`: nothing was left out for its size."""

    mission: str
    step: int
    root: TreeNode
    is_whole: bool = True
