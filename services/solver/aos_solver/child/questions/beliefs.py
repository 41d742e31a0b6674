"""The questions about what is believed, and the observations that change it."""

import logging
from collections.abc import Mapping
from typing import Any

from msgspec.structs import replace

from aos_protocol.errors import AosError
from aos_protocol.messages import BeliefSummary, WeightedStates
from aos_solver.child.answers.beliefs import (
    BeliefCount,
    BeliefPiece,
    BeliefUpdate,
    Conditioned,
    ExportedBeliefs,
    Prediction,
    import_command,
)
from aos_solver.child.answers.models import EngineFault
from aos_solver.child.lines.command_line import (
    UnusableLocals,
    command_line,
    local_values_line,
    numbers_field,
    with_change,
)
from aos_solver.child.questions.asking import Asking, Done

log = logging.getLogger(__name__)


class BeliefQuestions(Asking):
    """Beliefs that are told, changed, taken along and taken over."""

    async def summary(self) -> BeliefSummary:
        """The belief for people."""
        return await self._ask("summary", BeliefSummary)

    async def reset_belief(self, seed: int | None = None) -> BeliefSummary:
        """Goes back to the initial belief, for the mission of this seed or, without one, for another one.

        With the seed of the start a drawn belief has the same particles as at the start.
        """
        draws = self._draws.begin(seed)
        return await self._change_belief(command_line("reset_belief", draws=draws), BeliefSummary)

    async def begin_mission(self, idle: int, *, step: int | None = None) -> BeliefSummary:
        """Begins another mission from what is believed, after so many steps of extrinsic changes alone.

        Nothing has ended or counted before it. `step` is that of a past in which the mission begins.
        """
        draws = self._draws.of_takeover() if step is None else self._draws.of(step)
        return await self._change_belief(command_line("begin_mission", idle=idle, draws=draws), BeliefSummary)

    async def condition(self, refuted_below: float) -> Conditioned:
        """Conditions on what the constraints of this model say of a state: see `conditions.py`.

        `refuted_below` is as in `update`.
        """
        command = command_line("condition", refuted_below=refuted_below)
        return await self._change_belief(command, Conditioned)

    async def draw_belief(self) -> BeliefSummary:
        """Goes back to the initial belief, as particles even where it could be enumerated."""
        draws = self._draws.begin(None)
        return await self._change_belief(command_line("draw_belief", draws=draws), BeliefSummary)

    async def predict(self, index: int, *, cautious: bool = False) -> Prediction:
        """Returns the responses that may be observed after an action; the belief stays as it is."""
        command = command_line("predict", action=index, seed=self._draws.newest, cautious=cautious or None)
        return await self._ask(command, Prediction)

    async def update(
        self,
        action: str,
        response: str,
        local_variables: Mapping[str, str] | None = None,
        numbers: Mapping[str, Any] | None = None,
        refuted_below: float = 0.01,
        step: int | None = None,
    ) -> BeliefUpdate:
        """Bayes' rule after an action and its observation: a response, and the numbers reported beside it.

        The local variables of a real outcome, as text, correct the belief where the skill's documents say so.
        The update's remark says why numbers or local variables could not be used. Where neither is given a
        response is only supposed, and there is none. The cautious belief is given up once all that was
        observed since it began is less probable in it by this factor. `step` is the mission's, without one
        the updates are counted: what an update draws depends on seed and step alone.
        """
        index = self.index_of(action)
        skill = self.description.actions[index].skill
        observed = self.observed.get(skill, ())
        question = {
            "action": index,
            "response": response,
            "numbers": numbers_field(observed, numbers or {}),
            "refuted_below": refuted_below,
            "draws": self._draws.of(step),
        }
        update = await self._corrected(action, question, local_variables)
        if not update.has_other_numbers or (numbers is None and local_variables is None):
            return update
        given = {**(numbers or {}), **(local_variables or {})}
        given_text = ", ".join(f"{number.name} = {given.get(number.name, 'nothing')}" for number in observed)
        remark = (
            f"the numbers of {action} do not count ({given_text}): "
            f"the model reports others with the response {response}"
        )
        log.warning("%s", remark)
        remark = f"{remark}; {update.remark}" if update.remark else remark
        return replace(update, remark=remark)

    def has_monitored(self, monitor: str, response: str) -> bool:
        """Returns whether the model has such a monitor with such a response."""
        known = self.description.responses[monitor] if monitor in self.description.monitors else ()
        return response in known

    async def update_by_monitor(
        self, monitor: str, response: str, refuted_below: float = 0.01
    ) -> BeliefUpdate:
        """Bayes' rule for what a monitor says of the state as it is: no time passes."""
        command = command_line(
            "update",
            action=self._index_of_monitor(monitor),
            response=response,
            numbers="",
            refuted_below=refuted_below,
            draws=self._draws.of_monitor(),
        )
        return await self._change_belief(command, BeliefUpdate)

    async def _corrected(
        self, action: str, question: Mapping[str, Any], local_variables: Mapping[str, str] | None
    ) -> BeliefUpdate:
        """The answer to an update, with the local variables where the skill's documents want them."""
        wanted = self._built.emitted.locals.get(self.description.actions[self.index_of(action)].skill)
        command = command_line("update", **question)
        if wanted is None or local_variables is None:
            return await self._change_belief(command, BeliefUpdate)
        try:
            command = command_line("update", **question, locals=local_values_line(wanted, local_variables))
        except UnusableLocals as reason:
            update, why = await self._change_belief(command, BeliefUpdate), str(reason)
        else:
            before = self._changes
            update = await self._change_belief(command, BeliefUpdate)
            if update.uncorrected is None:
                return update
            why = (await self._correction_fault(update.uncorrected, command, before)).message
        remark = f"the local variables of {action} do not correct the belief: {why}"
        log.warning("%s", remark)
        return replace(update, remark=remark)

    async def _correction_fault(self, fault: EngineFault, command: str, before: int) -> AosError:
        """Returns why local variables did not correct the belief that was there after so many changes.

        The statement is looked for once: the mission waits for it, and meets the fault at every outcome.
        """
        if fault not in self._correction_faults:
            assert self._child is not None
            error = self._child.fault(fault.code, fault.text, fault.piece)
            again = with_change(command, before + 1)
            self._correction_faults[fault] = await self._at_its_statement(error, before, [again])
        return self._correction_faults[fault]

    async def update_without_observation(
        self, action: str, *, ran_probability: float, step: int | None = None
    ) -> BeliefUpdate:
        """The mixture of "it ran" and "it did not", with one cause for all such ends in a row of a skill.

        `step` is as in `update`.
        """
        command = command_line(
            "update_without_observation",
            action=self.index_of(action),
            ran_probability=ran_probability,
            draws=self._draws.of(step),
        )
        return await self._change_belief(command, BeliefUpdate)

    async def export_belief(
        self, *, is_whole: bool = True, cautious: bool = False, number: int | None = None
    ) -> WeightedStates:
        """The whole belief, however many pieces it takes; nobody changes it meanwhile.

        Without `is_whole` states are told without what does not matter. A `number` is that of one of all
        beliefs, see `export_beliefs`.
        """
        fields = {"is_whole": is_whole, "cautious": cautious or None, "number": number}
        belief = await self._ask(command_line("export_belief", first=0, **fields), BeliefPiece)
        particles = list(belief.particles)
        while len(particles) < belief.states:
            command = command_line("export_belief", first=len(particles), **fields)
            particles += (await self._ask(command, BeliefPiece)).particles
        return belief.with_states(particles)

    async def export_beliefs(self) -> ExportedBeliefs:
        """All that is believed: the belief of each hypothesis, and the cautious one; see hypotheses.hpp."""
        count = await self._ask("describe_beliefs", BeliefCount)
        beliefs = [await self.export_belief(number=number) for number in range(count.beliefs)]
        return ExportedBeliefs(count.words, tuple(beliefs))

    async def export_beliefs_within(self, max_bytes: int) -> ExportedBeliefs | None:
        """All that is believed if it takes about `max_bytes` at most; else None, soon."""
        count = await self._ask("describe_beliefs", BeliefCount)
        beliefs: list[WeightedStates] = []
        for number in range(count.beliefs):
            fields = {"is_whole": True, "number": number, "max_bytes": max_bytes // count.beliefs}
            found = await self._ask(command_line("export_belief", first=0, **fields), BeliefPiece)
            if len(found.particles) < found.states:
                return None
            beliefs.append(found.with_states(found.particles))
        return ExportedBeliefs(count.words, tuple(beliefs))

    async def import_belief(self, belief: WeightedStates) -> BeliefSummary:
        """Takes over the belief of an engine whose model has the same state layout (`state_digest`)."""
        return await self._change_belief(import_command(belief), BeliefSummary)

    async def import_beliefs(self, beliefs: ExportedBeliefs) -> BeliefSummary:
        """Takes over all that an engine believes whose model has the same state layout."""
        *first, last = beliefs.commands
        for command in first:
            await self._ask(command, Done)
        return await self._change_belief(last, BeliefSummary)
