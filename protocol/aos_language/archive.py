"""Bundles in archives: tar, also compressed, and zip, read within limits and without touching the disk."""

import lzma
import struct
import tarfile
import zipfile
import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path, PurePosixPath
from stat import S_ISDIR, S_ISREG
from typing import IO, Self

import msgspec

from aos_language.reading.files import MAX_BUNDLE_BYTES, MAX_BUNDLE_FILES, is_document_name, left_out
from aos_protocol.diagnostics import Diagnostic, Severity, Span

ARCHIVE_SUFFIXES = (".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tar.xz", ".zip")
MAX_UNPACKED_BYTES = 4 * MAX_BUNDLE_BYTES
"""The limit counts all entries together, those that are left out as well: compressed ones are unpacked to
get past them."""
MAX_RATIO = 200
_RATIO_COUNTS_FROM_BYTES = 512 * 1024
_MAX_NAME = 255
_MAX_TAR_RECORD_BYTES = 64 * 1024
_TAR_RECORDS = (
    tarfile.XHDTYPE,
    tarfile.XGLTYPE,
    tarfile.SOLARIS_XHDTYPE,
    tarfile.GNUTYPE_LONGNAME,
    tarfile.GNUTYPE_LONGLINK,
)

UNREADABLE_ARCHIVE = (
    OSError,
    EOFError,
    LookupError,
    ArithmeticError,
    AttributeError,
    MemoryError,
    NotImplementedError,
    RuntimeError,  # An encrypted zip file; also RecursionError.
    TypeError,
    ValueError,
    lzma.LZMAError,
    tarfile.TarError,
    zipfile.BadZipFile,
    struct.error,
    zlib.error,
)
"""The readers of archives raise these errors at broken archives."""


class _Entry(msgspec.Struct, frozen=True):
    """One thing in an archive, before it is read. `kind` is `file`, `folder`, or what is refused."""

    name: str
    kind: str
    size_bytes: int


class _RefusedError(Exception):
    """The archive cannot be taken."""

    def __init__(self, why: str, hint: str = "") -> None:
        super().__init__(why)
        self.hint = hint


def is_archive_name(name: str) -> bool:
    """Returns whether a file of this name is taken for an archive; hidden files are not."""
    return not name.startswith(".") and name.lower().endswith(ARCHIVE_SUFFIXES)


def read_archive(path: Path) -> tuple[dict[str, bytes], list[Diagnostic]]:
    """The documents in an archive by plain file name, and remarks on what is left out.

    They lie side by side, at the top or in one folder. With an error in the diagnostics there are no files:
    links, devices, ways out of the archive, and more files or bytes than a bundle may have.
    """
    files: dict[PurePosixPath, bytes] = {}
    remarks: list[Diagnostic] = []
    unpacked = 0
    try:
        if path.stat().st_size > MAX_BUNDLE_BYTES:
            raise _RefusedError(f"the archive has more than {MAX_BUNDLE_BYTES} bytes")
        entries = _in_zip(path) if path.suffix.lower() == ".zip" else _in_tar(path)
        for number, (entry, content) in enumerate(entries, 1):
            _check(entry, number)
            unpacked += entry.size_bytes
            if unpacked > MAX_UNPACKED_BYTES:
                message = f"the archive unpacks to more than {MAX_UNPACKED_BYTES} bytes at {entry.name!r}"
                raise _RefusedError(message)
            name = PurePosixPath(entry.name)
            if entry.kind == "folder" or any(part.startswith(".") for part in name.parts):
                continue
            if not is_document_name(name.name):
                remarks.append(left_out(entry.name))
                continue
            data = content.read(MAX_BUNDLE_BYTES + 1)
            if sum(map(len, files.values())) + len(data) > MAX_BUNDLE_BYTES:
                raise _RefusedError(f"more than {MAX_BUNDLE_BYTES} bytes of documents")
            if name in files:
                raise _RefusedError(f"the entry {entry.name!r} is there twice")
            files[name] = data
        _check_ratio(unpacked, path)
        return _in_one_folder(files), remarks
    except _RefusedError as refused:
        return {}, [Diagnostic(Severity.ERROR, "AOS120", str(refused), Span(path.name), refused.hint)]
    except UNREADABLE_ARCHIVE as error:
        reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
        message = f"the archive cannot be read: {reason}"
        hint = f"A bundle is a directory, or an archive in {', '.join(ARCHIVE_SUFFIXES)}"
        return {}, [Diagnostic(Severity.ERROR, "AOS101", message, Span(path.name), hint)]


