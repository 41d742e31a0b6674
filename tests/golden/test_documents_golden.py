"""Malformed bundles and the exact text of what is said about them.

The bundle of a case is that of `documents/base` with the changes of `changes.toml`; the files of the case's own
folder replace or join it. Source lines and carets are stored for `SHOWN` alone: they follow from the place. `AOS_PROMOTE=1 pytest tests/golden` takes what is said now as what is expected.
"""

import os
import tomllib
from pathlib import Path

import pytest
from marked_change import changed

from aos_language.load import load_files
from aos_protocol.diagnostics import render

FOLDER = Path(__file__).parent / "documents"
CHANGES = tomllib.loads((FOLDER / "changes.toml").read_text(encoding="utf-8"))
SHOWN = ("json-places-inside-strings", "python-syntax")
FOLDERS = {path.name for path in FOLDER.iterdir() if path.is_dir()} - {"base", "json"}


def files_in(folder: str) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (FOLDER / folder).glob("*")}


def files_of(case: str) -> dict[str, bytes]:
    files, changes = files_in("base"), dict(CHANGES.get(case, {}))
    if changes.pop("pour_is_json", False):
        files = files_in("json") | {name: data for name, data in files.items() if name != "pour.sd"}
    for name in changes.pop("removed", ()):
        del files[name]
    for name, parts in changes.items():
        for part in parts:
            files, _ = changed(files, name, part)
    return files | files_in(case)


def test_the_bundle_that_the_cases_spoil_is_clean():
    loaded = load_files(files_of("base"))
    assert loaded.project is not None
    assert loaded.diagnostics == ()


@pytest.mark.parametrize("case", sorted(FOLDERS | CHANGES.keys()))
def test_a_malformed_bundle_is_explained_as_stored(case):
    loaded = load_files(files_of(case), name="kettle")
    lines = None if case in SHOWN else 1
    texts = ("\n".join(render(diagnostic).split("\n")[:lines]) for diagnostic in loaded.diagnostics)
    text = "".join(f"{text}\n" for text in texts)
    expected = FOLDER / f"{case}.txt"
    if os.environ.get("AOS_PROMOTE"):
        expected.write_text(text, encoding="utf-8")
    assert text == expected.read_text(encoding="utf-8")
    assert (loaded.project is None) == loaded.has_errors
