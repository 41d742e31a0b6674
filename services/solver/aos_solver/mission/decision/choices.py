"""The outcomes of a choice: an action, an ending, to hold, or a refusal; and the searches made for it."""

from collections.abc import Sequence

import msgspec
from msgspec.structs import replace

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


class MadeSearches:
    """The searches since the decision before. The last one decides; those before it are dropped."""

    def __init__(self) -> None:
        self._made: list[SearchMade] = []

    def add(self, made: SearchMade, pondered: tuple[int, ...] = ()) -> None:
        """Another search, after one with so many simulations of each thread while a skill ran."""
        self._made = list(_dropped(self._made))
        if pondered:
            self._made.append(SearchMade(made.planner, pondered, is_pondering=True, engine=made.engine))
        self._made.append(made)

    def take_last_but_one(self) -> None:
        """The last search decides nothing, but the one before it."""
        if len(self._made) > 1:
            *others, decided, dropped = self._made
            self._made = [*others, replace(decided, is_dropped=False), *_dropped([dropped])]

    def told(self, *, are_dropped: bool = False) -> tuple[SearchMade, ...]:
        """The searches, which are told once. None of them decided if they `are_dropped`."""
        made, self._made = tuple(self._made), []
        return _dropped(made) if are_dropped else made

    def put_back(self, searches: Sequence[SearchMade]) -> None:
        """Their decision is not carried out: the next one tells of them."""
        self._made = [*_dropped(searches), *self._made]

    def forget(self) -> None:
        self._made.clear()


def _dropped(searches: Sequence[SearchMade]) -> tuple[SearchMade, ...]:
    return tuple(replace(made, is_dropped=True) for made in searches)
