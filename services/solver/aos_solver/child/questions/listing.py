"""The questions of listing: which states there are, and how the actions lead to them."""

from aos_solver.child.answers.models import Listed, Reach, WrittenListing
from aos_solver.child.lines.command_line import command_line
from aos_solver.child.questions.asking import Asking

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
