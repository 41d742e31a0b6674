from pathlib import Path

import pytest
from decision_records import decision_record

from aos_protocol.errors import StorageError
from aos_protocol.messages import HistoryQuery, MissionState
from aos_runtime.disk.journal import Journal
from aos_solver.mission.records import history
from aos_solver.mission.records.history import history_page

COUNT = 23


@pytest.fixture
def journal(tmp_path) -> Path:
    path = tmp_path / "journal.db"
    with Journal.open(path, survives_power_loss=False) as rows:
        for sequence in range(COUNT):
            for _ in range(sequence % 4):
                rows.append("mission", MissionState("m", "planning", 1, 0.0))
            rows.append("decision", decision_record(sequence))
    return path


def sequences(journal: Path, since: int, limit: int = 0) -> tuple[list[int], bool]:
    page = history_page(journal, "m", HistoryQuery(since, limit))
    assert page.mission == "m"
    return [record.sequence for record in page.records], page.has_more


@pytest.mark.parametrize("limit", [1, 2, 7, COUNT - 1, COUNT])
def test_page_after_page_has_every_record_once_and_in_order(journal: Path, limit):
    numbers: list[int] = []
    has_more = True
    while has_more:
        page, has_more = sequences(journal, len(numbers), limit)
        assert len(page) == min(limit, COUNT - len(numbers))
        numbers += page
    assert numbers == list(range(COUNT))


@pytest.mark.parametrize("since", range(-1, COUNT + 2))
def test_a_page_begins_where_it_is_asked_to(journal: Path, since):
    assert sequences(journal, since) == (list(range(max(since, 0), COUNT)), False)


def test_a_page_is_no_larger_than_its_size_and_one_record(journal: Path, monkeypatch):
    monkeypatch.setattr(history, "PAGE_BYTES", 1)
    assert sequences(journal, 5) == ([5], True)
    assert sequences(journal, COUNT - 1) == ([COUNT - 1], False)


def test_a_mission_without_a_decision_has_an_empty_history(tmp_path):
    with Journal.open(tmp_path / "journal.db"):
        assert sequences(tmp_path / "journal.db", 0) == ([], False)


def test_a_damaged_record_is_told_with_its_row(journal: Path):
    journal.write_bytes(journal.read_bytes().replace(b'"sequence":5,', b'"sequence":x,'))
    with pytest.raises(StorageError, match=r"row 13 is damaged") as raised:
        sequences(journal, 5)
    assert raised.value.code == "AOS702"
