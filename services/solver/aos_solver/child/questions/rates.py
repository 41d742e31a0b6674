"""The question how quickly the model gives samples."""

from typing import Literal

from aos_protocol.diagnostics import Span
from aos_solver.child.answers.models import EndlessLoop, EndlessSteps
from aos_solver.child.answers.worlds import SampleCount
from aos_solver.child.blame.slow_code import SlowCode, slow_code
from aos_solver.child.lines.command_line import command_line
from aos_solver.child.questions.asking import ANSWER_DEADLINE_S, Asking

Stepping = Literal["code", "table"]
"""The ways to make steps: by the documents' code, or by a table of all steps, which POMCP has of small
models."""


class RateQuestions(Asking):
    """Samples by the second."""

    async def rate(
        self, seconds: float, seed: int, stepping: Stepping = "code", max_seconds: float | None = None
    ) -> SampleCount:
        """Draws samples with random actions for so long; by a table none where searches use no table."""
        name = "rate" if stepping == "code" else "rate_by_table"
        command = command_line(name, seconds=seconds, seed=seed, max_seconds=max_seconds)
        return await self._ask(command, SampleCount, deadline_s=seconds + ANSWER_DEADLINE_S)

    async def endless_steps(self) -> EndlessSteps:
        """The loops in which steps of the running child did not come to an end, whatever it was asked."""
        return await self._ask(command_line("endless_steps"), EndlessSteps)

    async def endless_loops(self) -> list[tuple[EndlessLoop, Span]]:
        """Returns these loops with their places; a model without loops that draw is not asked."""
        emitted = self._built.emitted
        if emitted.place_of_loop(1) is None:
            return []
        loops = (await self.endless_steps()).loops
        return [(loop, place) for loop in loops if (place := emitted.place_of_loop(loop.loop)) is not None]

    async def slow_code(self) -> SlowCode | None:
        """The code in which random steps spend half of their time or more, of another child; None where no
        place is such."""
        return await slow_code(self._built, self._start)
