"""The bus against a real router: questions, answers, streams, and each way they can fail."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager

import msgspec
import pytest
import zenoh
from processes import HANG_S
from zenoh.handlers import Callback

from aos_protocol.codec import encode
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.errors import AosError, BusError, LostAnswerError, ModelError, NobodyAnswersError
from aos_protocol.keys import Keys
from aos_protocol.messages import (
    Catalogue,
    CatalogueEntry,
    CatalogueQuery,
    Message,
    ProjectQuery,
    TopicMessage,
)
from aos_runtime.bus import Bus
from aos_runtime.bus_config import client_config
from aos_runtime.children import PIPE, Child
from aos_runtime.subscription import merged

ENTRY = CatalogueEntry("armadillo", 1, "digest", 0, ("pick",))


async def list_catalogue(query: ProjectQuery, key: str) -> Message:
    return Catalogue((msgspec.structs.replace(ENTRY, project=f"{query.project} at {key}"),))


async def test_a_question_gets_its_answer(bus: Bus, other: Bus, keys: Keys) -> None:
    await other.answer(keys.catalogue, ProjectQuery, list_catalogue)

    catalogue = await bus.ask(keys.catalogue, ProjectQuery("armadillo"), Catalogue, timeout_s=2)

    assert catalogue.entries[0].project == f"armadillo at {keys.catalogue}"


async def test_a_wildcard_answers_every_key_and_is_told_which(bus: Bus, other: Bus, keys: Keys) -> None:
    await other.answer(keys.activate_any, ProjectQuery, list_catalogue)

    for skill in ("pick", "serve"):
        catalogue = await bus.ask(keys.activate(skill), ProjectQuery("a"), Catalogue, timeout_s=2)
        assert catalogue.entries[0].project == f"a at {keys.activate(skill)}"


async def test_answers_are_reachable_as_soon_as_they_are_declared(bus: Bus, other: Bus, keys: Keys) -> None:
    for number in range(50):
        key = keys.topic(f"declared/{number}")
        await other.answer(key, ProjectQuery, list_catalogue)
        await bus.ask(key, ProjectQuery("a"), Catalogue, timeout_s=2)


async def test_questions_overlap(bus: Bus, other: Bus, keys: Keys) -> None:
    everyone_is_here = asyncio.Barrier(8)

    async def wait_for_the_others(_: CatalogueQuery, __: str) -> Message:
        await everyone_is_here.wait()
        return Catalogue(())

    await other.answer(keys.catalogue, CatalogueQuery, wait_for_the_others)
    questions = (bus.ask(keys.catalogue, CatalogueQuery(), Catalogue, timeout_s=5) for _ in range(8))

    assert await asyncio.gather(*questions) == [Catalogue(())] * 8


async def test_nobody_answers_is_said_at_once(bus: Bus, keys: Keys) -> None:
    with pytest.raises(BusError, match="nobody answers") as caught:
        await bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=30)
    assert caught.value.code == "AOS604"


MORTAL = """
import asyncio, os, sys
from aos_runtime.bus import Bus
from aos_protocol.keys import Keys
from aos_protocol.messages import ProjectQuery
async def main():
    bus = await Bus.open(sys.argv[1], sender="mortal")
    async def die(query, key):
        await bus.announce(Keys("test").live("dying"))  # The router has all that this process said before.
        os.kill(os.getpid(), 9)
    await bus.answer(Keys("test").project, ProjectQuery, die)
    print("ready", flush=True)
    await asyncio.Event().wait()
asyncio.run(main())
"""


async def test_who_dies_over_a_question_is_told_from_nobody(endpoint: str, bus: Bus, keys: Keys) -> None:
    child = await Child.start([sys.executable, "-c", MORTAL, endpoint], stdout=PIPE)
    try:
        assert await child.stdout.readline() == b"ready\n"
        with pytest.raises(LostAnswerError, match="ended before the answer") as caught:
            await bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=30)
        assert caught.value.code == "AOS607"
        with pytest.raises(NobodyAnswersError):
            await bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=30)
    finally:
        await child.stop()


async def test_who_leaves_the_bus_over_a_question_says_so(bus: Bus, endpoint: str, keys: Keys) -> None:
    leaving = await Bus.open(endpoint, sender="leaving")
    is_asked = asyncio.Event()

    async def never(_: ProjectQuery, __: str) -> Message:
        is_asked.set()
        await asyncio.Event().wait()
        return Catalogue(())

    await leaving.answer(keys.project, ProjectQuery, never)
    async with asyncio.TaskGroup() as tasks:
        asked = tasks.create_task(_error_of(bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=30)))
        await is_asked.wait()
        await leaving.close()
    assert isinstance(asked.result(), LostAnswerError)


async def test_who_knows_no_receipts_asks_and_answers_all_the_same(
    endpoint: str, bus: Bus, other: Bus, keys: Keys
) -> None:
    outsider = await asyncio.to_thread(zenoh.open, client_config(endpoint))
    try:
        question = encode(ProjectQuery("a"), sender="outsider", stamp_ns=0)
        answer = encode(Catalogue((ENTRY,)), sender="outsider", stamp_ns=0)
        await other.answer(keys.catalogue, ProjectQuery, list_catalogue)
        replies = await asyncio.to_thread(
            lambda: list(outsider.get(keys.catalogue, payload=question, timeout=HANG_S))
        )
        assert len(replies) == 1
        queryable = outsider.declare_queryable(
            keys.project, Callback(lambda query: query.reply(query.key_expr, answer), indirect=False)
        )
        await until_answered(bus, keys.project)
        queryable.undeclare()
    finally:
        await asyncio.to_thread(outsider.close)


async def until_answered(bus: Bus, key: str) -> None:
    """The router has taken in the outsider's declaration, and the answer is the one it gives."""
    async with asyncio.timeout(HANG_S):
        while True:
            try:
                catalogue = await bus.ask(key, ProjectQuery("a"), Catalogue, timeout_s=5)
            except NobodyAnswersError:
                continue
            assert catalogue.entries == (ENTRY,)
            return


