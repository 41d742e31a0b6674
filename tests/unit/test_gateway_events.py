import asyncio
from contextlib import aclosing, nullcontext
from types import SimpleNamespace
from typing import Any, cast

import pytest
from decision_records import decision_record
from processes import HANG_S

from aos_gateway.resources.events import place_of, stream
from aos_gateway.runs.feed import Frame, Viewer, Watches
from aos_gateway.runs.run import Run
from aos_gateway.runs.shelf import RunShelf
from aos_protocol.messages import History

RECORDS = 200


async def test_others_have_their_turn_while_a_long_past_is_told():
    async def page(mission: str, since: int) -> History:
        return History(mission, tuple(decision_record(number) for number in range(RECORDS)))

    async def wait_for_turns():
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    turns, told = 0, 0
    run: Any = SimpleNamespace(name="m", is_running=False, page=page)
    async with asyncio.TaskGroup() as tasks:
        other = tasks.create_task(wait_for_turns())
        events = stream(cast("RunShelf", None), Watches(tasks), cast("Run", run), "m", 0)
        async with aclosing(cast("Any", events)):
            async for _ in events:
                told += 1
                if told == RECORDS:
                    break
        other.cancel()
    assert turns >= RECORDS - 2


async def test_what_is_told_before_a_system_is_heard_comes_from_its_history():
    async def page(mission: str, since: int) -> History:
        return History(mission, tuple(records[since:]))

    async def last_state(mission: str):
        # A step ends after the past was read, and before the gateway hears the bus.
        records.append(decision_record(0))
        viewer.push(Frame("service", b"{}", is_after_gap=True))

    async def entries() -> list[Any]:
        return []

    records: list[Any] = []
    viewer = Viewer()
    run, shelf, watches = (
        cast("Any", SimpleNamespace(**parts))
        for parts in (
            {"page": page, "last_state": last_state},
            {"entries": entries},
            {"viewer": lambda run: nullcontext(viewer)},
        )
    )
    async with asyncio.timeout(HANG_S), aclosing(cast("Any", stream(shelf, watches, run, "m", 0))) as events:
        async for event in events:
            if b"event: decision" in event:
                break


@pytest.mark.parametrize("text", ["", "7", ":7", "m:", "m:-1", "m:1e3", "m:\u0667", "m:" + "9" * 5000])
def test_what_is_no_id_of_an_event_begins_with_the_first(text):
    assert place_of("a:b:7") == ("a:b", 7)
    assert place_of(text) == ("", 0)
