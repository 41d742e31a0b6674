"""A small share of the mutations of tests/mutate_documents.py, which runs 50,000."""

from mutate_documents import bundles_below, fuzz
from places import BUNDLES


def test_mutated_bundles_are_accepted_or_refused_and_never_crash():
    findings = fuzz(bundles_below(BUNDLES), seed=7, first=0, count=150, on_progress=lambda done: None)
    assert findings.failures == []
    assert findings.outcomes["accepted"] > 0
    assert findings.outcomes["refused by the checks"] > 0
