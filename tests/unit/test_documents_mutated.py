"""A small share of the mutations of tests/fuzz/mutate_documents.py, which runs 50,000."""

import sys
from pathlib import Path

FUZZ = Path(__file__).resolve().parents[1] / "fuzz"


def test_mutated_bundles_are_accepted_or_refused_and_never_crash(bundles: Path) -> None:
    sys.path.insert(0, str(FUZZ))
    try:
        from mutate_documents import bundles_below, fuzz
    finally:
        sys.path.remove(str(FUZZ))
    findings = fuzz(bundles_below(bundles), seed=7, first=0, count=150, on_progress=lambda done: None)
    assert findings.failures == []
    assert findings.outcomes["accepted"] > 0
    assert findings.outcomes["refused by the checks"] > 0
