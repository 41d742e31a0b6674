import os
import sys
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import msgspec
from tests.hostile.attempt import Attempt


class Line(msgspec.Struct, frozen=True, array_like=True):
    """An attempt of somebody in a round. `load` is the machine's, of the last minute."""

    at: str
    who: str
    round: int
    kind: str
    name: str
    way: str
    told_s: float | None
    processor_s: float
    load: float
    faults: tuple[str, ...]


class Log:
    """The lines of one who plays. They are printed, and added to a file that others may use as well."""

    def __init__(self, path: Path | None, who: str):
        self._path = path
        self._who = who
        kept = path.read_bytes().splitlines() if path is not None and path.exists() else []
        self.all_lines = [msgspec.json.decode(line, type=Line) for line in kept]

    @property
    def lines(self) -> list[Line]:
        """Those of who plays."""
        return [line for line in self.all_lines if line.who == self._who]

    def has(self, number: int, kind: str, name: str, way: str) -> bool:
        wanted = (number, kind, name, way)
        return any((line.round, line.kind, line.name, line.way) == wanted for line in self.lines)

    def add(self, number: int, attempt: Attempt):
        told_s = None if attempt.told_s is None else round(attempt.told_s, 2)
        at = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
        case = (attempt.kind, attempt.name, attempt.way)
        spent_s, load = round(attempt.processor_s, 2), round(os.getloadavg()[0], 1)
        line = Line(at, self._who, number, *case, told_s, spent_s, load, attempt.faults)
        self.all_lines.append(line)
        if self._path is not None:
            with self._path.open("ab") as file:
                file.write(msgspec.json.encode(line) + b"\n")
        told = "-" if told_s is None else f"{told_s:.1f} s"
        print(f"{number}: {line.kind} that {line.name}, {line.way}: {told}  {'; '.join(line.faults)}")
        sys.stdout.flush()


def who_plays() -> str:
    """Returns who the process is: root, root without user namespaces, or a user."""
    if os.getuid() != 0:
        return "user"
    namespaces = Path("/proc/sys/user/max_user_namespaces")
    return "closed" if namespaces.exists() and int(namespaces.read_text()) == 0 else "root"


def summary(lines: Iterable[Line], in_time_s: float) -> str:
    """A line for each who plays: how many of each kind, how many broke a promise, and the latest word."""
    lines = list(lines)
    told = []
    for who in sorted({line.who for line in lines}):
        own = [line for line in lines if line.who == who]
        kinds = Counter(line.kind for line in own)
        counted = ", ".join(f"{count} of {kind}s" for kind, count in kinds.items())
        broken = sum(bool(line.faults) for line in own)
        all_s = [line.told_s for line in own if line.told_s is not None]
        early = sum(one_s <= in_time_s for one_s in all_s)
        spent_s = sum(line.processor_s for line in own)
        told.append(
            f"{who}: {counted}: {broken} broke a promise; {early} of {len(all_s)} were told within "
            f"{in_time_s:g} s, the last after {max(all_s, default=0.0):.1f} s; "
            f"{spent_s:.0f} s of processor time"
        )
    return "\n".join(told)
