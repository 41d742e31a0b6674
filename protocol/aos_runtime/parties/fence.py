"""The requests of a mission that count: those of its newest solver, and each id for one motion only.

A solver that was replaced may still have messages on their way, and somebody else may use ids or epochs
that are not his. Middleware and adapters each have a fence.
"""

import asyncio
import hashlib
from collections.abc import Awaitable, Callable

import msgspec

from aos_protocol.errors import AosError, SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import Activate, ActivationId, Cancel, MissionQuery, MissionState, SkillCall
from aos_runtime.bus.bus import Bus
from aos_runtime.disk.mission_folders import is_before, number_of

_ASK_TIMEOUT_S = 5.0
_LINK_S = 0.2
_LINK_TIMES = 10
"""A client whose link was lost finds back to the router within so many times of `_LINK_S`."""


def meaning(request: Activate | SkillCall) -> str:
    """A digest of what a request's id stands for: skill and parameters, of a call by hand path and fields."""
    if isinstance(request, SkillCall):
        stands_for: object = (request.path, request.skill, request.parameters or request.fields)
    else:
        stands_for = (request.skill, request.parameters)
    return hashlib.blake2b(msgspec.json.encode(stands_for, order="deterministic"), digest_size=16).hexdigest()


class Fence:
    """Remembers the newest epoch of each mission and what each id stands for.

    `epoch_of_solver` tells the epoch that a mission's solver has in its journal; None if nobody knows it.
    """

    def __init__(self, epoch_of_solver: Callable[[str], Awaitable[int | None]]) -> None:
        self._epoch_of_solver = epoch_of_solver
        self._epochs: dict[str, int] = {}
        self._meanings: dict[ActivationId, str] = {}
        self._newest: dict[str, int] = {}

    def note(self, request: Activate | SkillCall) -> None:
        """Takes a request that was let through, now or by an earlier process.

        With the first one of a mission those of the missions before it in the same system are forgotten.
        """
        mission = request.id.mission
        if mission not in self._epochs:
            self._forget_before(mission)
        self._epochs[mission] = max(request.epoch, self._epochs.get(mission, 0))
        self._meanings[request.id] = meaning(request)

    async def check(self, request: Activate | SkillCall) -> None:
        """Returns if the request counts.

        SkillError AOS506 for an epoch that is not the mission's, and for a mission that another one of its
        system has followed. AOS514 for an id of another motion.
        """
        self._check_mission(request.id)
        await self._check_epoch(request.id, request.epoch)
        known = self._meanings.get(request.id)
        if known is not None and known != meaning(request):
            message = f"activation {request.id} stands for another skill or other parameters"
            hint = "Somebody has used an id that is not his; nothing moves for it"
            raise SkillError(message, code="AOS514", hint=hint)

    def is_stale(self, cancel: Cancel) -> bool:
        """Says whether a cancellation comes from a solver that was replaced."""
        return cancel.id is not None and cancel.epoch < self._epochs.get(cancel.id.mission, 0)

    def _forget_before(self, mission: str) -> None:
        if (place := number_of(mission)) is None:
            return
        run, number = place
        self._newest[run] = max(number, self._newest.get(run, 0))
        self._epochs = {name: epoch for name, epoch in self._epochs.items() if not is_before(name, mission)}
        self._meanings = {
            id: meaning for id, meaning in self._meanings.items() if not is_before(id.mission, mission)
        }

    def _check_mission(self, id: ActivationId) -> None:
        place = number_of(id.mission)
        if place is not None and place[1] < self._newest.get(place[0], 0):
            hint = f"Mission {self._newest[place[0]]} has begun since"
            raise SkillError(f"activation {id} comes from a mission that is over", code="AOS506", hint=hint)

    async def _check_epoch(self, id: ActivationId, epoch: int) -> None:
        newest = self._epochs.get(id.mission, 0)
        if epoch < newest:
            raise SkillError(f"activation {id} comes from an older epoch, {epoch}", code="AOS506")
        # The first one needs no word: it makes none stale. Any other would, if it were made up.
        if epoch > max(newest, 1) and await self._epoch_of_solver(id.mission) != epoch:
            message = f"activation {id} comes from epoch {epoch}, which is not the mission's"
            raise SkillError(message, code="AOS506", hint="Only the mission's solver counts its epochs")


def epoch_of_solver(bus: Bus, keys: Keys) -> Callable[[str], Awaitable[int | None]]:
    """Asks the solver on the bus for the epoch of its mission."""

    async def asked(mission: str) -> int | None:
        state = await _state_of_solver(bus, keys)
        return state.epoch if state is not None and state.mission == mission else None

    return asked


async def is_waited_for(bus: Bus, keys: Keys, id: ActivationId) -> bool | None:
    """Asks the solver on the bus whether it waits for this activation; None where it does not answer.

    Whoever asks may just have lost its own link, and asks for a while. A call by hand is none of the
    solver's: whoever made it waits for it.
    """
    state = await _state_of_solver(bus, keys)
    for _ in range(_LINK_TIMES):
        if state is not None:
            break
        await asyncio.sleep(_LINK_S)
        state = await _state_of_solver(bus, keys)
    if state is None:
        return None
    return state.mission != id.mission or (state.phase == "acting" and state.step == id.step)


async def _state_of_solver(bus: Bus, keys: Keys) -> MissionState | None:
    try:
        return await bus.ask(keys.mission_state, MissionQuery(), MissionState, timeout_s=_ASK_TIMEOUT_S)
    except AosError:
        return None
