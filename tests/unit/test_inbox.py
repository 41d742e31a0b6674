import asyncio
from functools import partial

from aos_runtime.bus.subscription import Inbox


async def test_messages_keep_their_order_and_leave_time_for_the_rest():
    loop = asyncio.get_running_loop()
    done = loop.create_future()
    taken: list[int] = []
    inbox = Inbox(loop)

    def put():
        for number in range(1000):
            inbox.put(partial(taken.append, number))
        inbox.put(partial(done.set_result, None))

    await asyncio.to_thread(put)
    before: list[int] = []
    loop.call_soon(lambda: before.append(len(taken)))
    await done
    assert taken == list(range(1000))
    assert before[0] < 1000
    taken.clear()
    inbox.put(partial(taken.append, 1))
    await asyncio.sleep(0)
    assert taken == [1], "it was asleep, and is awake again"
