"""The world as the adapter sees it: skills by path, sensors by topic, the truth, and pictures.

A world is a folder under `worlds` whose `__init__` has a `KIND`. Nothing outside the folder knows its words.
Faults that a simulator cannot produce are drawn from the mission's seed and kept for the record.
"""

import random
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from aos_skills.pybullet.parts.room_file import RoomFile
from aos_skills.pybullet.parts.scene import Camera, Scene


class Faults:
    """`drawn` holds the faults of the current call; `noise` is the source of perception's errors.

    Faults and noise have generators of their own, so that one more fault in a model does not shift the noise.
    """

    def __init__(self, seed: int) -> None:
        self._chance = random.Random(f"faults {seed}")
        self.noise = random.Random(f"perception {seed}")
        self.drawn: list[str] = []

    def draw(self, fault: str, probability: float) -> bool:
        """Draws whether a fault happens now."""
        happens = self._chance.random() < probability
        if happens:
            self.drawn.append(fault)
        return happens


Fields = dict[str, Any]
"""The fields of a request, an answer or a message, by name."""

AnyFile = TypeVar("AnyFile", bound=RoomFile)
AnyWorld = TypeVar("AnyWorld", bound="World")


class World(ABC):
    """A room, a robot in it, and the faults that are drawn."""

    scene: Scene
    camera: Camera
    faults: Faults

    def begin(self) -> None:
        """Draws the faults that last as long as a call of a skill; it is called before each."""
        self.faults.drawn.clear()

    def close(self) -> None:
        """Ends the world."""
        self.scene.close()

    @abstractmethod
    def stop(self) -> None:
        """The robot holds still where it is; time does not pass."""

    @abstractmethod
    def sensors(self) -> dict[str, Fields]:
        """Returns what the robot's sensors give now, by topic."""

    @abstractmethod
    def truth(self) -> Fields:
        """The state of the world, for the record; the robot is not told."""

    def record(self, step: int, path: str, fields: Fields) -> Fields:
        """A line of the record: what was called at a step, and the world's truth after it."""
        called = {"step": step, "path": path, "fields": fields, "time_s": round(self.scene.time_s, 3)}
        return {**called, **self.truth(), "drawn_faults": list(self.faults.drawn)}


@dataclass(frozen=True)
class WorldKind(Generic[AnyFile, AnyWorld]):
    """`file` is the form of its world files; `build` makes a world from one and a seed.

    A skill takes the world and the request's fields and returns the answer's.
    """

    file: type[AnyFile]
    build: Callable[[AnyFile, int], AnyWorld]
    skills: Mapping[str, Callable[[AnyWorld, Fields], Fields]]
