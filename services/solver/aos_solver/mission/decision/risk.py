"""Chance constraints: what a mission may still risk, and which actions risk more.

Each constraint is a budget of probability. A decision spends the probability, under its belief, that its step
violates the constraint, and only actions that the budget allows can be chosen. So the sum of what is spent
never exceeds the bound, and that sum, in expectation, is the mean number of violating steps of a mission: at
least the probability that there is one. docs/constraints.md has the proof, and what it supposes.
"""

from collections.abc import Sequence

from aos_protocol.messages import ConstraintRisk
from aos_solver.child.answers.models import Risks
from aos_solver.emission.emit import Bound

_ROUNDING = 1e-12
"""Sums of probabilities are no more exact than that."""


class RiskBudget:
    """The budget of each constraint that a mission's decisions have left."""

    def __init__(self, bounds: Sequence[Bound]) -> None:
        self._bounds = tuple(bounds)
        self._remaining = [bound.probability for bound in bounds]

    def __bool__(self) -> bool:
        """Returns whether there is any constraint."""
        return bool(self._bounds)

    def forbidden(self, risks: Risks) -> frozenset[int]:
        """The numbers of the actions that risk more than is left of any constraint."""
        return frozenset(
            number
            for number, probabilities in enumerate(risks.actions)
            if any(
                risk > remaining + _ROUNDING
                for risk, remaining in zip(probabilities, self._remaining, strict=True)
            )
        )

    def spend(
        self, risks: Risks, index: int, actions: Sequence[int] | None = None
    ) -> tuple[ConstraintRisk, ...]:
        """Takes what the action of this number risks from the budget, and says how the decision stands.

        The risks of the actions with the numbers `told` are told, by default of all.
        """
        actions = range(len(risks.actions)) if actions is None else actions
        spent = tuple(
            ConstraintRisk(
                never=bound.never,
                probability=bound.probability,
                left=remaining,
                risk=risk,
                risks=tuple(risks.actions[action][number] for action in actions),
                is_sampled=risks.is_sampled,
            )
            for number, (bound, remaining, risk) in enumerate(
                zip(self._bounds, self._remaining, risks.actions[index], strict=True)
            )
        )
        self._remaining = [max(constraint.left - constraint.risk, 0.0) for constraint in spent]
        return spent

    def take_up(self, constraints: Sequence[ConstraintRisk]) -> None:
        """Leaves of the budget what a decision of before has left."""
        if constraints:
            self._remaining = [max(constraint.left - constraint.risk, 0.0) for constraint in constraints]

    def refusal(self, risks: Risks, index: int) -> str:
        """Says which constraints an action of this number exceeds; empty where it may be chosen."""
        exceeded = [
            f"never {bound.never}: {remaining:.3g} is left of {bound.probability:g}, and it risks {risk:.3g}"
            for bound, remaining, risk in zip(
                self._bounds, self._remaining, risks.actions[index], strict=True
            )
            if risk > remaining + _ROUNDING
        ]
        return "; ".join(exceeded)

    def remark(self, risks: Risks) -> str:
        """Says why no action can be chosen."""
        refused = []
        for number, (bound, remaining) in enumerate(zip(self._bounds, self._remaining, strict=True)):
            least = min(probabilities[number] for probabilities in risks.actions)
            left_text = f"{remaining:.3g} is left of {bound.probability:g}"
            refused.append(f"never {bound.never}: {left_text}, and the least risk is {least:.3g}")
        return f"every action risks more than is allowed ({'; '.join(refused)})"
