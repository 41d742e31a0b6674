import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from processes import HANG_S

from aos_protocol.errors import BusError
from aos_protocol.keys import Keys
from aos_protocol.messages import Catalogue, CatalogueQuery, TopicMessage
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.children import PIPE, Child


async def test_no_router_is_a_clear_error(unused_tcp_port: int):
    with pytest.raises(BusError, match="no bus router answers at") as caught:
        await Bus.open(f"tcp/127.0.0.1:{unused_tcp_port}", sender="lonely", connect_timeout_s=0.1)
    assert caught.value.code == "AOS605"


async def test_a_key_that_goes_in_the_moment_in_which_a_watch_begins_is_not_there_for_ever(
    bus: Bus, other: Bus, keys: Keys
):
    key = keys.live("leaving")
    async with bus.presence(keys.all_live):  # So its session knows the key.
        for _ in range(100):
            await other.announce(key)
            other.withdraw(key)
            async with bus.presence(key) as present:
                await other.announce(keys.live("later"))  # The router has heard of the withdrawal.
                other.withdraw(keys.live("later"))
                async with bus.presence(keys.live("later")):  # So has the watch.
                    is_there = False
                    while present.has_items:
                        _, is_there = await anext(present)
                    assert not is_there


async def test_a_key_that_came_while_a_watch_ended_and_went_is_not_there_for_the_next_watch(
    bus: Bus, other: Bus, keys: Keys
):
    key = keys.live("passing")
    for _ in range(300):
        async with bus.presence(key) as present:
            assert not present.has_items
        await other.announce(key)
        other.withdraw(key)
        await other.announce(keys.live("later"))  # The router has heard of the withdrawal.
        other.withdraw(keys.live("later"))


async def test_an_endpoint_that_is_none_is_refused_before_anything_is_opened():
    with pytest.raises(BusError, match="is not a bus endpoint"):
        await Bus.open("127.0.0.1:7447", sender="lost")


async def test_presence_shows_who_is_there_who_comes_and_who_goes(
    endpoint: str, bus: Bus, other: Bus, keys: Keys
):
    early, late = keys.live("early"), keys.live("late")
    await other.announce(early)
    async with bus.presence(keys.all_live) as changes:
        assert changes.has_items
        assert await anext(changes) == (early, True)
        async with await Bus.open(endpoint, sender="late") as leaving:
            await leaving.announce(late)
            assert await anext(changes) == (late, True)
        assert await anext(changes) == (late, False)


ANNOUNCE = """
import asyncio, sys
from aos_runtime.bus.bus import Bus
from aos_protocol.keys import Keys
async def main():
    bus = await Bus.open(sys.argv[1], sender="mortal")
    await bus.announce(Keys("test").live("mortal"))
    await asyncio.Event().wait()
asyncio.run(main())
"""


@pytest.mark.parametrize("death", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "frozen"])
async def test_presence_ends_with_a_process_that_cannot_say_goodbye(
    endpoint: str, bus: Bus, keys: Keys, death: signal.Signals
):
    async with (
        bus.presence(keys.all_live) as changes,
        running(sys.executable, "-c", ANNOUNCE, endpoint) as child,
        asyncio.timeout(HANG_S),
    ):
        assert await anext(changes) == (keys.live("mortal"), True)
        os.kill(child.pid, death)
        assert await anext(changes) == (keys.live("mortal"), False)


async def test_who_left_the_bus_is_told_so(endpoint: str, keys: Keys):
    bus = await Bus.open(endpoint, sender="gone")
    await bus.close()
    await bus.close()
    with pytest.raises(BusError, match="gone has left the bus"):
        bus.tell(keys.topic("x"), TopicMessage(1, {}))
    with pytest.raises(BusError, match="gone has left the bus"):
        await bus.ask(keys.catalogue, CatalogueQuery(), Catalogue, timeout_s=1)


NEVER_CLOSE = """
import asyncio, sys
from aos_protocol.messages import TopicMessage
from aos_runtime.bus.bus import Bus
async def main():
    bus = await Bus.open(sys.argv[1], sender="hasty")
    await bus.listen("aos/test/topic/x", TopicMessage).__aenter__()
    sys.exit(5)
asyncio.run(main())
"""


async def test_an_interpreter_ends_though_its_bus_was_never_closed(endpoint: str):
    async with running(sys.executable, "-c", NEVER_CLOSE, endpoint) as child, asyncio.timeout(HANG_S):
        assert await child.wait() == 5


@asynccontextmanager
async def running(*argv: str) -> AsyncIterator[Child]:
    child = await Child.start(list(argv), stdout=PIPE)
    try:
        yield child
    finally:
        child.kill()
        await child.wait()
