import asyncio

import msgspec
import zenoh

from aos_protocol.codec import encode
from aos_protocol.keys import Keys
from aos_protocol.messages import TopicMessage
from aos_runtime.bus.bus import Bus
from aos_runtime.bus.config import client_config
from aos_runtime.bus.subscription import merged


async def test_a_stream_is_complete_and_in_order_once_entered(bus: Bus, other: Bus, keys: Keys):
    for round_number in range(20):
        key = keys.topic(f"stream/{round_number}")
        async with other.listen(key, TopicMessage) as messages:
            for number in range(1, 11):
                bus.tell(key, TopicMessage(number, {"x": 0.5}))
            received = [await anext(messages) for _ in range(10)]
        assert received == [(key, TopicMessage(number, {"x": 0.5})) for number in range(1, 11)]


async def test_a_full_queue_drops_its_oldest_and_counts_them(bus: Bus, other: Bus, keys: Keys):
    last = keys.topic("last")
    async with (
        other.listen(keys.topic("full"), TopicMessage, queue_size=3) as messages,
        other.listen(last, TopicMessage) as end,
    ):
        for number in range(1, 11):
            bus.tell(keys.topic("full"), TopicMessage(number, {}))
        bus.tell(last, TopicMessage(1, {}))
        await anext(end)
        assert [(await anext(messages))[1].number for _ in range(3)] == [8, 9, 10]
        assert messages.dropped == 7


async def test_merged_streams_keep_the_order_of_their_sender(bus: Bus, other: Bus, keys: Keys):
    first, second = keys.topic("first"), keys.topic("second")
    async with merged(other.listen(first, TopicMessage), other.listen(second, TopicMessage)) as messages:
        for number in range(1, 11):
            bus.tell(first if number % 2 else second, TopicMessage(number, {}))
        assert [(await anext(messages))[1].number for _ in range(10)] == list(range(1, 11))


async def test_streams_end_when_the_bus_closes(endpoint: str, keys: Keys):
    bus = await Bus.open(endpoint, sender="closing")
    stream = merged(bus.listen(keys.decisions, TopicMessage), bus.presence(keys.all_live))
    async with stream:
        await bus.close()
        assert [item async for item in stream] == []


async def test_rubbish_on_a_stream_is_left_out(endpoint: str, other: Bus, keys: Keys):
    key = keys.topic("rubbish")
    good = TopicMessage(1, {})
    rubbish = (b"", b"\xff\x00", b"\x91" * 100_000, msgspec.msgpack.encode({"version": "9.0"}))
    rogue = await asyncio.to_thread(zenoh.open, client_config(endpoint))
    try:
        async with other.listen(key, TopicMessage) as messages:
            for payload in (*rubbish, encode(good, sender="rogue", stamp_ns=0)):
                # A put that does not wait is dropped where the machine is busy.
                rogue.put(key, payload, congestion_control=zenoh.CongestionControl.BLOCK)
            assert await anext(messages) == (key, good)
    finally:
        await asyncio.to_thread(rogue.close)
