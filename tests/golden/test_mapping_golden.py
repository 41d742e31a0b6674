"""The generated Python of whole bundles, compared text by text.

`AOS_PROMOTE=1 pytest tests/golden` takes what is generated now as what is expected.
"""

from places import BUNDLES, ROOT
import os
from pathlib import Path

import pytest
from projects import bundle_project

from aos_middleware.mappings.revisions import emit_project

EXPECTED = Path(__file__).parent / "python"


def compare(folder: Path, expected: Path):
    generated = {mapping.file_name: mapping.python for mapping in emit_project(bundle_project(folder))}
    if os.environ.get("AOS_PROMOTE"):
        expected.mkdir(parents=True, exist_ok=True)
        for name, text in generated.items():
            (expected / name).write_text(text, encoding="utf-8")
    stored = {path.name: path.read_text(encoding="utf-8") for path in expected.glob("*.py")}
    assert generated == stored


def test_a_json_mapping_with_every_construct_is_generated_as_stored():
    compare(ROOT / "docs" / "examples" / "kettle-json", EXPECTED / "kettle")


def test_the_mapping_of_a_monitor_is_generated_as_stored():
    compare(EXPECTED.parents[1] / "data" / "bundles" / "battery", EXPECTED / "battery")


def test_generating_twice_gives_the_same_bytes():
    first, second = (emit_project(bundle_project(BUNDLES / "armadillo-finer")) for _ in range(2))
    assert first == second


@pytest.mark.corpus
def test_every_mapping_of_the_original_bundles_is_generated(corpus: Path):
    folders = [path for path in sorted(corpus.iterdir()) if path.is_dir() and path.name != "bad"]
    counts = {folder.name: len(emit_project(bundle_project(folder))) for folder in folders}
    assert counts == {
        "armadillo-finer": 5,
        "armadillo-rough": 5,
        "paper-example-json": 1,
        "paper-example-sdl": 1,
        "sampling-rate": 3,
        "sarsop-simple": 2,
        "tic-tac-toe-json": 2,
        "tic-tac-toe-sdl": 2,
        "turtlebot-visit": 1,
        "wildfire": 2,
    }
