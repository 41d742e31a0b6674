"""Bundles in archives: tar, tar.gz and zip, read member by member into memory; nothing is unpacked to disk.

An archive is refused as a whole, and the member that is the reason is named: for a path out of the bundle, a
link or a device, a name twice, or more than a limit allows. Declared sizes are not trusted.
"""

from __future__ import annotations

import gzip
import io
import stat
import struct
import tarfile
import zipfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path, PurePosixPath
from typing import Any, Self

import msgspec

from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_registry.documents.source import MAX_FILE_BYTES
from aos_registry.reading import MAX_BUNDLE_BYTES, MAX_BUNDLE_FILES, is_document_name

__all__ = ["ARCHIVE_SUFFIXES", "is_archive_name", "read_archive"]

ARCHIVE_SUFFIXES = (".tar", ".tar.gz", ".tgz", ".zip")
MAX_ARCHIVE_BYTES = MAX_BUNDLE_BYTES
MAX_STREAM_BYTES = 4 * MAX_BUNDLE_BYTES
MAX_RATIO = 100
_RATIO_COUNTS_FROM_BYTES = 256 * 1024
_MAX_NAME = 255
_MAX_TAR_RECORD_BYTES = 64 * 1024
_TAR_RECORDS = (tarfile.XHDTYPE, tarfile.XGLTYPE, tarfile.SOLARIS_XHDTYPE, tarfile.GNUTYPE_LONGNAME,
                tarfile.GNUTYPE_LONGLINK)  # fmt: skip
_DAMAGE = (
    tarfile.TarError, zipfile.BadZipFile, zlib.error, struct.error, gzip.BadGzipFile, EOFError, OSError,
    ValueError, OverflowError, IndexError, RuntimeError, NotImplementedError, MemoryError, AttributeError,
    TypeError, KeyError,
)  # fmt: skip
"""What the standard library raises for damaged archives; RecursionError is a RuntimeError."""


class _Refusal(Exception):
    """Why an archive is refused, and the member that is the reason."""

    def __init__(self, message: str, member: str = "", hint: str = "") -> None:
        super().__init__(message)
        self.message, self.member, self.hint = message, member, hint


class _Member(msgspec.Struct, frozen=True):
    """An entry: its name as it stands there, its declared size, and how to read at most so many bytes."""

    name: str
    is_folder: bool
    oddity: str
    size: int
    packed_size: int
    read: Callable[[int], bytes]


def is_archive_name(name: str) -> bool:
    """Whether a file of this name is read as an archive; hidden files are not."""
    return not name.startswith(".") and name.lower().endswith(ARCHIVE_SUFFIXES)