async def _error_of(asked: Awaitable[Message]) -> AosError:
    with pytest.raises(AosError) as error:
        await asked
    return error.value


async def test_a_late_answer_is_a_timeout(bus: Bus, other: Bus, keys: Keys) -> None:
    async def never(_: ProjectQuery, __: str) -> Message:
        await asyncio.Event().wait()
        return Catalogue(())

    await other.answer(keys.project, ProjectQuery, never)

    with pytest.raises(BusError, match=r"within 0\.2 s") as caught:
        await bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=0.2)
    assert caught.value.code == "AOS601"


async def test_a_handlers_own_error_arrives_whole(bus: Bus, other: Bus, keys: Keys) -> None:
    finding = Diagnostic(Severity.ERROR, "AOS201", "no such name", Span("pick.sd", 7, 3))

    async def refuse(_: ProjectQuery, __: str) -> Message:
        raise ModelError("it does not compile", code="AOS201", hint="Mend it", diagnostics=(finding,))

    await other.answer(keys.project, ProjectQuery, refuse)

    with pytest.raises(ModelError) as caught:
        await bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=2)
    error = caught.value
    assert (error.code, error.message, error.hint) == ("AOS201", "it does not compile", "Mend it")
    assert error.diagnostics == (finding,)


async def test_a_defect_in_a_handler_is_an_answer_and_the_next_question_is_served(
    bus: Bus, other: Bus, keys: Keys
) -> None:
    async def fail_once(query: ProjectQuery, _: str) -> Message:
        if query.project == "first":
            raise ValueError("a defect")
        return Catalogue(())

    await other.answer(keys.project, ProjectQuery, fail_once)

    with pytest.raises(AosError, match=r"other failed on .* ValueError: a defect") as caught:
        await bus.ask(keys.project, ProjectQuery("first"), Catalogue, timeout_s=2)
    assert caught.value.code == "AOS606"
    assert await bus.ask(keys.project, ProjectQuery("second"), Catalogue, timeout_s=2) == Catalogue(())


async def test_a_question_or_answer_of_the_wrong_kind_is_malformed(bus: Bus, other: Bus, keys: Keys) -> None:
    async def describe(message: TopicMessage, _: str) -> Message:
        return message

    await other.answer(keys.project, TopicMessage, describe)

    with pytest.raises(BusError, match="not a TopicMessage") as wrong_question:
        await bus.ask(keys.project, CatalogueQuery(), TopicMessage, timeout_s=2)
    with pytest.raises(BusError, match="not a CatalogueEntry") as wrong_answer:
        await bus.ask(keys.project, TopicMessage(1, {}), CatalogueEntry, timeout_s=2)
    assert wrong_question.value.code == wrong_answer.value.code == "AOS602"


async def test_an_oversize_message_never_leaves(bus: Bus, other: Bus, keys: Keys) -> None:
    async def reply_with_too_much(_: ProjectQuery, __: str) -> Message:
        return TopicMessage(1, {"data": bytes(17 * 2**20)})

    await other.answer(keys.project, ProjectQuery, reply_with_too_much)

    with pytest.raises(BusError, match="too large"):
        await bus.ask(keys.project, TopicMessage(1, {"data": bytes(17 * 2**20)}), Catalogue, timeout_s=2)
    with pytest.raises(BusError, match="too large"):
        await bus.ask(keys.project, ProjectQuery(), TopicMessage, timeout_s=5)


