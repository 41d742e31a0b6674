"""The desk of a solver where operators ask: finds the mission that runs, and answers when it has turned.

Where they end it, what moves for it is cancelled, until it has ended.
"""

import asyncio
import uuid
from collections.abc import Callable
from contextlib import suppress

from msgspec.structs import replace

from aos_protocol.errors import AosError, SteeringError
from aos_protocol.keys import Keys
from aos_protocol.messages import Cancel, Cancelled, MissionState, Steer, StopMission
from aos_runtime.bus.bus import Bus
from aos_runtime.parties.served import served
from aos_solver.mission.loop import Mission
from aos_solver.mission_runner import MissionRunner

_SOMEBODY = "somebody"


class SteeringDesk:
    """Answers those who steer; `on_turn` wakes the mission."""

    def __init__(self, missions: MissionRunner, on_turn: Callable[[], None], bus: Bus, keys: Keys) -> None:
        self._missions = missions
        self._on_turn = on_turn
        self._bus = bus
        self._keys = keys

    async def stop(self, stop: StopMission) -> MissionState:
        """Ends the mission that runs, or keeps the one from beginning that is about to; returns when that is
        so."""
        if stop.mission in ("", self._missions.state.mission):
            await self._missions.give_up_start(stop.reason)
        mission = await self._missions.running()
        if mission is None or stop.mission not in ("", mission.state.mission):
            return self._missions.state
        return await self.take(Steer("stop", by=stop.by, reason=stop.reason))

    async def take(self, steer: Steer) -> MissionState:
        """Steers the mission that runs; the answer is as in Steer. SteeringError where it cannot be done."""
        mission = await self._missions.running()
        if mission is None and steer.verb == "stop":
            return await self.stop(
                StopMission(steer.mission, steer.reason or f"stopped by {steer.by}", steer.by)
            )
        if mission is None:
            is_first_to_come = self._missions.state.phase in ("waiting", "compiling")
            if is_first_to_come:
                hint = "Wait until its model is compiled, or begin one by `aos mission start`"
                raise SteeringError("no mission has begun", hint=hint)
            raise SteeringError("no mission runs", hint="See `aos mission list`")
        if steer.mission not in ("", mission.state.mission):
            raise SteeringError(f"{steer.mission} does not run, {mission.state.mission} does")
        steer = replace(steer, by=steer.by or _SOMEBODY, request=steer.request or uuid.uuid4().hex)
        mission.steer(steer)
        self._on_turn()
        if steer.verb == "act":
            await mission.until_decided(steer.request)
        elif steer.verb == "stop":
            await until_stopped(mission, steer.reason, self._missions.ended, self._bus, self._keys)
        return mission.state


CANCEL_AGAIN_S = 0.2
"""A mission that is stopped cancels again after this time: what it asked for may not have begun before."""
CANCEL_TIMEOUT_S = 5.0


async def until_stopped(mission: Mission, reason: str, ended: asyncio.Event, bus: Bus, keys: Keys) -> None:
    """Returns when a mission that was told to stop has ended, which `ended` tells."""
    while mission.state.phase != "ended":
        await _cancel(mission, reason, bus, keys)
        with suppress(TimeoutError):
            async with asyncio.timeout(CANCEL_AGAIN_S):
                await ended.wait()


async def _cancel(mission: Mission, reason: str, bus: Bus, keys: Keys) -> None:
    """Cancels what the mission has asked for, whoever serves it."""
    if mission.activation is None:
        return
    cancel = Cancel(reason, mission.activation, mission.state.epoch)
    # All at once: one that is slow to answer keeps nothing else moving.
    questions = [
        bus.ask(keys.cancel(path), cancel, Cancelled, timeout_s=CANCEL_TIMEOUT_S)
        for path in sorted({server.path for server in await served(bus, keys)})
    ]
    answers = await asyncio.gather(*questions, return_exceptions=True)
    for answer in answers:
        if isinstance(answer, BaseException) and not isinstance(answer, AosError):
            raise answer
