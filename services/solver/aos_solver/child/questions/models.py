"""The questions about a model as a whole: its states and how actions lead to them, and how quick it is."""

from typing import Literal

from aos_protocol.diagnostics import Span
from aos_solver.child.answers.models import EndlessLoop, EndlessSteps, Listed, Reach, WrittenListing
from aos_solver.child.answers.worlds import SampleCount
from aos_solver.child.blame.slow_code import SlowCode, slow_code
from aos_solver.child.lines.command_line import command_line
from aos_solver.child.questions.asking import ANSWER_DEADLINE_S, Asking

LISTING_DEADLINE_S = 600.0


class ListingQuestions(Asking):
    """The states that the actions lead to from the current belief."""

    async def reach(self, seconds: float, max_seconds: float) -> Reach:
        """Looks for so much processor time at the states that the actions can lead to from the current
        belief.

        OverdueError where the last of many steps goes beyond `max_seconds`, here and in `rate`.
        """
        return await self._ask(command_line("reach", seconds=seconds, max_seconds=max_seconds), Reach)

    async def list_states(self, max_states: int = 0) -> Listed:
        """Lists what one more decision leads to: from the current belief on where `max_states` is given, else
        from where the last call has ended. IntractableError where outcomes or states are too many."""
        return await self._ask(
            command_line("list", max_states=max_states), Listed, deadline_s=LISTING_DEADLINE_S
        )

    async def write_listing(self) -> tuple[WrittenListing, bytes, str]:
        """Returns what is listed, as `cpp/point_based/flat_file.hpp` has it, and the texts of states, one a
        line."""
        assert self._listing is not None
        command = command_line("write_listing", descriptor=self._listing.descriptor)
        written = await self._ask(command, WrittenListing, deadline_s=LISTING_DEADLINE_S)
        model, states = self._listing.take(written.model_bytes)
        return written, model, states.decode()


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
