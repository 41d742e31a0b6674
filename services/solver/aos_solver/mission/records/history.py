"""The decision records of a mission, page by page out of its journal."""

import asyncio
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import msgspec

from aos_protocol.errors import StorageError
from aos_protocol.messages import DecisionRecord, History, HistoryQuery
from aos_protocol.mission_rows import DECISION
from aos_runtime.disk.journal import Journal, JournalRow

PAGE_BYTES = 2**20
"""A page ends with the record that exceeds it. As objects it takes some ten times the memory."""
PAGE_RECORDS = 1000


class _Numbered(msgspec.Struct, frozen=True):
    """The part of a record that its place depends on."""

    sequence: int


class HistoryReader:
    """The reader of journals for whoever asks: one question at a time, in a thread of its own.

    It keeps the journal open that was last asked for: to open one takes longer than to read a page. Several
    at a time would take the interpreter from everything else that the process answers.
    """

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="history")
        self._path = Path()
        self._journal: Journal | None = None

    async def page(self, journal: Path, mission: str, query: HistoryQuery) -> History:
        """Returns what `history_page` does."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._thread, self._page, journal, mission, query)

    def close(self) -> None:
        """Closes the journal, after the question that is being answered."""
        self._thread.submit(self._leave)
        self._thread.shutdown()

    def _page(self, path: Path, mission: str, query: HistoryQuery) -> History:
        if self._journal is None or self._path != path:
            self._leave()
            self._path, self._journal = path, Journal.read(path)
        try:
            return _page_of(self._journal, mission, query)
        except StorageError:
            self._leave()
            raise

    def _leave(self) -> None:
        if self._journal is not None:
            self._journal.close()
        self._journal = None


def history_page(journal: Path, mission: str, query: HistoryQuery) -> History:
    """The records that the query asks for, as many as fit a page; StorageError AOS702 for a damaged row.

    The memory it takes is that of a page, however long the journal is.
    """
    with Journal.read(journal) as rows:
        return _page_of(rows, mission, query)


def _page_of(journal: Journal, mission: str, query: HistoryQuery) -> History:
    limit = min(query.limit or PAGE_RECORDS, PAGE_RECORDS)
    records: list[DecisionRecord] = []
    size_bytes = 0
    for row in _rows_since(journal, query.since):
        if len(records) == limit or size_bytes >= PAGE_BYTES:
            return History(mission, tuple(records), has_more=True)
        records.append(row.read_as(DecisionRecord))
        size_bytes += len(row.payload)
    return History(mission, tuple(records))


def _rows_since(journal: Journal, sequence: int) -> Iterator[JournalRow]:
    """The rows of the records from a sequence number on, found by halving: the numbers rise with the rows."""
    low, high = 1, journal.last + 1
    while low < high:
        middle = (low + high) // 2
        row = next(journal.walk(DECISION, middle), None)
        if row is None or row.read_as(_Numbered).sequence >= sequence:
            high = middle
        else:
            low = row.seq + 1
    return journal.walk(DECISION, low)
