"""The outside of a mission as ports: the robot, the record of what happens, the supply of models.

`aos_solver.bus_ports` gives a mission the bus and the disk; `simulation` gives it a hidden state.
"""

from collections.abc import Collection, Mapping
from typing import Protocol

from aos_protocol.messages import Activate, DecisionRecord, Message, MissionState, Outcome
from aos_runtime.clock import Clock, SystemClock
from aos_solver.mission.models.past import Past
from aos_solver.mission.models.takeover import RunningModel, Takeover
from aos_solver.mission.rules.endings import Ending


class Available(Protocol):
    """The facts that a choice has to know of the robot."""

    clock: Clock

    @property
    def unavailable(self) -> Mapping[str, str]:
        """The skills that nobody could run now, each with the reason."""
        ...

    @property
    def returning(self) -> Collection[str]:
        """Those of them whose adapter is expected back."""
        ...

    @property
    def announced(self) -> Mapping[str, int]:
        """The count of announcements of each skill's adapter; 0 for skills that are not there."""
        ...

    async def until_changed(self, timeout_s: float) -> None:
        """Returns when other skills are available, when somebody wants the mission to go on, or in time."""
        ...


class Robot(Available, Protocol):
    @property
    def world_ending(self) -> Ending | None:
        """The ending of the world, where somebody sees it; nobody tells a real robot."""
        ...

    async def activate(self, request: Activate, action: str) -> Outcome:
        """Run the grounded action of this name; AosError when nobody can be asked or nobody answers."""
        ...


class Record(Protocol):
    """The journal and the audience of a mission.

    Where it `keeps_beliefs` the journal has whole beliefs too.
    """

    @property
    def keeps_beliefs(self) -> bool: ...

    def journal(self, kind: str, payload: Message) -> None:
        """Write durably; returns once it is on the disk."""
        ...

    def publish_record(self, record: DecisionRecord) -> None: ...

    def publish_state(self, state: MissionState) -> None: ...


class Models(Protocol):
    """The supply of models while the mission runs."""

    async def newest_model(self, running: RunningModel, past: Past) -> Takeover | None:
        """The model that takes over before the next decision, with its belief; None if the same one goes on.

        The `past` is that of the running model's belief.
        """
        ...


class Ports(Robot, Record, Models, Protocol):
    """Everything that a mission needs from outside."""


class QuietPorts:
    """The ports, but for the robot itself, of a mission that nobody follows.

    Nothing is journalled or told. The skills stay available, and the model stays the same.
    """

    clock: Clock = SystemClock()
    unavailable: Mapping[str, str] = {}
    returning: Collection[str] = ()
    announced: Mapping[str, int] = {}
    world_ending: Ending | None = None
    keeps_beliefs: bool = False

    async def until_changed(self, timeout_s: float) -> None:
        """Nothing ever changes."""

    def journal(self, kind: str, payload: Message) -> None:
        """Nothing is kept."""

    def publish_record(self, record: DecisionRecord) -> None:
        """Does nothing: nobody listens."""

    def publish_state(self, state: MissionState) -> None:
        """Does nothing: nobody listens."""

    async def newest_model(self, running: RunningModel, past: Past) -> Takeover | None:
        """The same model goes on."""
        return None
