"""Bundles that come over HTTP: archives or single documents, and the projects that are kept of them."""

import hashlib
import re
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import msgspec

from aos_language.archive import is_archive_name, read_archive
from aos_language.reading.files import is_document_name
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.errors import DocumentError, StorageError

_LONGEST_NAME_BYTES = 200
_LONGEST_ROBOT = 64
_ENDINGS = "Documents end in .ef, .sd, .am, .lf or .json, archives in .zip, .tar or .tar.gz"


class ProjectEntry(msgspec.Struct, frozen=True):
    """A project that can be started, by the path of its deploy file."""

    project: str
    deploy_file: str
    is_uploaded: bool


def files_of_upload(name: str, body: bytes) -> tuple[dict[str, bytes], list[Diagnostic]]:
    """The documents in an upload, and a remark for each thing that is left out; DocumentError for another
    file."""
    plain = Path(name).name
    if not plain.isprintable() or len(plain.encode()) > _LONGEST_NAME_BYTES:
        raise DocumentError(f"{plain!r} is a name that no document has", code="AOS107", hint=_ENDINGS)
    if is_archive_name(plain):
        with tempfile.TemporaryDirectory(prefix="aos-upload-") as folder:
            path = Path(folder) / plain
            path.write_bytes(body)
            return read_archive(path)
    if is_document_name(plain):
        return {plain: body}, []
    raise DocumentError(f"{plain} is neither a document nor an archive", code="AOS107", hint=_ENDINGS)


def keep_project(folder: Path, project: str, files: Mapping[str, bytes]) -> ProjectEntry:
    """Writes a bundle with a deploy file that plays it by its documents, in place of an older one of that
    name."""
    name = re.sub(r"[^A-Za-z0-9_-]", "-", project)[:_LONGEST_ROBOT]
    if name != project:  # Another project may look the same so.
        digest = hashlib.blake2b(project.encode(), digest_size=4).hexdigest()
        name = f"{name[: _LONGEST_ROBOT - len(digest) - 1]}-{digest}"
    target = folder / "projects" / name
    deploy_file = target / f"{name}.yaml"
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent, prefix=".new-") as beside:
            new = Path(beside) / name
            (new / "bundle").mkdir(parents=True)
            for file, data in files.items():
                (new / "bundle" / file).write_bytes(data)
            (new / f"{name}.yaml").write_text(_deploy_text(name, project), encoding="utf-8")
            shutil.rmtree(target, ignore_errors=True)
            new.rename(target)
    except OSError as error:
        raise StorageError(f"{target} cannot be written: {error.strerror}") from error
    return ProjectEntry(name, str(deploy_file), is_uploaded=True)


def kept_projects(folder: Path) -> Iterator[ProjectEntry]:
    """The projects that were uploaded, by name."""
    for path in sorted((folder / "projects").glob("[!.]*/*.yaml")):
        yield ProjectEntry(path.stem, str(path), is_uploaded=True)


def _deploy_text(name: str, project: str) -> str:
    lines: Iterable[str] = (
        "# An uploaded bundle: every skill is played by its own document.",
        "aos: 1",
        f"robot: {name}",
        f"project: {msgspec.json.encode(project).decode()}",
        "bundles: [bundle]",
        "solver: {simulations: 20000}",
        'bind: {"*": model}',
    )
    return "\n".join(lines) + "\n"