async def test_an_answerer_that_leaves_says_so_to_who_waits(endpoint: str, bus: Bus, keys: Keys) -> None:
    was_asked = asyncio.Event()

    async def never(_: ProjectQuery, __: str) -> Message:
        was_asked.set()
        await asyncio.Event().wait()
        return Catalogue(())

    async with await Bus.open(endpoint, sender="leaving") as leaving, asyncio.TaskGroup() as tasks:
        await leaving.answer(keys.project, ProjectQuery, never)
        question = tasks.create_task(
            _error_of(bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=30))
        )
        await was_asked.wait()
        await leaving.close()

    assert "leaving stopped while it answered" in str(question.result())


async def test_a_stream_is_complete_and_in_order_once_entered(bus: Bus, other: Bus, keys: Keys) -> None:
    for round_number in range(20):
        key = keys.topic(f"stream/{round_number}")
        async with other.listen(key, TopicMessage) as messages:
            for number in range(1, 11):
                bus.tell(key, TopicMessage(number, {"x": 0.5}))
            received = [await anext(messages) for _ in range(10)]
        assert received == [(key, TopicMessage(number, {"x": 0.5})) for number in range(1, 11)]


async def test_a_full_queue_drops_its_oldest_and_counts_them(bus: Bus, other: Bus, keys: Keys) -> None:
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


async def test_merged_streams_keep_the_order_of_their_sender(bus: Bus, other: Bus, keys: Keys) -> None:
    first, second = keys.topic("first"), keys.topic("second")
    async with merged(other.listen(first, TopicMessage), other.listen(second, TopicMessage)) as messages:
        for number in range(1, 11):
            bus.tell(first if number % 2 else second, TopicMessage(number, {}))
        assert [(await anext(messages))[1].number for _ in range(10)] == list(range(1, 11))


async def test_streams_end_when_the_bus_closes(endpoint: str, keys: Keys) -> None:
    bus = await Bus.open(endpoint, sender="closing")
    stream = merged(bus.listen(keys.decisions, TopicMessage), bus.presence(keys.all_live))
    async with stream:
        await bus.close()
        assert [item async for item in stream] == []


async def test_rubbish_on_a_stream_is_left_out(endpoint: str, other: Bus, keys: Keys) -> None:
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


async def test_rubbish_as_a_question_is_refused(endpoint: str, other: Bus, keys: Keys) -> None:
    await other.answer(keys.catalogue, ProjectQuery, list_catalogue)
    rogue = await asyncio.to_thread(zenoh.open, client_config(endpoint))
    try:
        for payload in (None, b"", b"\xc1", b"\x81" * 50_000):
            replies = await asyncio.to_thread(lambda p=payload: list(rogue.get(keys.catalogue, payload=p)))
            assert [b"AOS602" in bytes(reply.err.payload) for reply in replies if reply.err] == [True]
    finally:
        await asyncio.to_thread(rogue.close)


async def test_presence_shows_who_is_there_who_comes_and_who_goes(
    endpoint: str, bus: Bus, other: Bus, keys: Keys
) -> None:
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
from aos_runtime.bus import Bus
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
) -> None:
    async with (
        bus.presence(keys.all_live) as changes,
        running(sys.executable, "-c", ANNOUNCE, endpoint) as child,
        asyncio.timeout(HANG_S),
    ):
        assert await anext(changes) == (keys.live("mortal"), True)
        os.kill(child.pid, death)
        assert await anext(changes) == (keys.live("mortal"), False)


async def test_no_router_is_a_clear_error(unused_tcp_port: int) -> None:
    with pytest.raises(BusError, match="no bus router answers at") as caught:
        await Bus.open(f"tcp/127.0.0.1:{unused_tcp_port}", sender="lonely", connect_timeout_s=0.1)
    assert caught.value.code == "AOS605"


async def test_an_endpoint_that_is_none_is_refused_before_anything_is_opened() -> None:
    with pytest.raises(BusError, match="is not a bus endpoint"):
        await Bus.open("127.0.0.1:7447", sender="lost")


async def test_who_left_the_bus_is_told_so(endpoint: str, keys: Keys) -> None:
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
from aos_runtime.bus import Bus
async def main():
    bus = await Bus.open(sys.argv[1], sender="hasty")
    await bus.listen("aos/test/topic/x", TopicMessage).__aenter__()
    sys.exit(5)
asyncio.run(main())
"""


async def test_an_interpreter_ends_though_its_bus_was_never_closed(endpoint: str) -> None:
    async with running(sys.executable, "-c", NEVER_CLOSE, endpoint) as child, asyncio.timeout(HANG_S):
        assert await child.wait() == 5


async def _error_of(question: Awaitable[Message]) -> AosError:
    with pytest.raises(AosError) as caught:
        await question
    return caught.value


@asynccontextmanager
async def running(*argv: str) -> AsyncIterator[Child]:
    child = await Child.start(list(argv), stdout=PIPE)
    try:
        yield child
    finally:
        child.kill()
        await child.wait()
