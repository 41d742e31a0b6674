"""Malformed bundles and the exact text of what is said about them.

Each folder in `documents` lies over `documents/base`: its files replace or join those, and the names in its
file REMOVED are taken away. `AOS_PROMOTE=1 pytest tests/golden` takes what is said now as what is expected.
"""

import os
from pathlib import Path

import pytest

from aos_protocol.diagnostics import render
from aos_language.load import load_files

FOLDER = Path(__file__).parent / "documents"
CASES = sorted(path.name for path in FOLDER.iterdir() if path.is_dir() and path.name != "base")


def files_of(case: str) -> dict[str, bytes]:
    files = {path.name: path.read_bytes() for path in (FOLDER / "base").iterdir()}
    changes = {path.name: path.read_bytes() for path in (FOLDER / case).iterdir()}
    for name in changes.pop("REMOVED", b"").decode().split():
        del files[name]
    return files | changes


def test_the_bundle_that_the_cases_spoil_is_clean() -> None:
    loaded = load_files(files_of("base"))
    assert loaded.project is not None
    assert loaded.diagnostics == ()


@pytest.mark.parametrize("case", CASES)
def test_a_malformed_bundle_is_explained_as_stored(case: str) -> None:
    loaded = load_files(files_of(case), name="kettle")
    text = "".join(f"{render(diagnostic)}\n" for diagnostic in loaded.diagnostics)
    expected = FOLDER / f"{case}.txt"
    if os.environ.get("AOS_PROMOTE"):
        expected.write_text(text, encoding="utf-8")
    assert text == expected.read_text(encoding="utf-8")
    assert (loaded.project is None) == loaded.has_errors
