"""The engine's headers by themselves: each sentence of tests/cpp/units is a test."""

import json
import re
from pathlib import Path

import pytest
from engine_checks import UNITS, engine_checks
from processes import finished

SENTENCES = re.compile(r'^TEST\("(.+)"\)', re.MULTILINE)

sentences = [
    sentence for path in sorted(UNITS.glob("*.cpp")) for sentence in SENTENCES.findall(path.read_text())
]


@pytest.fixture(scope="module")
def results(cache_dir: Path) -> dict[str, list[str]]:
    """The expectations of each test that were in vain."""
    done = finished(engine_checks(cache_dir))
    entries = [json.loads(line) for line in done.stdout.splitlines()]
    return {entry["test"]: entry["failures"] for entry in entries}


@pytest.mark.parametrize("sentence", sentences)
def test_in_cpp(sentence, results: dict[str, list[str]]):
    assert sentence in results, "the tests ended before this one"
    assert not results[sentence], "\n".join(results[sentence])
