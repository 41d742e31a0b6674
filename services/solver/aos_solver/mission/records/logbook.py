"""The missions of a run, each with its journal: one alone, or one after the other in a system that stays."""

from pathlib import Path

from msgspec.structs import replace

from aos_protocol.errors import SkillError
from aos_protocol.messages import Message, MissionBegun, MissionEntry, MissionState, StartMission
from aos_protocol.mission_rows import BEGUN, STATE
from aos_runtime.disk.journal import Journal, rows_of
from aos_runtime.disk.mission_folders import (
    JOURNAL,
    journals,
    make_mission_folder,
    mission_folder,
    mission_name,
    number_in,
)
from aos_solver.mission.records.memory import MissionMemory, folded


class Logbook:
    """The journal of one mission, and what it held when it was opened. `number` is 0 for the only one."""

    def __init__(self, name: str, path: Path, number: int, seed: int) -> None:
        self.name = name
        self.path = path
        self.number = number
        self.seed = seed
        self._journal = Journal.open(path)
        self.memory = folded(self._journal.walk())
        self.start = self.memory.begun.start if self.memory.begun is not None else None

    def append(self, kind: str, payload: Message) -> None:
        """Writes a row durably."""
        self._journal.append(kind, payload)
        if isinstance(payload, MissionBegun):
            self.start = payload.start

    def end(self, state: MissionState) -> None:
        """Writes the end of a mission that has not begun."""
        self.append(STATE, state)
        self.memory = replace(self.memory, state=state)

    def forget_steps(self) -> None:
        """Lets go of what is needed once: a long mission has many steps."""
        self.memory = replace(self.memory, steps=(), pending=None)

    def close(self) -> None:
        self._journal.close()


class Logbooks:
    """The logbooks of a run. `newest` is that of the mission that runs or ran last, None before the first."""

    newest: Logbook | None

    def __init__(self, run: Path, seed: int, *, stay: bool) -> None:
        self.run = run
        self._seed = seed
        self._entries: dict[int, MissionEntry] = {}
        if not stay:
            self.newest = Logbook(run.name, run / JOURNAL, 0, seed)
            return
        numbers = [number for number, path in journals(run).items() if path.exists()]
        self.newest = self._book(numbers[-1]) if numbers else None
        if self.newest is not None and self.newest.memory.epoch == 0:
            # Its solver died before it began.
            self.newest.close()
            self.newest = self._book(numbers[-2]) if len(numbers) > 1 else None

    @property
    def next_number(self) -> int:
        return self.newest.number + 1 if self.newest is not None else 1

    @property
    def last_request(self) -> str:
        """The request by which the newest mission was begun; empty where that was none of its own."""
        start = self.newest.start if self.newest is not None else None
        return start.request if start is not None else ""

    @property
    def next_seed(self) -> int:
        """The seed of the next mission: that of a system of its own with a seed as much higher."""
        return self._seed + self.next_number - 1

    @property
    def name(self) -> str:
        """The name of the newest mission, or of the first one to come."""
        return self.newest.name if self.newest is not None else mission_name(self.run, 1)

    def open_next(self) -> Logbook:
        """Turns to the next mission; StorageError AOS701 if it cannot be written."""
        number = self.next_number
        make_mission_folder(self.run, number)
        before, self.newest = self.newest, self._book(number)
        if before is not None:
            before.close()
        return self.newest

    def memory_of(self, number: int) -> MissionMemory:
        """The memory of an earlier mission; StorageError AOS702 if its journal cannot be read."""
        return folded(rows_of(mission_folder(self.run, number) / JOURNAL))

    def path_of(self, mission: str) -> Path:
        """The journal of a mission, by its name; SkillError AOS501 if there is none."""
        if self.newest is not None and mission in ("", self.newest.name):
            return self.newest.path
        for number, path in journals(self.run).items():
            if mission_name(self.run, number) == mission:
                return path
        raise SkillError(
            f"there is no mission {mission or 'yet'}", code="AOS501", hint="See `aos mission list`"
        )

    def entries(self) -> tuple[MissionEntry, ...]:
        """The missions so far, the oldest first. Those that have ended are read once."""
        for number, path in journals(self.run).items():
            known = self._entries.get(number)
            if known is None or not known.ended_ns:
                self._entries.update({entry.number: entry for entry in _entry(path, number)})
        return tuple(self._entries[number] for number in sorted(self._entries))

    def close(self) -> None:
        if self.newest is not None:
            self.newest.close()

    def _book(self, number: int) -> Logbook:
        path = mission_folder(self.run, number) / JOURNAL
        return Logbook(mission_name(self.run, number), path, number, self._seed + number - 1)


def entries_of(run: Path) -> tuple[MissionEntry, ...]:
    """The missions in the folder of a run, the oldest first; StorageError AOS702 if one cannot be read."""
    return tuple(entry for number, path in journals(run).items() for entry in _entry(path, number))


def entry_of(run: Path, mission: str) -> MissionEntry | None:
    """The mission of this name in the folder of a run; None if it has not begun there."""
    number = number_in(run.name, mission)
    if number is None:
        return None
    return next(iter(_entry(mission_folder(run, number) / JOURNAL, number)), None)


def _entry(path: Path, number: int) -> list[MissionEntry]:
    if not path.exists():
        return []
    with Journal.read(path) as journal:
        first = next(journal.walk(BEGUN), None)
        states = journal.rows(STATE)
    if first is None:
        return []
    begun = first.read_as(MissionBegun)
    start = begun.start or StartMission()
    entry = MissionEntry(
        begun.mission, number, begun.seed, first.stamp_ns, start.belief, start.given, start.idle, start.values
    )
    if not states:
        return [entry]
    state = states[-1].read_as(MissionState)
    ended_ns = states[-1].stamp_ns if state.phase == "ended" else 0
    return [replace(entry, ended_ns=ended_ns, ending=state.ending, remark=state.remark, steps=state.step)]
