"""Spans of a run on their way: read from its journals, each sent until the collector has taken it.

The journals are the store. A place in them moves on once a collector has taken the spans before it, so that
nothing is lost while it is away, and nothing is kept in memory.
"""

from collections.abc import Iterator
from pathlib import Path

import msgspec

from aos_deploy.export.kept_missions import KeptMission, kept_missions
from aos_deploy.spans.otlp import Collector
from aos_deploy.spans.spans import Span, span_of_mission, spans_of_record
from aos_protocol.codec import UNREADABLE
from aos_protocol.messages import DecisionRecord, MissionState
from aos_protocol.mission_rows import DECISION, STATE
from aos_runtime.disk.journal import Journal, JournalRow
from aos_runtime.whole_file import write_whole

_BATCH = 500
_PLACES = "spans.json"


class Sender:
    """Sends the spans of a run. With `keeps_place` the run directory knows how far that has come."""

    def __init__(self, run: Path, collector: Collector, *, keeps_place: bool) -> None:
        self._run = run
        self._collector = collector
        self._file = run / _PLACES if keeps_place else None
        self._next_rows: dict[str, int] = {}
        if self._file is not None and self._file.is_file():
            try:
                self._next_rows = msgspec.json.decode(self._file.read_bytes(), type=dict[str, int])
            except UNREADABLE:
                self._next_rows = {}  # It was cut off: all are sent again, with the ids that they had.

    def send(self) -> tuple[int, bool]:
        """Sends what is new: the number of spans, and whether the collector has taken all.

        StorageError AOS702 at a row that is damaged, OSError where the place cannot be kept.
        """
        number = 0
        for mission in kept_missions(self._run):
            while (batch := self._batch(mission)) is not None:
                spans, next_row = batch
                if spans and not self._collector.send(spans):
                    return number, False
                number += len(spans)
                self._reach(mission.name, next_row)
        return number, True

    def _batch(self, mission: KeptMission) -> tuple[list[Span], int] | None:
        """Spans that are new, and the row after them; None where the journal has nothing more.

        The journal is closed while they are sent: who writes it would else wait with its checkpoints.
        """
        since = next_row = self._next_rows.get(mission.name, 0)
        spans: list[Span] = []
        with Journal.read(mission.journal) as journal:
            first = next(journal.walk(), None)
            for row in journal.walk(None, since):
                spans += _spans_of_row(row, first.stamp_ns if first is not None else row.stamp_ns)
                next_row = row.seq + 1
                if len(spans) >= _BATCH:
                    break
        return (spans, next_row) if next_row > since else None

    def _reach(self, mission: str, next_row: int) -> None:
        self._next_rows[mission] = next_row
        if self._file is not None:
            write_whole(self._file, msgspec.json.encode(self._next_rows))


def _spans_of_row(row: JournalRow, begun_ns: int) -> Iterator[Span]:
    if row.kind == DECISION:
        yield from spans_of_record(row.read_as(DecisionRecord))
    elif row.kind == STATE:
        state = row.read_as(MissionState)
        if state.phase == "ended":
            yield span_of_mission(state, begun_ns, row.stamp_ns)
