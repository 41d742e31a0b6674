"""The event stream of a mission that is over, in a gateway that others ask at the same time."""

import asyncio
from contextlib import aclosing
from types import SimpleNamespace
from typing import Any, cast

import pytest
from decision_records import decision_record

from aos_gateway.resources.events import place_of, stream
from aos_gateway.runs.feed import Watches
from aos_gateway.runs.run import Run
from aos_gateway.runs.shelf import RunShelf
from aos_protocol.messages import History

RECORDS = 200


async def test_others_have_their_turn_while_a_long_past_is_told():
    async def page(mission: str, since: int) -> History:
        return History(mission, tuple(decision_record(number) for number in range(RECORDS)))

    async def wait_for_turns() -> None:
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


@pytest.mark.parametrize("text", ["", "7", ":7", "m:", "m:-1", "m:1e3", "m:\u0667", "m:" + "9" * 5000])
def test_what_is_no_id_of_an_event_begins_with_the_first(text):
    assert place_of("a:b:7") == ("a:b", 7)
    assert place_of(text) == ("", 0)
