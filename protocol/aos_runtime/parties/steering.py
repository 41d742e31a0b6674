"""The questions with which an operator starts a mission and steers the one that runs."""

import getpass
import socket
import uuid
from collections.abc import Iterable

from msgspec.structs import replace

from aos_protocol.keys import Keys
from aos_protocol.messages import MissionState, StartMission, Steer, SteeringVerb
from aos_runtime.bus.bus import Bus
from aos_runtime.parties.asking import ask_until_answered

START_TIMEOUT_S = 600.0
"""A mission starts once its model is compiled, and the engine where set-up has not done that."""

STEER_TIMEOUT_S = 300.0
"""A mission that is stopped ends once what moves has stopped; an action waits for the step that runs."""


async def start_mission(bus: Bus, keys: Keys, start: StartMission) -> MissionState:
    """Has the solver start a mission, once; it may be started again before it has answered."""
    return await ask_until_answered(
        bus, keys.start_mission, start, MissionState, server=keys.live("solver"), timeout_s=START_TIMEOUT_S
    )


class SteeringQuestions:
    """Asks on a bus, under the name `by`; by default user and host of this process."""

    def __init__(self, bus: Bus, keys: Keys, by: str = "") -> None:
        self.bus = bus
        self.keys = keys
        self.by = by or _user()

    async def hold(self) -> MissionState:
        """Has the mission decide nothing more, and drops what was asked for; errors are those of `steer`."""
        return await self.steer("hold")

    async def step(self) -> MissionState:
        """Has the mission make one more decision and hold then; errors are those of `steer`."""
        return await self.steer("step")

    async def resume(self) -> MissionState:
        """Lets a mission go on that holds; errors are those of `steer`."""
        return await self.steer("resume")

    async def act(self, action: str) -> MissionState:
        """Has a grounded action carried out at the next decision, also while the mission holds.

        Returns once it was decided for. SteeringError AOS518 says why it is refused: a constraint, a skill
        that cannot be run or is left out. Other errors are those of `steer`.
        """
        return await self.steer("act", actions=(action,))

    async def run_script(self, actions: Iterable[str]) -> MissionState:
        """Has grounded actions carried out one after the other, also while the mission holds.

        Returns at once. Where one of them is refused or fails, the rest is dropped and the mission holds.
        Errors are those of `steer`.
        """
        return await self.steer("script", actions=tuple(actions))

    async def leave_out(self, name: str) -> MissionState:
        """Has decisions do without a skill or a grounded action; errors are those of `steer`."""
        return await self.steer("leave_out", name=name)

    async def take_back(self, name: str) -> MissionState:
        """Has decisions use again what was left out; errors are those of `steer`."""
        return await self.steer("take_back", name=name)

    async def steer(
        self, verb: SteeringVerb, *, actions: tuple[str, ...] = (), name: str = ""
    ) -> MissionState:
        """Steers the mission that runs, once: see Steer. Returns its state.

        SteeringError AOS517 says why that cannot be done; nothing has changed then.
        """
        return await self.carry_out(Steer(verb, actions, name, self.by))

    async def carry_out(self, wish: Steer) -> MissionState:
        """Steers by a whole wish, once, whatever its `request` says; errors are those of `steer`."""
        return await ask_until_answered(
            self.bus,
            self.keys.steer_mission,
            replace(wish, request=uuid.uuid4().hex),
            MissionState,
            server=self.keys.live("solver"),
            timeout_s=STEER_TIMEOUT_S,
        )


def _user() -> str:
    """Returns user and host of this process; a container may have no name for the user."""
    try:
        user = getpass.getuser()
    except (KeyError, OSError, ImportError):
        user = "somebody"
    return f"{user}@{socket.gethostname()}"
