"""The end of a mission that somebody stops: what moves for it is cancelled, until it has ended."""

import asyncio
from contextlib import suppress

from aos_protocol.errors import AosError
from aos_protocol.keys import Keys
from aos_protocol.messages import Cancel, Cancelled
from aos_runtime.bus.bus import Bus
from aos_runtime.parties.served import served
from aos_solver.mission.loop import Mission

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
