"""The questions of a mission about its decisions: plans, risks, the way to a goal."""

from collections.abc import Sequence
from typing import Literal

import msgspec

from aos_solver.child.answers.models import GoalReach, Plan, Risks
from aos_solver.child.lines.command_line import command_line
from aos_solver.child.questions.asking import Asking, Done

Planner = Literal["pomcp", "despot", "sarsop", "auto"]
DEFAULT_PLANNER: Planner = "auto"

PLANNING_DEADLINE_S = 120.0
"""The deadline of a search, beyond its budget in time. The first decision computes values before it
searches."""
_LOOK_FOR_GOAL_S = 1.0


class Restriction(msgspec.Struct, frozen=True, kw_only=True):
    """The actions and the belief of a decision.

    The decision is for none of the actions that are `barred`, which nobody could carry out now. The search
    does without the skills `without` and the actions `without_actions`, now and later. With `cautious` it
    starts from the belief in which nothing ran that was not observed.
    """

    barred: Sequence[int] = ()
    without: Sequence[str] = ()
    without_actions: Sequence[int] = ()
    cautious: bool = False


UNRESTRICTED = Restriction()


class MissionQuestions(Asking):
    """Decisions on what is believed now."""

    async def plan(
        self,
        *,
        seed: int,
        simulations: int | None = None,
        time_s: float | None = None,
        horizon: int | None = None,
        planner: Planner = DEFAULT_PLANNER,
        threads: int = 1,
        within: Restriction = UNRESTRICTED,
    ) -> Plan:
        """Searches from the current belief within the budget; `horizon` None takes the document's.

        With the planner `auto` the model's size decides, and the plan says why. POMCP can use
        several threads.
        """
        command = command_line(
            "plan",
            within.barred,
            simulations=simulations or 0,
            seconds=time_s or 0,
            seed=seed,
            horizon=horizon or 0,
            planner=planner,
            threads=threads,
            without=",".join(within.without) or None,
            without_actions=",".join(map(str, within.without_actions)) or None,
            cautious=within.cautious or None,
        )
        return await self._ask(command, Plan, deadline_s=PLANNING_DEADLINE_S + (time_s or 0))

    async def ponder(self, index: int, *, seed: int, time_s: float, threads: int = 1) -> None:
        """Begins to search below an action that is carried out now, so that the next plan starts with that.

        Returns at once. The search goes on for `time_s`, or until something else is asked.
        """
        budget = {"simulations": 0, "seconds": time_s, "threads": threads}
        await self._ask(command_line("ponder", action=index, seed=seed, **budget), Done)

    async def count_processor_time(self, counts: bool) -> None:
        """Sets whether this child's budgets in seconds are of processor time, for measurements."""
        await self._ask(command_line("count_processor_time", counts=counts), Done)

    async def tell_progress(self, every_s: float) -> None:
        """Has `on_progress` told that often at most, for measurements and tests; until then every 0.25 s."""
        await self._ask(command_line("tell_progress", between_ms=round(every_s * 1000)), Done)

    async def risks(self, seed: int) -> Risks:
        """Returns what each action risks of the mission's constraints; the seed is for what has to be
        sampled."""
        return await self._ask(command_line("risks", seed=seed), Risks)

    async def may_reach_goal(
        self, *, without: Sequence[str] = (), without_actions: Sequence[int] = (), cautious: bool = False
    ) -> GoalReach:
        """Looks for a second of processor time whether the other skills and actions lead to a goal."""
        command = command_line(
            "may_reach_goal",
            without=",".join(without) or None,
            without_actions=",".join(map(str, without_actions)) or None,
            cautious=cautious or None,
            seconds=_LOOK_FOR_GOAL_S,
            seed=0,
            horizon=0,
        )
        return await self._ask(command, GoalReach)
