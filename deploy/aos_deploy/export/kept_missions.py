"""The missions of a run as they are kept: each row of their journals, with its message."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from aos_protocol.messages import DecisionRecord
from aos_protocol.mission_rows import DECISION
from aos_runtime.disk.journal import Journal, JournalRow, rows_of
from aos_runtime.disk.mission_folders import journals, mission_name


class KeptMission(NamedTuple):
    """A mission's name and its journal."""

    name: str
    journal: Path

    def rows(self) -> Iterator[JournalRow]:
        """The rows in their order; StorageError AOS702 at one that is damaged."""
        return rows_of(self.journal)

    def decisions(self) -> Iterator[DecisionRecord]:
        """The decision records in their order; StorageError AOS702 at a row that is damaged."""
        with Journal.read(self.journal) as journal:
            for row in journal.walk(DECISION):
                yield row.read_as(DecisionRecord)


def kept_missions(run: Path) -> list[KeptMission]:
    """The missions of a run that have a journal, the oldest first."""
    run = run.resolve()
    found = [KeptMission(mission_name(run, number), path) for number, path in journals(run).items()]
    return [mission for mission in found if mission.journal.is_file()]
