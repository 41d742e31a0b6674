import asyncio

import pytest
from adapter_process import AdapterProcess
from starting import until_present

from aos_protocol.errors import SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import ActivationId, Cancel, SkillCall
from aos_runtime.adapters import AdapterSettings, Binding, Call
from aos_runtime.adapters.calls import Calls
from aos_runtime.adapters.outbox import MAX_UNSENT_MESSAGES, Outbox
from aos_runtime.adapters.pauses import Pauses
from aos_runtime.bus.bus import Bus
from aos_runtime.clock import SystemClock
from aos_runtime.processes.lifecycle import Service

ARM = """
class Arm:
    version = "1"

    def __init__(self, host):
        self.host = host

    async def start(self):
        await self.host.serve("/wave", "/drop")

    def call(self, call):
        if call.target == "/drop":
            raise RuntimeError("it slipped")
        return {"success": True}

    async def close(self):
        pass
"""


async def test_a_call_that_is_no_coroutine_fails_and_is_told_how_to_write_it(
    bus: Bus, keys: Keys, endpoint: str, tmp_path
):
    (tmp_path / "hasty_arm.py").write_text(ARM)
    arm = AdapterProcess(bus, keys, endpoint, tmp_path)
    bound = {path: Binding() for path in ("/wave", "/drop")}
    try:
        async with until_present(bus, keys.live("arm")):
            await arm.launched("arm", adapter="hasty_arm:Arm", folder=str(tmp_path), bind=bound)
        with pytest.raises(SkillError, match="/wave answered at once") as told:
            await arm.ask(SkillCall(ActivationId("m", 1), "/wave", {}, 20.0))
        assert (told.value.code, "`async def call(self, call)`" in told.value.hint) == ("AOS510", True)
        with pytest.raises(SkillError, match="/drop failed: RuntimeError: it slipped"):
            await arm.ask(SkillCall(ActivationId("m", 2), "/drop", {}, 20.0))
    finally:
        await arm.stop()


class StopsLate:
    """Ends just when it was given up as stuck."""

    version = "1"

    def __init__(self):
        self.is_called, self.is_given_up = asyncio.Event(), asyncio.Event()

    async def start(self): ...

    async def close(self): ...

    async def call(self, call: Call) -> dict[str, object]:
        self.is_called.set()
        try:
            return await asyncio.Future()
        except asyncio.CancelledError:
            await self.is_given_up.wait()
            raise


class Loud:
    """Publishes three messages more than can wait, before anything is sent."""

    async def call(self, call: Call) -> dict[str, object]:
        for number in range(MAX_UNSENT_MESSAGES + 3):
            call.publish("/noise", number=number)
        return {}


async def test_a_result_tells_how_many_messages_of_its_call_came_too_fast(
    bus: Bus, keys: Keys, endpoint: str, tmp_path
):
    settings = AdapterSettings(
        robot=keys.robot, service="arm", endpoint=endpoint, run_dir=str(tmp_path), adapter=""
    )
    outbox = Outbox(bus, keys)
    calls = Calls(Service(settings, bus, SystemClock()), outbox, Pauses(), lambda _: True, lambda _: None)
    calls.go_to(Loud())
    results = [await calls.run(SkillCall(ActivationId("m", step), "/wave", {}, 20.0), "") for step in (1, 2)]
    calls.close()
    assert [result.lost for result in results] == [{"/noise": 3}] * 2
    assert results[1].published == {"/noise": 2 * MAX_UNSENT_MESSAGES}


async def test_calls_have_turns_between_the_messages_that_wait(bus: Bus, keys: Keys, monkeypatch):
    monkeypatch.setattr("aos_runtime.adapters.outbox._TURN_S", 0.0)
    outbox = Outbox(bus, keys)
    loop, all_are_sent = asyncio.get_running_loop(), asyncio.Event()
    sent_at_turns: list[int] = []

    def take_turn():
        sent_at_turns.append(outbox.sent.get("/noise", 0))
        if sent_at_turns[-1] < 3:
            loop.call_soon(take_turn)
        else:
            all_are_sent.set()

    for number in range(3):
        outbox.publish("/noise", {"number": number})
    loop.call_soon(take_turn)
    async with asyncio.timeout(20):
        await all_are_sent.wait()
    assert sent_at_turns == [1, 2, 3]


async def test_a_call_that_was_told_as_stuck_is_told_as_stopped_to_nobody(
    bus: Bus, keys: Keys, endpoint: str, tmp_path
):
    settings = AdapterSettings(
        robot=keys.robot, service="arm", endpoint=endpoint, run_dir=str(tmp_path), adapter="", cancel_s=0.1
    )
    arm = StopsLate()
    calls = Calls(
        Service(settings, bus, SystemClock()),
        Outbox(bus, keys),
        Pauses(),
        lambda _: True,
        lambda _: arm.is_given_up.set(),
    )
    calls.go_to(arm)
    answer = asyncio.create_task(calls.run(SkillCall(ActivationId("m", 1), "/wave", {}, 20.0), ""))
    await arm.is_called.wait()
    told = await asyncio.gather(calls.cancel(Cancel("enough"), ""), answer, return_exceptions=True)
    calls.close()
    assert [getattr(each, "code", each) for each in told] == ["AOS504", "AOS504"]
