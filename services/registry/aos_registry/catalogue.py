"""The catalogue: every accepted revision of every project, in one SQLite file.

A revision is stored in one transaction, on the disk before `store` returns: after a crash at any moment the
catalogue holds the old revision or the new one. Equal files are stored once, by digest.
"""

import hashlib
import json
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Self

import msgspec

from aos_protocol.errors import StorageError
from aos_protocol.messages import CatalogueEntry, RevisionEntry
from aos_runtime.disk.journal import require_plain_tables

_SCHEMA_VERSION = 2
_BUSY_TIMEOUT_S = 5.0
_SCHEMA = """
CREATE TABLE content (digest TEXT PRIMARY KEY, data BLOB NOT NULL) STRICT;
CREATE TABLE revision (
    project TEXT NOT NULL,
    number INTEGER NOT NULL,
    digest TEXT NOT NULL,
    stored_ns INTEGER NOT NULL,
    skills TEXT NOT NULL,
    PRIMARY KEY (project, number)
) STRICT;
CREATE TABLE file (
    project TEXT NOT NULL,
    number INTEGER NOT NULL,
    name TEXT NOT NULL,
    content TEXT NOT NULL REFERENCES content (digest),
    version TEXT NOT NULL DEFAULT '',
    PRIMARY KEY (project, number, name)
) STRICT;
"""


class Revision(msgspec.Struct, frozen=True):
    """A stored revision with its files."""

    project: str
    number: int
    digest: str
    files: dict[str, bytes]


class Catalogue:
    """An open catalogue; has one writer."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._db = connection

    @classmethod
    def open(cls, path: Path) -> Self:
        """The catalogue at `path`, made if it is not there; StorageError if it cannot be used."""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            connection = sqlite3.connect(path, isolation_level=None, timeout=_BUSY_TIMEOUT_S)
            require_plain_tables(connection)
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")
            version = connection.execute("PRAGMA user_version").fetchone()[0]
            if version == 0:
                connection.executescript(f"BEGIN; {_SCHEMA} PRAGMA user_version = {_SCHEMA_VERSION}; COMMIT;")
        except (OSError, sqlite3.Error) as error:
            raise StorageError(f"the catalogue {path} cannot be opened: {error}", code="AOS702") from error
        if version not in (0, _SCHEMA_VERSION):
            connection.close()
            message = f"the catalogue {path} has schema {version}, this program knows {_SCHEMA_VERSION}"
            hint = "Use the AOS that wrote it, or move the file away"
            raise StorageError(message, code="AOS702", hint=hint)
        return cls(connection)

    def close(self) -> None:
        self._db.close()

    def store(
        self,
        project: str,
        digest: str,
        files: Mapping[str, bytes],
        skills: tuple[str, ...],
        stored_ns: int,
        versions: Mapping[str, str] | None = None,
    ) -> int:
        """Makes the files the project's next revision and returns its number, from 1.

        `versions` gives the declared version of each file that declares one. StorageError AOS701 if it cannot
        be written.
        """
        declared = versions or {}
        with self._transaction():
            number = self._newest_number(project) + 1
            self._db.execute(
                "INSERT INTO revision VALUES (?, ?, ?, ?, ?)",
                (project, number, digest, stored_ns, json.dumps(skills)),
            )
            for name, data in files.items():
                content = hashlib.sha256(data).hexdigest()
                self._db.execute("INSERT OR IGNORE INTO content VALUES (?, ?)", (content, data))
                row_of_file = (project, number, name, content, declared.get(name, ""))
                self._db.execute("INSERT INTO file VALUES (?, ?, ?, ?, ?)", row_of_file)
        return number

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        """All that the block writes, or nothing of it."""
        try:
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield
            except BaseException:
                self._db.execute("ROLLBACK")
                raise
            self._db.execute("COMMIT")
        except sqlite3.Error as error:
            raise StorageError(f"the catalogue cannot be written: {error}") from error

    def _newest_number(self, project: str) -> int:
        """The number of the newest revision; 0 if there is none."""
        row = self._db.execute("SELECT max(number) FROM revision WHERE project = ?", (project,)).fetchone()
        return int(row[0] or 0)

    def remove(self, project: str, stored_ns: int) -> int:
        """Gives a project up: its next revision, whose number is returned, has no files."""
        return self.store(project, "", {}, (), stored_ns)

    def current(self, project: str) -> Revision | None:
        """The newest revision of a project; None where there is none, or where it was removed."""
        return self.revision(project, self._newest_number(project))

    def revision(self, project: str, number: int) -> Revision | None:
        """A revision with its files; None where there is none, or where the project was removed by it."""
        row = self._db.execute(
            "SELECT number, digest FROM revision WHERE project = ? AND number = ?", (project, number)
        ).fetchone()
        if row is None or not row[1]:
            return None
        files = self._db.execute(
            "SELECT name, data FROM file JOIN content ON content = digest WHERE project = ? AND number = ?",
            (project, row[0]),
        )
        return Revision(project, row[0], row[1], dict(files.fetchall()))

    def has_held(self, name: str, data: bytes) -> bool:
        """Returns whether any revision has had a file of this name and content."""
        found = self._db.execute(
            "SELECT 1 FROM file WHERE name = ? AND content = ?", (name, hashlib.sha256(data).hexdigest())
        )
        return found.fetchone() is not None

    def history(self, project: str) -> tuple[RevisionEntry, ...]:
        """All revisions of a project, the oldest first."""
        entries = []
        before: dict[str, str] = {}
        for number, digest, stored_ns, skills in self._db.execute(
            "SELECT number, digest, stored_ns, skills FROM revision WHERE project = ? ORDER BY number",
            (project,),
        ).fetchall():
            rows = self._db.execute(
                "SELECT name, content, version FROM file WHERE project = ? AND number = ?", (project, number)
            ).fetchall()
            files: dict[str, str] = {name: content for name, content, _ in rows}
            entries.append(
                RevisionEntry(
                    number,
                    digest,
                    stored_ns,
                    tuple(json.loads(skills)),
                    added=tuple(sorted(files.keys() - before.keys())),
                    changed=tuple(
                        sorted(name for name in files if before.get(name, files[name]) != files[name])
                    ),
                    removed=tuple(sorted(before.keys() - files.keys())),
                    versions={name: version for name, _, version in sorted(rows) if version},
                )
            )
            before = files
        return tuple(entries)

    def entries(self) -> tuple[CatalogueEntry, ...]:
        """The newest revision of each project that was not removed, by name."""
        rows = self._db.execute(
            "SELECT project, max(number), digest, stored_ns, skills FROM revision "
            "GROUP BY project ORDER BY project"
        )
        return tuple(
            CatalogueEntry(project, number, digest, stored_ns, tuple(json.loads(skills)))
            for project, number, digest, stored_ns, skills in rows
            if digest
        )
