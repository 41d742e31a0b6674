"""The questions by which an engine of other documents takes a mission over."""

from collections.abc import Iterator

import msgspec
from msgspec.structs import replace

from aos_protocol.messages import BeliefSummary, Marginal
from aos_solver.child.answers.beliefs import BeliefCount, BeliefUpdate
from aos_solver.child.lines.command_line import command_line
from aos_solver.child.questions.asking import Asking, Done
from aos_solver.emission.layout import Common, Layout

_TOLD_VALUES = 100_000
"""The most values of all variables together; the marginals of most models have fewer."""


class JointBelief(msgspec.Struct, frozen=True):
    """The joint distribution of some variables: rows of a weight, an ending, spent bits, and the values.

    `states` is the number of all rows.
    """

    error_bound: float
    is_drawn: bool
    states: int
    rows: tuple[tuple[float, int, str, str], ...]


class JointBeliefs(msgspec.Struct, frozen=True):
    """The same of each hypothesis' belief, and of the cautious one. `words` tell them apart."""

    words: str
    beliefs: tuple[JointBelief, ...]


class _Marginals(msgspec.Struct, frozen=True):
    marginals: tuple[Marginal, ...]


class TakeoverQuestions(Asking):
    """Beliefs that go over to other variables, and time that passes without a skill."""

    @property
    def layout(self) -> Layout:
        """The layout of the model's state."""
        return self._built.emitted.layout

    @property
    def texting_skills(self) -> frozenset[str]:
        """The skills whose responses may be any text."""
        return self._built.emitted.texting_skills

    async def pass_time(self, *, step: int | None = None) -> BeliefUpdate:
        """Lets extrinsic changes alone act for a step; nothing is done and nothing observed.

        `step` is the mission's, as in `update`.
        """
        command = command_line("pass_time", draws=self._draws.of(step))
        return await self._change_belief(command, BeliefUpdate)

    async def marginals(self) -> tuple[Marginal, ...]:
        """Returns the marginals of all variables with all of their values, up to 100,000 in all."""
        return (await self._ask(command_line("marginals", values=_TOLD_VALUES), _Marginals)).marginals

    async def export_joint(self, common: Common) -> JointBeliefs:
        """Returns what is believed of the variables that another model has too."""
        count = await self._ask("describe_beliefs", BeliefCount)
        beliefs = [await self._joint(common, number) for number in range(count.beliefs)]
        return JointBeliefs(count.words, tuple(beliefs))

    async def _joint(self, common: Common, number: int) -> JointBelief:
        fields = {"variables": ",".join(common.kept), "spendable": sum(common.bits), "number": number}
        belief = await self._ask(command_line("export_joint", first=0, **fields), JointBelief)
        rows = list(belief.rows)
        while len(rows) < belief.states:
            rows += (
                await self._ask(command_line("export_joint", first=len(rows), **fields), JointBelief)
            ).rows
        return replace(belief, rows=tuple(rows))

    async def project(self, joint: JointBeliefs, common: Common) -> BeliefSummary:
        """Takes over what an engine believes that has the variables in common.

        They keep their joint distribution; the others are as the initial belief has them (projection.hpp).
        """
        *first, last = _projections(joint, common, self._draws.of_takeover())
        for command in first:
            await self._ask(command, Done)
        return await self._change_belief(last, BeliefSummary)


def _projections(joint: JointBeliefs, common: Common, draws: int) -> Iterator[str]:
    count = len(joint.beliefs)
    for number, belief in enumerate(joint.beliefs):
        items: list[object] = []
        for weight, ending, spent, values in belief.rows:
            items += (weight, ending, common.spent(int(spent)), values)
        yield command_line(
            "project_belief",
            items,
            variables=",".join(common.kept),
            fixed=",".join(common.fixed),
            spendable=sum(common.bits.values()),
            error_bound=belief.error_bound,
            is_drawn=belief.is_drawn,
            is_first=number == 0,
            left=count - number - 1,
            beliefs=count,
            words=joint.words,
            draws=draws,
        )
