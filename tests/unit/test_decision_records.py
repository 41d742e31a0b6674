import re

from places import ROOT

MOST_WORDS = 320


def test_a_superseded_record_names_its_successor_and_the_successor_names_it():
    folder = ROOT / "docs" / "decisions"
    status = {path.name[:4]: path.read_text().splitlines()[2] for path in folder.glob("0*.md")}
    names: set[tuple[str, str]] = set()
    for new, line in status.items():
        _, _, superseded = line.partition("Supersedes")
        names |= {(old, new) for old in re.findall(r"\d{4}", superseded)}
    assert names
    marked = {
        (old, new)
        for old, line in status.items()
        for new in re.findall(r"\b\d{4}\b", line.partition("superseded")[2])
    }
    assert marked == names


def test_a_record_is_short():
    """Some 200 words are enough for a situation, a choice and what follows; git keeps how it came about."""
    words = {path.name: len(path.read_text().split()) for path in (ROOT / "docs/decisions").glob("0*.md")}
    assert {name: count for name, count in words.items() if count > MOST_WORDS} == {}
