"""An append-only journal: what was appended is on the disk, whatever is killed afterwards.

SQLite in WAL mode with synchronous=FULL: an append returns when the row is on the disk (half a millisecond
on a good disk, five on a poor one), so append before telling anybody. Payloads are JSON, so that any SQLite
tool reads a journal. One process writes, any number read.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from aos_protocol.errors import StorageError
from aos_protocol.messages import Message
from aos_runtime.clock import Clock, SystemClock

if TYPE_CHECKING:
    from typing import Self  # not in Python 3.10

__all__ = ["Journal", "JournalRow"]

_SCHEMA_VERSION = 1

_SCHEMA = f"""
CREATE TABLE IF NOT EXISTS entries (
    seq INTEGER PRIMARY KEY AUTOINCREMENT,
    stamp_ns INTEGER NOT NULL,
    kind TEXT NOT NULL,
    payload TEXT NOT NULL
) STRICT;
CREATE TRIGGER IF NOT EXISTS entries_stay BEFORE UPDATE ON entries
    BEGIN SELECT RAISE(ABORT, 'the journal is append-only'); END;
CREATE TRIGGER IF NOT EXISTS entries_remain BEFORE DELETE ON entries
    BEGIN SELECT RAISE(ABORT, 'the journal is append-only'); END;
PRAGMA user_version = {_SCHEMA_VERSION};
"""


_PAGES_IN_A_CHECKPOINT = 100
"""A checkpoint comes after this many pages: where none waits for the disk, many small ones are better than a
long one."""


class JournalRow(NamedTuple):
    """One entry: `seq` counts from 1 without gaps, `payload` is JSON."""

    seq: int
    stamp_ns: int
    kind: str
    payload: bytes


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
        try:
            connection = sqlite3.connect(path, isolation_level=None)
        except sqlite3.Error as error:
            raise _fault("AOS701", path, error) from error
        try:
            _check_version(connection, path, may_be_new=True)
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute(f"PRAGMA synchronous = {'FULL' if survives_power_loss else 'OFF'}")
            if not survives_power_loss:
                connection.execute(f"PRAGMA wal_autocheckpoint = {_PAGES_IN_A_CHECKPOINT}")
            connection.executescript(_SCHEMA)
        except sqlite3.Error as error:
            connection.close()
            raise _fault("AOS701", path, error) from error
        except StorageError:
            connection.close()
            raise
        return cls(connection, path, clock or SystemClock())

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Opens for reading only, beside a writer or after it. StorageError AOS702 if it cannot be."""
        path = Path(path)
        if not path.is_file():
            raise StorageError(f"there is no journal at {path}", code="AOS702")
        connection = sqlite3.connect(path, isolation_level=None)
        try:
            connection.execute("PRAGMA query_only = ON")
            _check_version(connection, path, may_be_new=False)
        except sqlite3.Error as error:
            connection.close()
            raise _fault("AOS702", path, error) from error
        except StorageError:
            connection.close()
            raise
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
        text = msgspec.json.encode(payload).decode()
        try:
            cursor = self._connection.execute(
                "INSERT INTO entries (stamp_ns, kind, payload) VALUES (?, ?, ?)",
                (self._clock.now_ns(), kind, text),
            )
        except sqlite3.Error as error:
            raise _fault("AOS701", self._path, error) from error
        assert cursor.lastrowid is not None
        return cursor.lastrowid

    @property
    def last(self) -> int:
        """The number of the last row, 0 in an empty journal."""
        try:
            (last,) = self._connection.execute("SELECT coalesce(max(seq), 0) FROM entries").fetchone()
        except sqlite3.Error as error:
            raise _fault("AOS702", self._path, error) from error
        return int(last)

    def rows(self, kind: str | None = None, since: int = 0) -> list[JournalRow]:
        """The rows numbered `since` and above, of one kind or of all."""
        return list(self.walk(kind, since))

    def walk(self, kind: str | None = None, since: int = 0) -> Iterator[JournalRow]:
        """Yields the same rows one after the other, so that a long journal need not fit into memory."""
        try:
            for seq, stamp_ns, of_kind, text in self._connection.execute(
                "SELECT seq, stamp_ns, kind, payload FROM entries"
                " WHERE seq >= :since AND (:kind IS NULL OR kind = :kind) ORDER BY seq",
                {"since": since, "kind": kind},
            ):
                yield JournalRow(seq, stamp_ns, of_kind, text.encode())
        except sqlite3.Error as error:
            raise _fault("AOS702", self._path, error) from error


def _check_version(connection: sqlite3.Connection, path: Path, *, may_be_new: bool) -> None:
    version = connection.execute("PRAGMA user_version").fetchone()[0]
    is_new = version == 0 and not connection.execute("SELECT 1 FROM sqlite_schema").fetchone()
    if version != _SCHEMA_VERSION and not (is_new and may_be_new):
        raise StorageError(
            f"{path} is not a journal of this version",
            code="AOS702",
            hint=f"Its schema is {version}, this program reads {_SCHEMA_VERSION}",
        )


def _fault(code: str, path: Path, error: sqlite3.Error) -> StorageError:
    return StorageError(f"the journal {path}: {error}", code=code)
