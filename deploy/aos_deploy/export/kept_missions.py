"""The missions of a run as they are kept: each row of their journals, with its message."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from aos_protocol.messages import DecisionRecord
from aos_protocol.mission_rows import DECISION
from aos_runtime.disk.journal import Journal, JournalRow
from aos_runtime.disk.mission_folders import mission_folders, mission_name


class KeptMission(NamedTuple):
    """A mission's name and its journal."""

    name: str
    journal: Path

    def rows(self) -> Iterator[JournalRow]:
        """The rows in their order; StorageError AOS702 at one that is damaged."""
        with Journal.read(self.journal) as journal:
            yield from journal.walk()

    def decisions(self) -> Iterator[DecisionRecord]:
        """The decision records in their order; StorageError AOS702 at a row that is damaged."""
        with Journal.read(self.journal) as journal:
            for row in journal.walk(DECISION):
                yield row.read_as(DecisionRecord)


def kept_missions(run: Path) -> list[KeptMission]:
    """The missions of a run that have a journal, the oldest first."""
    run = run.resolve()
    folders = mission_folders(run)
    places = [(mission_name(run, number), folder) for number, folder in folders.items()]
    found = [KeptMission(name, folder / "journal.db") for name, folder in places or [(run.name, run)]]
    return [mission for mission in found if mission.journal.is_file()]
