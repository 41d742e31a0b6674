"""The questions of a study: beliefs that are supposed, and the rewards behind a value."""

from aos_protocol.messages import BeliefSummary
from aos_solver.child.answers.beliefs import Believed
from aos_solver.child.answers.models import ExactValues, RewardTerms
from aos_solver.child.lines.command_line import command_line
from aos_solver.child.questions.asking import ANSWER_DEADLINE_S, Asking, Done

EXACT_TIME_S = 300.0
EXACT_BELIEF_BUDGET = 20_000_000


class StudyQuestions(Asking):
    """Suppositions, which no mission's engine is asked."""

    async def put_aside(self) -> None:
        """Remembers what is believed, for `take_back` and for `believe` from there."""
        await self._ask("put_aside", Done)

    async def take_back(self) -> BeliefSummary:
        """Believes what was put aside."""
        return await self._change_belief("take_back", BeliefSummary)

    async def believe(
        self,
        variable: str,
        value: str,
        probability: float,
        *,
        from_aside: bool = False,
        cautious: bool = False,
    ) -> Believed:
        """Gives a variable's value another probability, by Jeffrey's rule: all ratios inside are kept.

        Variable and value have the names that marginals have. Where the belief excludes the value, or its
        contrary, nothing changes; the answer has the probability before. With `from_aside` the change is to
        what was put aside.
        """
        command = command_line(
            "believe",
            variable=variable,
            value=value,
            probability=probability,
            from_aside=from_aside,
            cautious=cautious or None,
        )
        return await self._change_belief(command, Believed)

    async def exact_values(self, horizon: int | None = None, *, cautious: bool = False) -> ExactValues:
        """The exact values of all actions; IntractableError where they cannot be enumerated.

        What is listed is kept for the next belief.
        """
        command = command_line(
            "exact_values",
            horizon=horizon or 0,
            cautious=cautious or None,
            beliefs=EXACT_BELIEF_BUDGET,
            seconds=EXACT_TIME_S,
        )
        return await self._ask(command, ExactValues, deadline_s=EXACT_TIME_S + ANSWER_DEADLINE_S)

    async def reward_terms(
        self, index: int, *, horizon: int | None = None, is_first: bool = False, cautious: bool = False
    ) -> RewardTerms:
        """The exact value of an action by the statements that give its rewards, where all decide best.

        With `is_first` those of the first step alone. The model is a traced one, whose statements have
        numbers. IntractableError where steps or beliefs cannot be enumerated.
        """
        command = command_line(
            "reward_terms",
            action=index,
            horizon=horizon or 0,
            is_first=is_first,
            cautious=cautious or None,
            beliefs=EXACT_BELIEF_BUDGET,
            seconds=EXACT_TIME_S,
        )
        return await self._ask(command, RewardTerms, deadline_s=EXACT_TIME_S + ANSWER_DEADLINE_S)
