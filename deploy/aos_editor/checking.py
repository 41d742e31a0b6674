"""A bundle as an editor shows it, checked: the files of a folder, with the unsaved texts in their place."""

import re
from collections.abc import Mapping
from pathlib import Path

from aos_language.findings import Findings
from aos_language.load import load_files, read_bundle_files, with_excerpts
from aos_language.reading.sdl_words import GRAMMARS
from aos_language.reading.source import open_source
from aos_protocol.diagnostics import Diagnostic, Severity
from aos_solver.emission.lowering.lower import lower

_TOKEN = re.compile(r"\w+|\S")


def shown_files(folder: Path, open_texts: Mapping[str, str]) -> tuple[dict[str, bytes], list[Diagnostic]]:
    """Returns the files of a bundle's folder, and remarks on what is left out. `open_texts` are unsaved texts
    by file name."""
    files, remarks = read_bundle_files(folder)
    files.update((name, text.encode("utf-8", "replace")) for name, text in open_texts.items())
    return files, remarks


def check_folder(
    folder: Path, open_texts: Mapping[str, str]
) -> dict[str, tuple[list[str], list[Diagnostic]]]:
    """Returns for each file of the bundle its lines and what is wrong with it.

    `open_texts` are texts by file name. What belongs to no file is told at the first open one; that files
    are left out which are no documents, at none. Empty where the folder holds no AOS documents; the C++
    compiler is not asked, for it takes seconds.
    """
    files, remarks = shown_files(folder, open_texts)
    loaded = load_files(files, name=folder.name, remarks=remarks)
    if not loaded.files and not any(Path(name).suffix.lower() in GRAMMARS for name in files):
        return {}
    found = loaded.diagnostics
    if loaded.project is not None:
        found = (*found, *with_excerpts(lower(loaded.project)[1], files))
    checked: dict[str, tuple[list[str], list[Diagnostic]]] = {
        name: (lines_of(name, data), []) for name, data in files.items()
    }
    fallback = min(open_texts, default=min(checked))
    for diagnostic in found:
        name = diagnostic.span.file
        if name not in checked and diagnostic.severity is Severity.REMARK:
            continue
        checked[name if name in checked else fallback][1].append(diagnostic)
    return checked


def lines_of(name: str, data: bytes) -> list[str]:
    """The lines as the readers count them; one empty line where the file is no text."""
    source = open_source(name, data, Findings())
    return source.lines if source is not None else [""]


def end_column(line: str, column: int) -> int:
    """Returns the end of the word or sign that starts at a column (from 0); at least one further."""
    match = _TOKEN.match(line, column)
    return match.end() if match is not None else column + 1
