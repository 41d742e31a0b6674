import asyncio
import queue
import sys
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager, suppress

import msgspec
import pytest
import zenoh
from processes import HANG_S
from zenoh.handlers import Callback

from aos_protocol.access import ROUND_TRIP
from aos_protocol.codec import encode
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.errors import (
    AosError,
    BusError,
    LateAnswerError,
    LostAnswerError,
    ModelError,
    NobodyAnswersError,
)
from aos_protocol.keys import Keys
from aos_protocol.messages import (
    Catalogue,
    CatalogueEntry,
    CatalogueQuery,
    Message,
    ProjectQuery,
    TopicMessage,
)
from aos_runtime.bus.bus import Bus
from aos_runtime.bus.config import client_config
from aos_runtime.bus.presence import ServerWatch
from aos_runtime.processes.children import PIPE, Child

ENTRY = CatalogueEntry("armadillo", 1, "digest", 0, ("pick",))


async def list_catalogue(query: ProjectQuery, key: str) -> Message:
    return Catalogue((msgspec.structs.replace(ENTRY, project=f"{query.project} at {key}"),))


async def test_a_wildcard_answers_every_key_and_is_told_which(bus: Bus, other: Bus, keys: Keys):
    await other.answer(keys.activate_any, ProjectQuery, list_catalogue)

    for skill in ("pick", "serve"):
        catalogue = await bus.ask(keys.activate(skill), ProjectQuery("a"), Catalogue, timeout_s=2)
        assert catalogue.entries[0].project == f"a at {keys.activate(skill)}"


async def test_answers_are_reachable_as_soon_as_they_are_declared(bus: Bus, other: Bus, keys: Keys):
    for number in range(50):
        key = keys.topic(f"declared/{number}")
        await other.answer(key, ProjectQuery, list_catalogue)
        await bus.ask(key, ProjectQuery("a"), Catalogue, timeout_s=2)


async def test_questions_overlap(bus: Bus, other: Bus, keys: Keys):
    everyone_is_here = asyncio.Barrier(8)

    async def wait_for_the_others(_: CatalogueQuery, __: str) -> Message:
        await everyone_is_here.wait()
        return Catalogue(())

    await other.answer(keys.catalogue, CatalogueQuery, wait_for_the_others)
    questions = (bus.ask(keys.catalogue, CatalogueQuery(), Catalogue, timeout_s=5) for _ in range(8))

    assert await asyncio.gather(*questions) == [Catalogue(())] * 8


MORTAL = """
import asyncio, os, sys
from aos_runtime.bus.bus import Bus
from aos_protocol.keys import Keys
from aos_protocol.messages import Catalogue, CatalogueQuery, ProjectQuery
async def main():
    bus = await Bus.open(sys.argv[1], sender="mortal")
    async def die(query, key):
        try:  # The router has the receipt, since a question takes the same queue.
            await bus.ask(Keys("test").catalogue, CatalogueQuery(), Catalogue, timeout_s=5)
        finally:
            os.kill(os.getpid(), 9)
    await bus.answer(Keys("test").project, ProjectQuery, die)
    print("ready", flush=True)
    await asyncio.Event().wait()
asyncio.run(main())
"""


async def test_who_dies_over_a_question_is_told_from_nobody(endpoint: str, bus: Bus, keys: Keys):
    child = await Child.start([sys.executable, "-c", MORTAL, endpoint], stdout=PIPE)
    try:
        assert await child.stdout.readline() == b"ready\n"
        with pytest.raises(LostAnswerError, match="ended before the answer") as caught:
            await bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=30)
        assert caught.value.code == "AOS607"
        with pytest.raises(NobodyAnswersError, match="nobody answers") as caught:
            await bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=30)
        assert caught.value.code == "AOS604"
    finally:
        await child.stop()


async def test_who_leaves_the_bus_over_a_question_says_so(bus: Bus, endpoint: str, keys: Keys):
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
    assert "leaving stopped while it answered" in str(asked.result())


