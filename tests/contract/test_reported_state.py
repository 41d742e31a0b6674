import asyncio

import pytest
from processes import HANG_S

from aos_protocol.errors import BusError, NobodyAnswersError
from aos_protocol.keys import Keys
from aos_protocol.messages import MappingQuery, MappingState
from aos_runtime.bus.bus import Bus
from aos_runtime.parties.reported_state import state_when


class Teller:
    """Tells its states on a bus, and answers with the newest."""

    def __init__(self, bus: Bus, keys: Keys):
        self._bus = bus
        self._key = keys.mapping_state
        self.state = MappingState(0, ())
        self.was_asked = asyncio.Event()

    async def serve(self):
        await self._bus.answer(self._key, MappingQuery, self._answer)

    def tell(self, revision: int):
        self.state = MappingState(revision, ())
        self._bus.tell(self._key, self.state)

    async def _answer(self, _: MappingQuery, __: str) -> MappingState:
        self.was_asked.set()
        return self.state


@pytest.fixture
def teller(other: Bus, keys: Keys) -> Teller:
    return Teller(other, keys)


async def revision_from(bus: Bus, keys: Keys, least: int, timeout_s: float = HANG_S) -> int:
    state = await state_when(
        bus,
        keys.mapping_state,
        MappingQuery(),
        MappingState,
        lambda state: state.revision >= least,
        timeout_s=timeout_s,
    )
    return state.revision


async def test_what_was_told_before_anybody_listened_is_asked_for(bus: Bus, keys: Keys, teller: Teller):
    await teller.serve()
    teller.tell(3)
    assert await revision_from(bus, keys, 3) == 3


async def test_what_is_told_later_is_heard_and_what_does_not_hold_is_passed_over(
    bus: Bus, keys: Keys, teller: Teller
):
    await teller.serve()
    async with asyncio.TaskGroup() as tasks:
        awaited = tasks.create_task(revision_from(bus, keys, 3))
        await teller.was_asked.wait()
        for revision in (1, 2, 5):
            teller.tell(revision)
    assert awaited.result() == 5


async def test_the_service_may_come_later(bus: Bus, keys: Keys, teller: Teller):
    async def refuse(_: MappingQuery, __: str) -> MappingState:
        teller.was_asked.set()
        raise NobodyAnswersError("still starting")

    await bus.answer(keys.mapping_state, MappingQuery, refuse)
    async with asyncio.TaskGroup() as tasks:
        awaited = tasks.create_task(revision_from(bus, keys, 1))
        await teller.was_asked.wait()
        teller.tell(1)
    assert awaited.result() == 1


async def test_a_state_that_is_not_told_in_time_is_an_error(bus: Bus, keys: Keys, teller: Teller):
    await teller.serve()
    with pytest.raises(BusError, match=r"did not come in 0\.2 s") as error:
        await revision_from(bus, keys, 1, timeout_s=0.2)
    assert error.value.code == "AOS601"


async def test_a_refusal_of_the_question_is_told(bus: Bus, keys: Keys):
    async def refuse(_: MappingQuery, __: str) -> MappingState:
        raise BusError("of another version", code="AOS603")

    await bus.answer(keys.mapping_state, MappingQuery, refuse)
    with pytest.raises(BusError, match="of another version"):
        await revision_from(bus, keys, 1)


async def test_what_was_told_while_the_router_was_away_is_asked_for_again(
    bus: Bus, keys: Keys, teller: Teller
):
    """A mission waited for its whole deadline, 20 s, for mappings that were there long since."""
    await teller.serve()
    async with asyncio.TaskGroup() as tasks:
        awaited = tasks.create_task(revision_from(bus, keys, 3, timeout_s=600.0))
        await teller.was_asked.wait()
        teller.state = MappingState(3, ())  # Nobody hears of it.
    assert awaited.result() == 3
