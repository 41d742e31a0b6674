"""Files to documents: which reader takes which file, and what a bundle may hold besides documents."""

from collections.abc import Mapping
from pathlib import PurePath

import msgspec

from aos_language.findings import Findings
from aos_language.reading.document import Document, DocumentKind
from aos_language.reading.json_document import read_json
from aos_language.reading.picture_file import PICTURE, check_picture
from aos_language.reading.sdl_document import read_sdl
from aos_language.reading.sdl_words import GRAMMARS
from aos_language.reading.source import open_source
from aos_protocol.diagnostics import Diagnostic, Severity, Span

MAX_BUNDLE_FILES = 1000
MAX_BUNDLE_BYTES = 8 * 1024 * 1024


def is_document_name(name: str) -> bool:
    """Returns whether a file of this name is read; hidden files are not."""
    if name == PICTURE:
        return True
    suffix = PurePath(name).suffix.lower()
    return not PurePath(name).name.startswith(".") and (suffix == ".json" or suffix in GRAMMARS)


def left_out(name: str) -> Diagnostic:
    """The remark on a file that is not read."""
    hint = "It is left out; documents end in .ef, .sd, .am, .lf or .json"
    return Diagnostic(Severity.REMARK, "AOS107", "this is not an AOS document", Span(name), hint)


class ReadFile(msgspec.Struct, frozen=True):
    """The result of reading one file: its lines where it is text, its document where it is one."""

    document: Document | None
    diagnostics: tuple[Diagnostic, ...]
    lines: tuple[str, ...]


KnownFiles = dict[tuple[str, bytes], ReadFile]
"""Files that were read before, by name and content: one push looks at the same files several times."""


def read_documents(
    files: Mapping[str, bytes], findings: Findings, known: KnownFiles | None = None
) -> dict[str, Document]:
    """The documents of the files that are one, by file name and in order of it.

    What is in `known` is not read again, and what is read is put there.
    """
    known = {} if known is None else known
    total = sum(map(len, files.values()))
    if len(files) > MAX_BUNDLE_FILES or total > MAX_BUNDLE_BYTES:
        limits = f"{MAX_BUNDLE_FILES} files and {MAX_BUNDLE_BYTES} bytes"
        message = f"{len(files)} files with {total} bytes are too many for a bundle"
        findings.error("AOS120", message, Span(min(files)), f"The limits are {limits}")
        return {}
    documents = {}
    for name in sorted(files):
        read = known.get((name, files[name]))
        if read is None:
            read = known[name, files[name]] = _read_file(name, files[name])
        findings.add_source(name, read.lines)
        for diagnostic in read.diagnostics:
            findings.add(diagnostic)
        if read.document is not None:
            documents[name] = read.document
    return documents


def skills_of_files(files: Mapping[str, bytes]) -> dict[str, str]:
    """The skill that each skill document and each mapping is about, by file name."""
    skills = {name: PurePath(name).stem for name in files if PurePath(name).suffix.lower() in (".sd", ".am")}
    written = {name: data for name, data in files.items() if PurePath(name).suffix.lower() == ".json"}
    kinds = (DocumentKind.SKILL, DocumentKind.MAPPING)
    documents = read_documents(written, Findings()) if written else {}
    return skills | {name: document.name for name, document in documents.items() if document.kind in kinds}


def _read_file(name: str, data: bytes) -> ReadFile:
    findings = Findings()
    document = _read(name, data, findings)
    return ReadFile(document, findings.diagnostics, tuple(findings.lines_of(name)))


def _read(name: str, data: bytes, findings: Findings) -> Document | None:
    path = PurePath(name)
    if len(path.parts) != 1 or name != path.name or "\\" in name:
        findings.error("AOS120", f"{name!r} is no plain file name", Span(name))
        return None
    if not is_document_name(name):
        findings.add(left_out(name))
        return None
    source = open_source(name, data, findings)
    if source is None:
        return None
    if name == PICTURE:
        check_picture(source, findings)
        return None
    if not source.text.strip():
        findings.error("AOS104", "this file is empty", Span(name))
        return None
    return read_json(source, findings) if path.suffix.lower() == ".json" else read_sdl(source, findings)
