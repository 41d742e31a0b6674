"""The outcomes of a choice: an action, an ending, to hold, or the refusal of an action that was asked for."""

import msgspec

from aos_protocol.messages import ChosenBy, SearchMade
from aos_solver.child.answers.models import Plan, Risks
from aos_solver.mission.rules.endings import Ending


class Choice(msgspec.Struct, frozen=True):
    """An action, and what it was chosen without. `is_cautious` says that it is for the cautious belief.

    `forbidden` are the numbers of the actions that risk too much. `set_aside` are the skills and grounded
    actions that it was chosen without. `searches` are all that were made for it.
    """

    plan: Plan
    risks: Risks | None
    forbidden: frozenset[int]
    set_aside: dict[str, str]
    is_cautious: bool = False
    chosen_by: ChosenBy = "planner"
    searches: tuple[SearchMade, ...] = ()


class Ended(msgspec.Struct, frozen=True):
    """The mission is over."""

    ending: Ending
    remark: str


class Held(msgspec.Struct, frozen=True):
    """Nothing can be run until something changes; where it is `for_operator`, somebody has to change it."""

    remark: str
    for_operator: bool = False


class Refused(msgspec.Struct, frozen=True):
    """An action that somebody asked for and that cannot be carried out now."""

    why: str
    hint: str = ""
