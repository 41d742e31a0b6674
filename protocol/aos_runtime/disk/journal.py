"""An append-only journal: what was appended is on the disk, whatever is killed afterwards.

SQLite in WAL mode with synchronous=FULL: an append returns when the row is on the disk (half a millisecond
on a good disk, five on a poor one), so append before telling anybody. Payloads are JSON, so that any SQLite
tool reads a journal. One process writes, any number read.

Each row has a checksum, and the numbers have no gap, so that a journal that was damaged is refused.
"""

from __future__ import annotations

import sqlite3
import zlib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import msgspec

from aos_protocol.codec import UNREADABLE
from aos_protocol.errors import StorageError
from aos_protocol.messages import Message
from aos_runtime import failpoints
from aos_runtime.clock import Clock, SystemClock

if TYPE_CHECKING:
    from typing import Self  # not in Python 3.10

T = TypeVar("T")

_SCHEMA_VERSION = 2

_SCHEMA = f"""
CREATE TABLE IF NOT EXISTS entries (
    seq INTEGER PRIMARY KEY AUTOINCREMENT,
    stamp_ns INTEGER NOT NULL,
    kind TEXT NOT NULL,
    payload TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
CREATE TRIGGER IF NOT EXISTS entries_stay BEFORE UPDATE ON entries
    BEGIN SELECT RAISE(ABORT, 'the journal is append-only'); END;
CREATE TRIGGER IF NOT EXISTS entries_remain BEFORE DELETE ON entries
    BEGIN SELECT RAISE(ABORT, 'the journal is append-only'); END;
PRAGMA user_version = {_SCHEMA_VERSION};
"""


_REFUSALS = (sqlite3.Error, UnicodeDecodeError)
"""The second one comes where SQLite's message quotes a schema that was damaged."""

_PAGES_IN_A_CHECKPOINT = 100
"""A checkpoint comes after this many pages: where none waits for the disk, many small ones are better than a
long one."""


class JournalError(StorageError):
    """A fault of a journal: `what` is wrong with it, which the message tells after the name of the file."""

    def __init__(self, path: Path, what: str, code: str = "AOS702") -> None:
        super().__init__(f"the journal {path}: {what}", code=code)
        self.what = what


class JournalRow(NamedTuple):
    """One entry: `seq` counts from 1 without gaps, `payload` is JSON, `journal` is the file that has it."""

    seq: int
    stamp_ns: int
    kind: str
    payload: bytes
    journal: Path = Path()

    def read_as(self, kind: type[T]) -> T:
        """The payload as this type; StorageError AOS702 where it is something else."""
        try:
            return msgspec.json.decode(self.payload, type=kind)
        except UNREADABLE as error:
            what = f"row {self.seq}, {self.kind}, cannot be read: {error}"
            raise JournalError(self.journal, what) from error


