"""The outside of an activation, which the service makes once."""

from collections.abc import Callable
from typing import NamedTuple

from aos_middleware.mappings.low_level import LowLevelValues
from aos_middleware.mappings.monitors import Monitors
from aos_middleware.robot.motion_gate import MotionGate
from aos_middleware.robot.odd_data import OddNumbers, SilentTopics
from aos_middleware.robot.served_paths import ServedPaths
from aos_protocol.keys import Keys
from aos_protocol.messages import Stray
from aos_runtime.bus.bus import Bus
from aos_runtime.clock import Clock


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
