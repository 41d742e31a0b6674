"""The pictures that a world's adapter has kept of a run, one after each step, with the times of the steps."""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from aos_deploy.export.kept_missions import KeptMission

_NAME = re.compile(r"step-(\d+)\.png")


class Picture(NamedTuple):
    """A picture after a step."""

    path: Path
    step: int
    stamp_ns: int


def pictures_of(run: Path, missions: Iterable[KeptMission]) -> list[Picture]:
    """The pictures of a run in the order of their times.

    Its time is that of the outcome of its step. In a system that stays a picture is of the mission that had
    this step when it was written: a later mission has written over those of earlier ones.
    """
    ends: dict[int, list[int]] = {}
    for mission in missions:
        for record in mission.decisions():
            if record.outcome is not None:
                ends.setdefault(record.step, []).append(record.outcome.ended_ns or record.stamp_ns)
    found = []
    for path in (run / "pictures").glob("step-*.png"):
        if name := _NAME.fullmatch(path.name):
            step, written_ns = int(name[1]), path.stat().st_mtime_ns
            stamp_ns = min(ends.get(step, [written_ns]), key=lambda end_ns: abs(end_ns - written_ns))
            found.append(Picture(path, step, stamp_ns))
    return sorted(found, key=lambda picture: (picture.stamp_ns, picture.step))
