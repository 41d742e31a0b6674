"""Whole runs as one file to send, a zip archive, and such a file opened again.

What commands read of a run is in it: journals, ledgers, catalogue, settings, logs, pictures. What lets
somebody into a system is not: sockets, credentials and what holds a password, hidden files.
"""

import hashlib
import shutil
import sqlite3
import stat
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path, PurePosixPath

from aos_deploy.places import cache_dir
from aos_language.archive import UNREADABLE_ARCHIVE
from aos_protocol.errors import DeployError
from aos_runtime.bus.credentials import FOLDER, read_password

SUFFIX = ".aosrun"
"""The end of the name of such a file."""

MAX_FILES = 100_000
MAX_UNPACKED_BYTES = 4 * 2**30
"""A bundle of more files, or of more bytes, is not opened."""

_DATABASE = ".db"
_PARTS_OF_DATABASES = ("-wal", "-shm", "-journal")


def write_bundle(runs: Sequence[Path], target: Path) -> int:
    """Writes the runs into a file, each in a folder of its name, and returns the number of their files.

    A database is copied as it is at one moment, also while it is written.
    """
    count = 0
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for run in runs:
            passwords = [read_password(file) for file in (run / FOLDER).glob("*") if file.is_file()]
            for path in _files(run):
                if _has_any(path, passwords):
                    continue
                name = f"{run.resolve().name}/{path.relative_to(run).as_posix()}"
                if path.suffix == _DATABASE:
                    archive.writestr(
                        zipfile.ZipInfo.from_file(path, name), _database(path), zipfile.ZIP_DEFLATED
                    )
                else:
                    archive.write(path, name)
                count += 1
    return count


def opened_bundle(path: Path) -> list[Path]:
    """The run directories in a bundle, the oldest first, unpacked into the cache directory once.

    DeployError AOS901 for a file that is no bundle, has ways out of it, or more than such a file may have.
    """
    if path.is_dir():
        hint = f"A folder of runs goes behind an option: --runs {path}"
        raise DeployError(f"{path} is a folder, and no file of runs", code="AOS901", hint=hint)
    try:
        digest = hashlib.blake2b(path.read_bytes(), digest_size=16).hexdigest()
        folder = cache_dir() / "opened" / digest
        if not folder.is_dir():
            _unpack(path, folder)
    except UNREADABLE_ARCHIVE as error:
        why = getattr(error, "strerror", None) or error
        raise _no_bundle(path, str(why)) from error
    runs = sorted(record.parent for record in folder.glob("*/run.json"))
    if not runs:
        raise _no_bundle(path, "no run is in it")
    return runs


def _unpack(path: Path, folder: Path) -> None:
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".opening-") as staging:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            if len(entries) > MAX_FILES or sum(entry.file_size for entry in entries) > MAX_UNPACKED_BYTES:
                raise _no_bundle(path, "it has too many files or bytes")
            for entry in entries:
                _unpack_entry(archive, entry, Path(staging), path)
        unpacked = Path(staging) / "runs"
        if unpacked.is_dir():
            unpacked.replace(folder)
        else:
            raise _no_bundle(path, "it is empty")


def _unpack_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, staging: Path, path: Path) -> None:
    parts = PurePosixPath(entry.filename).parts
    kind = stat.S_IFMT(entry.external_attr >> 16)
    is_plain = kind in (0, stat.S_IFREG, stat.S_IFDIR)
    if (
        not is_plain
        or not parts
        or entry.filename.startswith("/")
        or any(part in ("..", "") for part in parts)
        or not entry.filename.isprintable()
    ):
        raise _no_bundle(path, f"the entry {entry.filename!r} is not a plain file within it")
    if entry.is_dir():
        return
    target = staging / "runs" / Path(*parts)
    target.parent.mkdir(parents=True, exist_ok=True)
    written = 0
    with archive.open(entry) as source, target.open("wb") as file:
        while piece := source.read(2**20):
            written += len(piece)
            if written > entry.file_size:
                raise _no_bundle(path, f"the entry {entry.filename!r} is longer than it says")
            file.write(piece)


def _files(run: Path) -> Iterator[Path]:
    for path in sorted(run.rglob("*")):
        inner = path.relative_to(run).parts
        is_left_out = (
            path.is_symlink()
            or not path.is_file()
            or any(part.startswith(".") for part in inner)
            or path.name.endswith(_PARTS_OF_DATABASES)
            or inner[0] == FOLDER
        )
        if not is_left_out:
            yield path


def _has_any(path: Path, passwords: Sequence[str]) -> bool:
    """Says whether a file holds a password of the bus, as the router's configuration does."""
    content = path.read_bytes()
    return any(password.encode() in content for password in passwords if password)


def _database(path: Path) -> bytes:
    """Returns a database as one file, with what is still in its log."""
    with tempfile.TemporaryDirectory() as staging:
        copy = Path(staging) / path.name
        try:
            with (
                closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as source,
                closing(sqlite3.connect(copy)) as target,
            ):
                source.backup(target)
        except sqlite3.Error:
            # A damaged one is sent as it is: whoever gets it will want to see that.
            shutil.copy(path, copy)
        return copy.read_bytes()


def _no_bundle(path: Path, why: str) -> DeployError:
    hint = "`aos export RUN --format bundle` writes one"
    return DeployError(f"{path} is not a file of runs: {why}", code="AOS901", hint=hint)
