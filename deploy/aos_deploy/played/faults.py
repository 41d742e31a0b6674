"""Faults of skills that a model plays: what a robot can do wrong that documents do not describe."""

import random
from collections.abc import Iterable, Mapping

import msgspec

from aos_protocol.errors import DeployError
from aos_protocol.spelling import did_you_mean

FAILED_CALL, LOST_RESULT, NO_ANSWER = "failed_call", "lost_result", "no_answer"
_KINDS = (FAILED_CALL, LOST_RESULT, NO_ANSWER)


class PlayedFaults(msgspec.Struct, frozen=True):
    """Probabilities by the fault's name, or by `SKILL.FAULT` for one skill alone.

    A call with the fault `failed_call` fails and changes nothing. One with `lost_result` is carried out, and
    nobody can say how it ended. One with `no_answer` is carried out and does not end before its time is over.
    """

    chances: Mapping[str, float] = {}

    def check(self, skills: Iterable[str]) -> None:
        """Raises DeployError for a fault or a skill that is not known, and for what is no probability."""
        known = sorted(skills)
        for name, chance in self.chances.items():
            skill, _, fault = name.rpartition(".")
            if fault not in _KINDS:
                hint = f"{did_you_mean(fault, _KINDS)} Known are {', '.join(_KINDS)}".strip()
                raise DeployError(f"`{name}` is no fault of skills that a model plays", hint=hint)
            if skill and skill not in known:
                hint = f"{did_you_mean(skill, known)} Skills are {', '.join(known)}".strip()
                raise DeployError(f"the fault `{name}` is of no skill of the documents", hint=hint)
            if not 0 <= chance <= 1:
                hint = "Write a number from 0 to 1"
                raise DeployError(f"the fault `{name}` has no probability but {chance:g}", hint=hint)
        for skill in known:
            if (together := sum(self._of(skill).values())) > 1:
                hint = "One call has one fault at most, so their sum is 1 at most"
                raise DeployError(
                    f"the faults of {skill} have the probability {together:g} together", hint=hint
                )

    def drawn(self, skill: str, seed: int, step: int) -> str:
        """The fault of this step's call, or nothing. A mission's seed and its step decide about it alone."""
        draw = random.Random(f"fault {seed} {step}").random()
        for fault, chance in self._of(skill).items():
            draw -= chance
            if draw < 0:
                return fault
        return ""

    def _of(self, skill: str) -> dict[str, float]:
        return {fault: self.chances.get(f"{skill}.{fault}", self.chances.get(fault, 0.0)) for fault in _KINDS}