def _in_tar(path: Path) -> Iterator[tuple[_Entry, IO[bytes]]]:
    """Reads the archive as a stream, so that nothing is unpacked before it was looked at."""
    with tarfile.open(path, "r|*", tarinfo=_BoundedTarInfo) as archive:
        for member in archive:
            kind = (
                "file"
                if member.isreg() and not member.issparse()
                else "folder"
                if member.isdir()
                else _tar_kind(member)
            )
            content = archive.extractfile(member) if kind == "file" else None
            yield _Entry(member.name, kind, member.size), content or BytesIO()


class _BoundedTarInfo(tarfile.TarInfo):
    """A header that is there whole, and neither leads backwards nor has a long text: some releases of Python
    hang on these. Python takes an archive that was cut before a header for a whole one."""

    @property
    def size(self) -> int:
        return self._size

    @size.setter
    def size(self, size_bytes: int) -> None:
        # Every size comes by here: that of the header itself, and those that records before it give.
        if size_bytes < 0:
            raise tarfile.ReadError("a negative size")
        self._size = size_bytes

    @classmethod
    def frombuf(cls, buf: bytes | bytearray, encoding: str, errors: str) -> Self:
        if len(buf) < tarfile.BLOCKSIZE:
            raise tarfile.ReadError("unexpected end of data")
        header = super().frombuf(buf, encoding, errors)
        if header.type in _TAR_RECORDS and header.size > _MAX_TAR_RECORD_BYTES:
            raise tarfile.ReadError(f"a header of {header.size} bytes")
        return header


def _tar_kind(member: tarfile.TarInfo) -> str:
    if member.issparse():
        return "sparse file"
    return "link" if member.issym() or member.islnk() else "device"


def _in_zip(path: Path) -> Iterator[tuple[_Entry, IO[bytes]]]:
    with zipfile.ZipFile(path) as archive:
        for member in archive.infolist():
            mode = member.external_attr >> 16
            is_plain = mode == 0 or S_ISREG(mode) or S_ISDIR(mode) or mode < 0o10000
            kind = ("folder" if member.is_dir() else "file") if is_plain else "link"
            entry = _Entry(member.filename, kind, member.file_size)
            if kind == "file":
                with archive.open(member) as content:
                    yield entry, content
            else:
                yield entry, BytesIO()


def _check(entry: _Entry, number: int) -> None:
    name = PurePosixPath(entry.name)
    if name.is_absolute() or ".." in name.parts or "\\" in entry.name or "\0" in entry.name:
        raise _RefusedError(f"the entry {entry.name!r} leads out of the archive")
    if not 0 < len(entry.name) <= _MAX_NAME or not entry.name.isprintable():
        message = f"the entry {entry.name[:_MAX_NAME]!r} has a name that no document has"
        raise _RefusedError(message)
    if entry.kind not in ("file", "folder"):
        message = f"the entry {entry.name!r} is a {entry.kind}"
        raise _RefusedError(message, "Pack plain files")
    if number > MAX_BUNDLE_FILES:
        raise _RefusedError(f"more than {MAX_BUNDLE_FILES} entries")
    if not 0 <= entry.size_bytes <= MAX_BUNDLE_BYTES:
        raise _RefusedError(f"the entry {entry.name!r} has {entry.size_bytes} bytes")


def _check_ratio(unpacked: int, path: Path) -> None:
    packed = path.stat().st_size
    if unpacked > max(_RATIO_COUNTS_FROM_BYTES, MAX_RATIO * packed):
        message = f"{packed} bytes that unpack to {unpacked} hold no documents"
        raise _RefusedError(message, f"The limit is {MAX_RATIO} times")


def _in_one_folder(files: dict[PurePosixPath, bytes]) -> dict[str, bytes]:
    folders = sorted({str(name.parent) for name in files})
    if len(folders) > 1:
        message = f"documents in several folders: {', '.join(folders)}"
        raise _RefusedError(message, "Pack one bundle, its files side by side")
    by_folded: dict[str, str] = {}
    for name in files:
        other = by_folded.setdefault(name.name.casefold(), name.name)
        if other != name.name:
            message = f"the entries {other!r} and {name.name!r} differ in capitals only"
            raise _RefusedError(message)
    return {name.name: data for name, data in files.items()}
