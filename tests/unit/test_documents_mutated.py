"""A small share of the mutations of tests/mutate_documents.py, which runs 50,000."""

from pathlib import Path

from mutate_documents import bundles_below, fuzz


def test_mutated_bundles_are_accepted_or_refused_and_never_crash(bundles: Path):
    findings = fuzz(bundles_below(bundles), seed=7, first=0, count=150, on_progress=lambda done: None)
    assert findings.failures == []
    assert findings.outcomes["accepted"] > 0
    assert findings.outcomes["refused by the checks"] > 0
