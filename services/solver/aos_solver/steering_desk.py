"""The desk of a solver where operators ask: finds the mission that runs, and answers when it has turned."""

import uuid
from collections.abc import Callable

import msgspec

from aos_protocol.errors import SteeringError
from aos_protocol.keys import Keys
from aos_protocol.messages import MissionState, Steer, StopMission
from aos_runtime.bus.bus import Bus
from aos_solver.mission_runner import MissionRunner
from aos_solver.stopping import until_stopped

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
        steer = msgspec.structs.replace(
            steer, by=steer.by or _SOMEBODY, request=steer.request or uuid.uuid4().hex
        )
        mission.steer(steer)
        self._on_turn()
        if steer.verb == "act":
            await mission.until_decided(steer.request)
        elif steer.verb == "stop":
            await until_stopped(mission, steer.reason, self._missions.ended, self._bus, self._keys)
        return mission.state