class Journal:
    """Rows in the order in which they were appended."""

    def __init__(self, connection: sqlite3.Connection, path: Path, clock: Clock) -> None:
        self._connection = connection
        self._path = path
        self._clock = clock

    @classmethod
    def open(cls, path: str | Path, *, clock: Clock | None = None, survives_power_loss: bool = True) -> Self:
        """Opens for appending, creating what is not there. StorageError AOS701 or AOS702 with the reason.

        Without `survives_power_loss` rows survive the end of any process, and an append takes a twentieth of
        a millisecond. It never waits for the disk; nor does the checkpoint that comes every hundred appends.
        """
        path = Path(path)
        with _prepared(path, "AOS701") as connection:
            _check_version(connection, path, is_to_write=True)
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute(f"PRAGMA synchronous = {'FULL' if survives_power_loss else 'OFF'}")
            if not survives_power_loss:
                connection.execute(f"PRAGMA wal_autocheckpoint = {_PAGES_IN_A_CHECKPOINT}")
            connection.executescript(_SCHEMA)
        return cls(connection, path, clock or SystemClock())

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Opens for reading only, beside a writer or after it. StorageError AOS702 if it cannot be."""
        path = Path(path)
        if not path.is_file():
            raise StorageError(f"there is no journal at {path}", code="AOS702")
        with _prepared(path, "AOS702") as connection:
            connection.execute("PRAGMA query_only = ON")
            _check_version(connection, path, is_to_write=False)
        return cls(connection, path, SystemClock())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closing twice does nothing."""
        self._connection.close()

    def append(self, kind: str, payload: Message) -> int:
        """The row's number, once the row is on the disk. StorageError AOS701 if it could not be written."""
        text, stamp_ns = msgspec.json.encode(payload).decode(), self._clock.now_ns()
        place = f"{self._path.stem.partition('-')[0]}.{kind}" if failpoints.is_armed else ""
        try:
            failpoints.reach(f"{place}.before")
            cursor = self._connection.execute(
                "INSERT INTO entries (stamp_ns, kind, payload, checksum) VALUES (?, ?, ?, ?)",
                (stamp_ns, kind, text, _checksum(stamp_ns, kind, text)),
            )
        except (*_REFUSALS, OSError) as error:
            raise _fault("AOS701", self._path, error) from error
        assert cursor.lastrowid is not None
        failpoints.reach(f"{place}.after")
        return cursor.lastrowid

    @property
    def last(self) -> int:
        """The number of the last row, 0 in an empty journal."""
        try:
            (last,) = self._connection.execute("SELECT coalesce(max(seq), 0) FROM entries").fetchone()
        except _REFUSALS as error:
            raise _fault("AOS702", self._path, error) from error
        return int(last)

    def rows(self, kind: str | None = None, since: int = 0) -> list[JournalRow]:
        """The rows numbered `since` and above, of one kind or of all."""
        return list(self.walk(kind, since))

    def walk(self, kind: str | None = None, since: int = 0) -> Iterator[JournalRow]:
        """Yields the same rows one after the other, so that a long journal need not fit into memory.

        StorageError AOS702 at a row that is damaged, and where rows of no one kind are lacking.
        """
        number = since - 1 if since > 0 else 0
        try:
            last = self._last_written() if kind is None else 0
            for seq, stamp_ns, of_kind, text, check in self._connection.execute(
                "SELECT seq, stamp_ns, kind, payload, checksum FROM entries"
                " WHERE seq >= :since AND (:kind IS NULL OR kind = :kind) ORDER BY seq",
                {"since": since, "kind": kind},
            ):
                if check != _checksum(stamp_ns, of_kind, text):
                    raise self._damaged(f"row {seq} is damaged")
                if not isinstance(text, str):
                    raise self._damaged(f"row {seq} has no text")
                if kind is None and seq != number + 1:
                    raise self._damaged(f"row {seq} follows row {number}")
                number = seq
                yield JournalRow(seq, stamp_ns, of_kind, text.encode(), self._path)
        except _REFUSALS as error:
            raise _fault("AOS702", self._path, error) from error
        if number < last:
            raise self._damaged(f"the rows after {number} are lacking")

    def _last_written(self) -> int:
        """The number of the last row as SQLite keeps it apart from the rows."""
        found = self._connection.execute("SELECT seq FROM sqlite_sequence WHERE name = 'entries'").fetchone()
        return int(found[0]) if found is not None else 0

    def _damaged(self, what: str) -> StorageError:
        return JournalError(self._path, what)


def rows_of(path: Path) -> Iterator[JournalRow]:
    """Yields all rows of the journal in a file; StorageError AOS702 as from `Journal.read` and `walk`."""
    with Journal.read(path) as journal:
        yield from journal.walk()


def _checksum(stamp_ns: int, kind: str, payload: str) -> int:
    return zlib.crc32(f"{stamp_ns} {kind} {payload}".encode())


def _check_version(connection: sqlite3.Connection, path: Path, *, is_to_write: bool) -> None:
    """Raises StorageError AOS702 for a schema that this program does not know."""
    require_plain_tables(connection)
    version = int(connection.execute("PRAGMA user_version").fetchone()[0])
    is_empty = version == 0 and not connection.execute("SELECT 1 FROM sqlite_schema").fetchone()
    if version != _SCHEMA_VERSION and not (is_to_write and is_empty):
        hint = f"Its schema is {version}, this program reads {_SCHEMA_VERSION}"
        raise StorageError(f"{path} is not a journal of this version", code="AOS702", hint=hint)


@contextmanager
def _prepared(path: Path, code: str) -> Iterator[sqlite3.Connection]:
    """A new connection, closed again where the block raises; what SQLite refuses is a StorageError."""
    with ExitStack() as unless_whole:
        try:
            connection = sqlite3.connect(path, isolation_level=None)
            unless_whole.callback(connection.close)
            yield connection
        except _REFUSALS as error:
            raise _fault(code, path, error) from error
        unless_whole.pop_all()


def _fault(code: str, path: Path, error: Exception) -> StorageError:
    return JournalError(path, str(error), code)


def require_plain_tables(connection: sqlite3.Connection) -> None:
    """Raises sqlite3.DatabaseError where something that can be read is no plain table.

    A database may come from a stranger. A view or a computed column is a program: SQLite runs it for whoever
    reads, who waits for ever, out of reach of Ctrl-C, where it has no end.
    """
    found = connection.execute("SELECT name, type, sql FROM sqlite_schema WHERE type IN ('table', 'view')")
    for name, kind, sql in found.fetchall():
        is_table = kind == "table" and not str(sql).lstrip().upper().startswith("CREATE VIRTUAL")
        columns = connection.execute("SELECT hidden FROM pragma_table_xinfo(?)", (name,)) if is_table else ()
        if not is_table or any(hidden for (hidden,) in columns):
            raise sqlite3.DatabaseError(f"{name} is no plain table")