@asynccontextmanager
async def outsider_on(endpoint: str) -> AsyncIterator[zenoh.Session]:
    """A session of a program that is not ours."""
    outsider = await asyncio.to_thread(zenoh.open, client_config(endpoint))
    try:
        yield outsider
    finally:
        await asyncio.to_thread(outsider.close)


class Holder:
    """Serves a key and answers nothing: it holds what it is asked."""

    def __init__(self, session: zenoh.Session, key: str):
        loop = asyncio.get_running_loop()
        self.held: asyncio.Queue[zenoh.Query] = asyncio.Queue()
        self._key = key
        self._queryable = session.declare_queryable(
            key,
            Callback(lambda query: loop.call_soon_threadsafe(self.held.put_nowait, query), indirect=False),
        )

    async def until_asked(self, bus: Bus):
        """The router has taken in the declaration; the questions that showed it are dropped."""
        while self.held.empty():
            with suppress(LateAnswerError, NobodyAnswersError):
                await bus.ask(self._key, ProjectQuery(), Catalogue, timeout_s=0.05)
        while not self.held.empty():
            self.held.get_nowait().drop()

    async def leave(self, bus: Bus):
        """Returns when the router knows; what is held stays so."""
        self._queryable.undeclare()
        error = None
        while not isinstance(error, NobodyAnswersError):
            error = await _error_of(bus.ask(self._key, ProjectQuery(), Catalogue, timeout_s=0.5))


async def test_a_question_is_lost_once_its_server_has_left(endpoint: str, bus: Bus, other: Bus, keys: Keys):
    async with outsider_on(endpoint) as outsider:
        holder = Holder(outsider, keys.project)
        await holder.until_asked(bus)
        async with asyncio.TaskGroup() as tasks:
            question = bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=HANG_S)
            asked = tasks.create_task(_error_of(question))
            with await holder.held.get():
                await holder.leave(other)
                assert isinstance(await asked, NobodyAnswersError)


async def test_a_question_is_lost_whose_server_left_before_it_was_watched_and_another_came(
    endpoint: str, bus: Bus, other: Bus, keys: Keys, monkeypatch
):
    async with outsider_on(endpoint) as outsider:
        questions: queue.Queue[zenoh.Query] = queue.Queue()
        queryable = outsider.declare_queryable(keys.project, Callback(questions.put, indirect=False))
        watch, held, is_missed = ServerWatch.__init__, [], asyncio.Event()

        def watch_late(self: ServerWatch, session: zenoh.Session, key: str):
            held.append(questions.get(timeout=HANG_S))
            queryable.undeclare()
            list(outsider.liveliness().get(ROUND_TRIP))
            watch(self, session, key)

        def looked(self: ServerWatch) -> bool:
            is_served: bool = look(self)
            if not is_served:
                is_missed.set()
            return is_served

        look = vars(ServerWatch)["is_served"].fget
        list(outsider.liveliness().get(ROUND_TRIP))
        monkeypatch.setattr(ServerWatch, "__init__", watch_late)
        monkeypatch.setattr(ServerWatch, "is_served", property(looked))
        async with asyncio.TaskGroup() as tasks:
            question = bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=5)
            asked = tasks.create_task(_error_of(question))
            with suppress(TimeoutError):
                await asyncio.wait_for(is_missed.wait(), 0.5)  # Another serves half a second later at most.
            await other.answer(keys.project, ProjectQuery, list_catalogue)
        assert isinstance(asked.result(), NobodyAnswersError)
        held[0].drop()


async def test_a_key_that_is_served_again_is_not_served_for_who_watched_its_server_leave(
    endpoint: str, other: Bus, keys: Keys
):
    async with outsider_on(endpoint) as outsider, outsider_on(endpoint) as asker, asyncio.timeout(HANG_S):
        holder = Holder(outsider, keys.project)
        await holder.until_asked(other)
        earlier = ServerWatch(asker, keys.project)
        while not earlier.is_served:
            await _error_of(other.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=0.05))
        # Zenoh tells a listener of a server from a task of its own, which may come after the server has left,
        # and then tells nothing. One that finds the server there is told when it leaves.
        watch = ServerWatch(asker, keys.project)
        assert watch.is_served
        await holder.leave(other)
        await watch.has_left
        await other.answer(keys.project, ProjectQuery, list_catalogue)
        assert not watch.is_served


