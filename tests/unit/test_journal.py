import random
import sqlite3
import zlib
from contextlib import closing
from pathlib import Path

import pytest

from aos_protocol.errors import StorageError
from aos_protocol.messages import Cancel, MissionState
from aos_runtime.disk.journal import Journal, JournalRow


class StoppedClock:
    def now_ns(self) -> int:
        return 1_700_000_000_000_000_000

    def monotonic_s(self) -> float:
        return 0.0


def test_rows_come_back_as_they_were_appended(tmp_path):
    with Journal.open(tmp_path / "journal.db", clock=StoppedClock()) as journal:
        assert [journal.append("cancel", Cancel(reason)) for reason in ("first", "second")] == [1, 2]
        rows = journal.rows()

    assert [row.read_as(Cancel).reason for row in rows] == ["first", "second"]
    assert [(row.seq, row.kind, row.stamp_ns) for row in rows] == [
        (1, "cancel", 1_700_000_000_000_000_000),
        (2, "cancel", 1_700_000_000_000_000_000),
    ]


@pytest.mark.parametrize("payload", ["{", '{"reason": 1}', "[" * 100_000, "[1, 2]"])
def test_a_row_that_is_something_else_than_is_asked_for_is_told_with_its_place(payload, tmp_path):
    row = JournalRow(7, 0, "steered", payload.encode(), tmp_path / "journal.db")

    with pytest.raises(StorageError, match=r"journal\.db: row 7, steered, cannot be read") as error:
        row.read_as(Cancel)

    assert error.value.code == "AOS702"


def test_rows_can_be_asked_by_kind_and_from_a_number(tmp_path):
    with Journal.open(tmp_path / "journal.db") as journal:
        for number in range(6):
            journal.append("even" if number % 2 == 0 else "odd", Cancel(str(number)))

        assert [row.seq for row in journal.rows("odd")] == [2, 4, 6]
        assert [row.seq for row in journal.rows("even", since=3)] == [3, 5]
        assert journal.rows("none") == []


def test_a_journal_goes_on_where_it_ended(tmp_path):
    path = tmp_path / "journal.db"
    for expected in (1, 2, 3):
        with Journal.open(path) as journal:
            assert journal.append("cancel", Cancel()) == expected


def test_rows_cannot_be_changed_or_removed(tmp_path):
    path = tmp_path / "journal.db"
    with Journal.open(path) as journal:
        journal.append("cancel", Cancel("true"))
    database = sqlite3.connect(path)
    with pytest.raises(sqlite3.IntegrityError, match="append-only"):
        database.execute("UPDATE entries SET payload = '{}'")
    with pytest.raises(sqlite3.IntegrityError, match="append-only"):
        database.execute("DELETE FROM entries")
    database.close()


def test_a_reader_sees_what_the_writer_appended_and_cannot_write(tmp_path):
    path = tmp_path / "journal.db"
    with Journal.open(path) as writer, Journal.read(path) as reader:
        writer.append("mission", MissionState("m", "waiting", 0, 0.0))
        assert len(reader.rows("mission")) == 1
        with pytest.raises(StorageError, match="readonly") as caught:
            reader.append("mission", Cancel())
    assert caught.value.code == "AOS701"


@pytest.mark.parametrize("content", [b"", b"not a database, but long enough to be taken for one" * 50])
def test_a_file_that_is_no_journal_is_refused(tmp_path, content):
    path = tmp_path / "journal.db"
    path.write_bytes(content)
    with pytest.raises(StorageError) as caught:
        Journal.read(path)
    assert caught.value.code == "AOS702"
    assert str(path) in caught.value.message


def test_a_journal_of_another_version_is_left_alone(tmp_path):
    path = tmp_path / "journal.db"
    database = sqlite3.connect(path)
    database.execute("PRAGMA user_version = 7")
    database.close()
    with pytest.raises(StorageError, match="not a journal of this version"):
        Journal.open(path)


def test_a_missing_folder_is_a_clear_error(tmp_path):
    with pytest.raises(StorageError, match="unable to open") as caught:
        Journal.open(tmp_path / "absent" / "journal.db")
    assert caught.value.code == "AOS701"
    with pytest.raises(StorageError, match="there is no journal"):
        Journal.read(tmp_path / "absent" / "journal.db")


def test_a_full_disk_is_an_error_and_the_rows_before_it_stay(tmp_path):
    with Journal.open(tmp_path / "journal.db") as journal:
        journal.append("cancel", Cancel("kept"))
        journal._connection.execute("PRAGMA max_page_count = 8")
        with pytest.raises(StorageError, match="full") as caught:
            journal.append("cancel", Cancel("x" * 100_000))
        assert caught.value.code == "AOS701"
        assert len(journal.rows()) == 1


