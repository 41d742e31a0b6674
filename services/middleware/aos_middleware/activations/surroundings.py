"""The outside of an activation, which the service makes once, with the ledger of those that were started."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from aos_middleware.mappings.low_level import LowLevelValues
from aos_middleware.mappings.monitors import Monitors
from aos_middleware.robot.motion_gate import MotionGate
from aos_middleware.robot.odd_data import OddNumbers, SilentTopics
from aos_middleware.robot.served_paths import ServedPaths
from aos_protocol.keys import Keys
from aos_protocol.messages import Activate, ActivationId, Outcome, Stray
from aos_runtime.bus.bus import Bus
from aos_runtime.clock import Clock
from aos_runtime.disk.ledger import Ledger


class Surroundings(NamedTuple):
    """The outside of an activation: the bus, the robot's keys, the time.

    `published` is what had been sent on each topic when the last call ended; each activation updates it.
    `low_level` holds the values that responses have given. `on_stray` is told of replies that are not used.
    `is_played` says whether the skill at a path is played by its document.
    """

    bus: Bus
    keys: Keys
    clock: Clock
    published: dict[str, int]
    low_level: LowLevelValues
    served: ServedPaths
    gate: MotionGate
    on_stray: Callable[[Stray], None]
    is_played: Callable[[str], bool]
    monitors: Monitors
    silent: SilentTopics
    odd: OddNumbers


class OutcomeLedger(Ledger[Activate, Outcome]):
    """Outcomes by activation id. Those that assigned low-level values outlive their missions, as the values
    do."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, Activate, {"ended": Outcome})

    def note(self, stray: Stray) -> None:
        """Keeps a reply that was not used."""
        self._journal.append("stray", stray)

    def outcomes(self) -> list[Outcome]:
        """Returns the outcomes of the activations that ended, in the order in which they were started."""
        return [self._ended[id] for id in self._started if id in self._ended]

    def outcome(self, activation: ActivationId) -> Outcome | None:
        """The outcome of an activation that has ended; None for every other one."""
        return self._ended.get(activation)

    def outlives(self, end: Outcome) -> bool:
        return bool(end.assigned)