async def test_who_knows_no_receipts_asks_and_answers_all_the_same(
    endpoint: str, bus: Bus, other: Bus, keys: Keys
):
    async with outsider_on(endpoint) as outsider:
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


async def until_answered(bus: Bus, key: str):
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


async def test_a_late_answer_is_a_timeout(bus: Bus, other: Bus, keys: Keys):
    async def never(_: ProjectQuery, __: str) -> Message:
        await asyncio.Event().wait()
        return Catalogue(())

    await other.answer(keys.project, ProjectQuery, never)

    with pytest.raises(BusError, match=r"within 0\.2 s") as caught:
        await bus.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=0.2)
    assert caught.value.code == "AOS601"


async def test_a_handlers_own_error_arrives_whole(bus: Bus, other: Bus, keys: Keys):
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
):
    async def fail_once(query: ProjectQuery, _: str) -> Message:
        if query.project == "first":
            raise ValueError("a defect")
        return Catalogue(())

    await other.answer(keys.project, ProjectQuery, fail_once)

    with pytest.raises(AosError, match=r"other failed on .* ValueError: a defect") as caught:
        await bus.ask(keys.project, ProjectQuery("first"), Catalogue, timeout_s=2)
    assert caught.value.code == "AOS606"
    assert await bus.ask(keys.project, ProjectQuery("second"), Catalogue, timeout_s=2) == Catalogue(())


async def test_a_question_or_answer_of_the_wrong_kind_is_malformed(bus: Bus, other: Bus, keys: Keys):
    async def describe(message: TopicMessage, _: str) -> Message:
        return message

    await other.answer(keys.project, TopicMessage, describe)

    with pytest.raises(BusError, match="no TopicMessage") as wrong_question:
        await bus.ask(keys.project, CatalogueQuery(), TopicMessage, timeout_s=2)
    with pytest.raises(BusError, match=rf"the answer on {keys.project}: no CatalogueEntry") as wrong_answer:
        await bus.ask(keys.project, TopicMessage(1, {}), CatalogueEntry, timeout_s=2)
    assert wrong_question.value.code == wrong_answer.value.code == "AOS602"
    for error in (wrong_question.value, wrong_answer.value):
        assert error.hint.startswith("The envelope can be read, its body cannot")


async def test_rubbish_as_a_question_is_refused(endpoint: str, other: Bus, keys: Keys):
    await other.answer(keys.catalogue, ProjectQuery, list_catalogue)
    rogue = await asyncio.to_thread(zenoh.open, client_config(endpoint))
    try:
        for payload in (None, b"", b"\xc1", b"\x81" * 50_000):
            replies = await asyncio.to_thread(lambda p=payload: list(rogue.get(keys.catalogue, payload=p)))
            assert [b"AOS602" in bytes(reply.err.payload) for reply in replies if reply.err] == [True]
    finally:
        await asyncio.to_thread(rogue.close)


async def test_an_oversize_message_never_leaves(bus: Bus, other: Bus, keys: Keys):
    async def reply_with_too_much(_: ProjectQuery, __: str) -> Message:
        return TopicMessage(1, {"data": bytes(17 * 2**20)})

    await other.answer(keys.project, ProjectQuery, reply_with_too_much)

    with pytest.raises(BusError, match="too large"):
        await bus.ask(keys.project, TopicMessage(1, {"data": bytes(17 * 2**20)}), Catalogue, timeout_s=2)
    with pytest.raises(BusError, match="too large"):
        await bus.ask(keys.project, ProjectQuery(), TopicMessage, timeout_s=5)