@pytest.mark.parametrize("lacking", [1, 3, 5])
def test_a_row_that_is_lacking_is_an_error(tmp_path, lacking):
    path = tmp_path / "journal.db"
    with Journal.open(path) as journal:
        for number in range(5):
            journal.append("cancel", Cancel(str(number)))
    database = sqlite3.connect(path, isolation_level=None)
    database.execute("DROP TRIGGER entries_remain")
    database.execute("DELETE FROM entries WHERE seq = ?", (lacking,))
    database.close()
    with Journal.read(path) as journal, pytest.raises(StorageError) as caught:
        journal.rows()
    assert caught.value.code == "AOS702"


@pytest.mark.parametrize("seed", range(3))
def test_a_flipped_bit_is_an_error_or_changes_no_row(tmp_path, seed):
    path = tmp_path / "journal.db"
    with Journal.open(path, clock=StoppedClock()) as journal:
        for number in range(40):
            journal.append("cancel", Cancel(f"reason {number} " * 12))
        rows = journal.rows()
    whole = path.read_bytes()
    draw = random.Random(seed)
    read = [read_damaged(path, whole, draw) for _ in range(100)]
    assert all(found is None or found == rows for found in read)
    assert read.count(None) > 10  # The others are in places where no row is.


def read_damaged(path: Path, whole: bytes, draw: random.Random) -> list[JournalRow] | None:
    """The rows of a journal with one bit flipped; None where it is refused."""
    damaged = bytearray(whole)
    damaged[draw.randrange(len(whole))] ^= 1 << draw.randrange(8)
    path.write_bytes(damaged)
    return rows_of(path)


@pytest.mark.parametrize("harm", ["cut off", "flipped bit"])
def test_a_harmed_write_ahead_log_gives_the_first_rows_or_is_an_error(tmp_path, harm):
    path, log = tmp_path / "journal.db", tmp_path / "journal.db-wal"
    with Journal.open(path, clock=StoppedClock()) as journal:
        for number in range(30):
            journal.append("cancel", Cancel(f"reason {number} " * 12))
        rows = journal.rows()
        files = {path: path.read_bytes(), log: log.read_bytes()}  # As SIGKILL would leave them.
    draw, lengths = random.Random(1), set()
    for _ in range(100):
        left = bytearray(files[log])
        if harm == "cut off":
            del left[draw.randrange(len(left)) :]
        else:
            left[draw.randrange(len(left))] ^= 1 << draw.randrange(8)
        path.write_bytes(files[path])
        log.write_bytes(left)
        (tmp_path / "journal.db-shm").unlink(missing_ok=True)
        found = rows_of(path)
        if found is not None:
            assert found == rows[: len(found)]
            lengths.add(len(found))
    assert len(lengths) > 10


def rows_of(path: Path) -> list[JournalRow] | None:
    """The rows of a journal; None where it is refused."""
    try:
        with Journal.read(path) as journal:
            return journal.rows()
    except StorageError as error:
        return None if error.code == "AOS702" else []


@pytest.mark.parametrize(
    "entries",
    [
        "CREATE VIEW entries AS WITH RECURSIVE n(seq) AS (SELECT 1 UNION ALL SELECT seq + 1 FROM n) "
        "SELECT seq, 1 AS stamp_ns, 'x' AS kind, '{}' AS payload FROM n",
        "CREATE TABLE entries (seq INTEGER PRIMARY KEY, stamp_ns, kind, payload AS (hex(zeroblob(1e8))))",
    ],
)
def test_a_journal_that_computes_its_rows_is_refused(entries, tmp_path):
    path = tmp_path / "journal.db"
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(f"{entries}; PRAGMA user_version = 2;")
    with pytest.raises(StorageError, match="entries is no plain table"):
        Journal.read(path)


def test_a_row_that_is_no_text_is_an_error(tmp_path):
    path, checksum = tmp_path / "journal.db", zlib.crc32(f"1 x {bytes(1)!r}".encode())
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(
            "CREATE TABLE entries (seq INTEGER PRIMARY KEY AUTOINCREMENT, stamp_ns, kind, payload, checksum);"
            f"INSERT INTO entries VALUES (1, 1, 'x', x'00', {checksum}); PRAGMA user_version = 2;"
        )
    with Journal.read(path) as journal, pytest.raises(StorageError, match="row 1 has no text"):
        journal.rows()