def read_archive(path: Path) -> tuple[dict[str, bytes], list[Diagnostic]]:
    """The files of an archive, and a remark for each thing in it that is left out.

    One folder around everything is taken off. Nothing raises; if an error is among the diagnostics, there
    are no files.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_ARCHIVE_BYTES + 1)
    except OSError as error:
        reason = error.strerror or "cannot be read"
        return {}, [Diagnostic(Severity.ERROR, "AOS101", reason, Span(str(path)))]
    try:
        if len(data) > MAX_ARCHIVE_BYTES:
            raise _Refusal(f"the archive has more than {MAX_ARCHIVE_BYTES} bytes")
        return _documents(data, path.name)
    except _Refusal as refusal:
        place, message, hint = refusal.member or path.name, refusal.message, refusal.hint
    except _DAMAGE as error:
        place, message, hint = path.name, f"this archive is damaged: {error}", "Pack it again"
    return {}, [Diagnostic(Severity.ERROR, "AOS120", message, Span(_printable(place)), hint)]


def _documents(data: bytes, archive: str) -> tuple[dict[str, bytes], list[Diagnostic]]:
    """The documents among the members; all members are checked before the first is read."""
    opened = _zip_members(data) if archive.lower().endswith(".zip") else _tar_members(data, archive)
    members = []
    for member in opened:
        _check(member)
        members.append((PurePosixPath(member.name), member))
        if len(members) > MAX_BUNDLE_FILES:
            raise _Refusal(f"the archive has more than {MAX_BUNDLE_FILES} members", member.name)
    members = [(name, member) for name, member in members if not _is_hidden(name)]
    root = _common_folder([(name, member.is_folder) for name, member in members])
    files: dict[str, bytes] = {}
    remarks: list[Diagnostic] = []
    seen: dict[str, str] = {}
    for name, member in members:
        inner = name.relative_to(root)
        if member.is_folder or len(inner.parts) != 1 or not is_document_name(inner.name):
            if not (member.is_folder and name == root) and inner.parts:
                remarks.append(_left_out(str(inner), member.is_folder or len(inner.parts) != 1))
            continue
        if (other := seen.setdefault(inner.name.casefold(), member.name)) is not member.name:
            raise _Refusal(f"the name is there already, as {_printable(other)}", member.name)
        files[inner.name] = _content(member, sum(map(len, files.values())))
    return files, remarks


def _check(member: _Member) -> None:
    """Refuses what has no place in a bundle, whether it would be read or not."""
    name = member.name
    if not name or len(name) > _MAX_NAME:
        raise _Refusal(f"a name must have 1 to {_MAX_NAME} characters", name)
    if not name.isprintable() or "\\" in name or ":" in name:
        raise _Refusal("this name has characters that no document has", name)
    if name.startswith("/") or ".." in name.split("/"):
        raise _Refusal("this path leads out of the bundle", name, "Pack the bundle's folder itself")
    if member.oddity:
        raise _Refusal(f"{member.oddity} in a bundle", name, "Bundles hold plain files only")


def _content(member: _Member, so_far: int) -> bytes:
    """The bytes of a document within all limits."""
    limit = min(MAX_FILE_BYTES, MAX_BUNDLE_BYTES - so_far)
    data = member.read(limit + 1) if member.size <= limit else None
    if data is None or len(data) > limit:
        limits = f"a file may have {MAX_FILE_BYTES} bytes, a bundle {MAX_BUNDLE_BYTES}"
        raise _Refusal("this file is too large", member.name, f"The limits: {limits}")
    _check_ratio(len(data), member.packed_size, member.name)
    return data


def _check_ratio(size: int, packed_size: int, name: str) -> None:
    if size > _RATIO_COUNTS_FROM_BYTES and size > MAX_RATIO * packed_size:
        message = f"{packed_size} bytes that unpack to {size} are no documents"
        raise _Refusal(message, name, f"The limit is {MAX_RATIO} times")


# --- tar -----------------------------------------------------------------------------------------------


class _BoundedTarInfo(tarfile.TarInfo):
    """A header that cannot lead backwards or hold a long record: some releases of Python hang on these."""

    def _block(self, count: int) -> int:
        if count < 0:
            raise tarfile.ReadError("a negative size")
        return int(super()._block(count))  # type: ignore[misc]

    def _proc_member(self, archive: tarfile.TarFile) -> Self:
        if self.type in _TAR_RECORDS and not 0 <= self.size <= _MAX_TAR_RECORD_BYTES:
            raise tarfile.ReadError(f"a header of {self.size} bytes")
        if self.type == tarfile.GNUTYPE_SPARSE:
            raise _Refusal("a sparse file in a bundle", self.name, "Bundles hold plain files only")
        found: Any = super()._proc_member(archive)  # type: ignore[misc]
        return found  # type: ignore[no-any-return]


def _tar_members(data: bytes, archive: str) -> Iterator[_Member]:
    packed_size = len(data)
    if data[:2] == b"\x1f\x8b":
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as stream:
            data = stream.read(MAX_STREAM_BYTES + 1)
        if len(data) > MAX_STREAM_BYTES:
            raise _Refusal(f"the archive unpacks to more than {MAX_STREAM_BYTES} bytes")
        _check_ratio(len(data), packed_size, archive)
    with tarfile.open(fileobj=io.BytesIO(data), mode="r:", tarinfo=_BoundedTarInfo) as tar:
        while (info := tar.next()) is not None:
            # Keeping the members, as `tar` does, is what `members` is for: it would recall hostile ones.
            yield _Member(
                info.name.removeprefix("./") or ".",
                info.isdir(),
                _tar_oddity(info),
                info.size,
                info.size,
                _tar_reader(data, info),
            )


def _tar_reader(data: bytes, info: tarfile.TarInfo) -> Callable[[int], bytes]:
    start, end = info.offset_data, info.offset_data + max(info.size, 0)

    def read(limit: int) -> bytes:
        if end > len(data):
            raise _Refusal("the archive ends within this file", info.name, "Pack it again")
        return data[start : min(end, start + limit)]

    return read


def _tar_oddity(info: tarfile.TarInfo) -> str:
    if info.issym() or info.islnk():
        return "a link"
    if info.issparse():
        return "a sparse file"
    return "" if info.isreg() or info.isdir() else "a device or something else that is no file"


# --- zip -----------------------------------------------------------------------------------------------


def _zip_members(data: bytes) -> Iterator[_Member]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        for info in archive.infolist():
            name = info.orig_filename
            yield _Member(
                name.removeprefix("./") or ".",
                info.is_dir(),
                _zip_oddity(info),
                info.file_size,
                info.compress_size,
                _zip_reader(archive, info),
            )


def _zip_reader(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> Callable[[int], bytes]:
    def read(limit: int) -> bytes:
        try:
            with archive.open(info) as file:
                return file.read(limit)
        except _DAMAGE as error:
            raise _Refusal(f"this file is damaged: {error}", info.filename, "Pack it again") from error

    return read


def _zip_oddity(info: zipfile.ZipInfo) -> str:
    mode = stat.S_IFMT(info.external_attr >> 16)
    if mode == stat.S_IFLNK:
        return "a link"
    if mode not in (0, stat.S_IFREG, stat.S_IFDIR):
        return "a device or something else that is no file"
    if info.flag_bits & 1:
        return "an encrypted file"
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        return "a file in an unusual compression"
    return ""


# --- names ---------------------------------------------------------------------------------------------


def _is_hidden(name: PurePosixPath) -> bool:
    return any(part.startswith(".") or part == "__MACOSX" for part in name.parts)


def _common_folder(members: list[tuple[PurePosixPath, bool]]) -> PurePosixPath:
    """The one folder that everything lies in; the archive itself where there is none."""
    tops = {name.parts[0] for name, _ in members if name.parts}
    has_file_on_top = any(len(name.parts) == 1 and not is_folder for name, is_folder in members)
    return PurePosixPath(tops.pop()) if len(tops) == 1 and not has_file_on_top else PurePosixPath()


def _left_out(name: str, is_inner: bool) -> Diagnostic:
    if is_inner:
        return Diagnostic(Severity.REMARK, "AOS107", "a folder inside a bundle", Span(name), "It is left out")
    hint = "It is left out; documents end in .ef, .sd, .am or .json"
    return Diagnostic(Severity.REMARK, "AOS107", "this is not an AOS document", Span(name), hint)


def _printable(name: str) -> str:
    """A name that can stand in a message, whatever it holds."""
    short = name if len(name) <= _MAX_NAME else f"{name[:60]}..."
    return short if short.isprintable() else ascii(short)[1:-1]
