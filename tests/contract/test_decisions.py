import asyncio
from collections.abc import AsyncIterator

import pytest
import pytest_asyncio
from decision_records import decision_record

from aos_protocol.keys import Keys
from aos_protocol.messages import DecisionRecord, History, HistoryQuery, Message, MissionQuery, MissionState
from aos_runtime.bus.bus import Bus
from aos_runtime.client import AosClient
from aos_runtime.parties.decision_feed import DecisionFeed


def record(sequence: int, mission: str = "m") -> DecisionRecord:
    return decision_record(sequence, mission, "pick", model_digest="", simulations=10, horizon=10)


class Storyteller:
    """A solver as far as its decisions go."""

    def __init__(self, bus: Bus, keys: Keys):
        self.records: list[DecisionRecord] = []
        self.state = MissionState("m", "acting", 1, 0.5)
        self.page = 1000
        self.pages = 0
        self.is_late = False
        self._bus = bus
        self._keys = keys

    async def appear(self):
        await self._bus.answer(self._keys.decision_history, HistoryQuery, self._history)
        await self._bus.answer(self._keys.mission_state, MissionQuery, self._state)
        await self._bus.announce(self._keys.live("solver"))

    def decide(self, *, is_lost: bool = False):
        """The next record, which the stream may lose on its way."""
        self.records.append(record(len(self.records)))
        if not is_lost:
            self._bus.tell(self._keys.decisions, self.records[-1])

    def end(self):
        self.state = MissionState("m", "ended", 3, 0.95, ending="goal")
        self._bus.tell(self._keys.mission_state, self.state)

    async def _history(self, query: HistoryQuery, _: str) -> Message:
        if self.is_late:
            self.is_late = False
            await asyncio.Event().wait()
        end = query.since + self.page
        self.pages += 1
        return History("m", tuple(self.records[query.since : end]), has_more=len(self.records) > end)

    async def _state(self, _: MissionQuery, __: str) -> Message:
        return self.state


@pytest.fixture
def keys(request) -> Keys:
    """A robot of its own for each test, as the tests' streams must not mix."""
    return Keys(request.node.name[-60:])


@pytest_asyncio.fixture
async def solver(other: Bus, keys: Keys) -> AsyncIterator[Storyteller]:
    yield Storyteller(other, keys)


@pytest_asyncio.fixture
async def client(bus: Bus, keys: Keys) -> AosClient:
    return AosClient(bus, keys.robot)


async def sequences(client: AosClient) -> list[int]:
    return [decision.sequence async for decision in client.decisions()]


async def test_who_joins_late_gets_everything_from_the_first_step(client: AosClient, solver: Storyteller):
    await solver.appear()
    for _ in range(5):
        solver.decide()
    following = client.decisions()
    assert [(await anext(following)).sequence for _ in range(5)] == [0, 1, 2, 3, 4]
    solver.decide()
    solver.end()
    assert [decision.sequence async for decision in following] == [5]


async def test_a_long_history_comes_page_after_page(client: AosClient, solver: Storyteller):
    solver.page = 3
    await solver.appear()
    for _ in range(10):
        solver.decide()
    assert [record.sequence async for record in client.history()] == list(range(10))
    assert solver.pages == 4
    solver.end()
    assert await sequences(client) == list(range(10))


async def test_a_history_that_is_late_is_asked_for_again(client: AosClient, solver: Storyteller, monkeypatch):
    monkeypatch.setattr("aos_runtime.client._ANSWER_S", 0.3)
    await solver.appear()
    solver.decide(is_lost=True)
    solver.end()
    solver.is_late = True
    assert [record.sequence async for record in client.history()] == [0]


async def test_who_comes_before_the_solver_waits_for_it(client: AosClient, solver: Storyteller):
    async with asyncio.TaskGroup() as tasks:
        following = tasks.create_task(sequences(client))
        await solver.appear()
        for _ in range(3):
            solver.decide()
        solver.end()
    assert following.result() == [0, 1, 2]


async def test_a_gap_in_the_stream_is_filled(client: AosClient, solver: Storyteller):
    await solver.appear()
    solver.decide()
    following = client.decisions()
    assert (await anext(following)).sequence == 0
    solver.decide(is_lost=True)
    solver.decide(is_lost=True)
    solver.decide()
    assert [(await anext(following)).sequence for _ in range(3)] == [1, 2, 3]
    solver.decide(is_lost=True)
    solver.end()
    assert [decision.sequence async for decision in following] == [4]


async def test_following_ends_when_the_solver_goes(endpoint: str, client: AosClient, keys: Keys):
    async with await Bus.open(endpoint, sender="solver") as mortal:
        solver = Storyteller(mortal, keys)
        await solver.appear()
        solver.decide()
        following = client.follow(away_s=0.1)
        assert isinstance(await anext(following), DecisionRecord)
    assert [event async for event in following if isinstance(event, DecisionRecord)] == []


async def test_who_comes_when_the_solver_has_gone_waits_as_long_as_was_said(client: AosClient):
    assert [event async for event in client.follow(begins_s=0.1)] == []


async def test_states_come_between_the_decisions(client: AosClient, solver: Storyteller):
    await solver.appear()
    solver.decide(is_lost=True)
    events = client.follow()
    assert isinstance(await anext(events), DecisionRecord)
    assert await anext(events) == solver.state
    solver.end()
    assert [event async for event in events] == [solver.state]


async def test_a_few_lines_are_enough(endpoint: str, solver: Storyteller, keys: Keys):
    await solver.appear()
    solver.decide()
    solver.end()
    async with AosClient.connect(endpoint, keys.robot) as aos:
        assert [decision.action async for decision in aos.decisions()] == ["pick"]


def test_a_feed_gives_each_record_once_and_in_order():
    feed = DecisionFeed()
    assert [r.sequence for r in feed.take(record(0))] == [0]
    assert feed.take(record(0)) == []
    assert feed.take(record(2)) == []
    assert feed.has_gap
    history = History("m", (record(1), record(2), record(3)))
    assert [r.sequence for r in feed.take_history(history)] == [1, 2, 3]
    assert not feed.has_gap


async def test_a_solver_of_another_mission_is_followed_from_its_first_record(
    endpoint: str, client: AosClient, solver: Storyteller, keys: Keys
):
    async with await Bus.open(endpoint, sender="first") as mortal:
        first = Storyteller(mortal, keys)
        await first.appear()
        for _ in range(3):
            first.decide()
        following = client.decisions()
        assert [(await anext(following)).sequence for _ in range(3)] == [0, 1, 2]
    solver.page = 2
    solver.records = [record(number, mission="next") for number in range(5)]
    await solver.appear()
    solver.end()
    decisions = [decision async for decision in following]
    assert [(decision.mission, decision.sequence) for decision in decisions] == [
        ("next", number) for number in range(5)
    ]
