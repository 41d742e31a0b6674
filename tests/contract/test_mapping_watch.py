import asyncio

from processes import HANG_S

from aos_protocol.keys import Keys
from aos_protocol.messages import MappingQuery, MappingState
from aos_runtime.bus.bus import Bus
from aos_solver.mapping_watch import MappingWatch


async def test_an_answer_that_is_read_after_a_newer_state_changes_nothing(bus: Bus, other: Bus, keys: Keys):
    """A mission held for ever: an answer from before the adapters were there came after all was well."""
    follows, has_changed = asyncio.Event(), asyncio.Event()
    watch = MappingWatch(bus, keys, has_changed.set)

    async def answer(_: MappingQuery, __: str) -> MappingState:
        if not follows.is_set():
            follows.set()
            return MappingState(0, (), stamp_ns=1)
        while not watch.announced:
            has_changed.clear()
            other.tell(keys.mapping_state, MappingState(1, ("look",), announced={"look": 1}, stamp_ns=3))
            await has_changed.wait()
        return MappingState(1, ("look",), unavailable={"look": "no adapter"}, stamp_ns=2)

    await other.answer(keys.mapping_state, MappingQuery, answer)
    await other.announce(keys.live("middleware"))
    async with asyncio.timeout(HANG_S), asyncio.TaskGroup() as tasks:
        following = tasks.create_task(watch.follow())
        await follows.wait()
        await watch.until_dealt_with(1)
        following.cancel()
    assert watch.unavailable == {}
