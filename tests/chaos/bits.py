"""A run whose aos-up was killed, with a flipped bit in its journal: readers refuse it or are not misled.

    python -m tests.chaos.bits [--times N] [--seed N]

The bit is one of the journal or of its write-ahead log, in turn as SIGKILL leaves them and as they are once
closed. Who reads the run are `aos check`, `aos runs`, `aos decisions`, and `aos-up --resume` at its start.
"""

import argparse
import contextlib
import io
import random
import shutil
import signal
import sqlite3
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import typer
from tests.chaos.up import Up, compile_bundles, send, write_deploy_file

from aos_deploy.cli import aos_app
from aos_deploy.missions.taking_up import take_up
from aos_deploy.runs.end import account_of
from aos_protocol.errors import AosError
from aos_runtime.disk.journal import Journal, JournalRow

DECISIONS = 30
_JOURNAL = ("journal.db", "journal.db-wal")
_ENDED_S = 15.0


def killed_run(folder: Path) -> Path:
    write_deploy_file(folder, 1, 10 * DECISIONS)
    up = Up(folder, "tester.yaml")
    for _ in range(DECISIONS):
        up.until_decision()
    processes = up.processes()
    send(up.process.pid, signal.SIGKILL)
    up.process.wait()
    until_s = time.monotonic() + _ENDED_S
    while any(process.is_left for process in processes) and time.monotonic() < until_s:
        time.sleep(0.05)
    return (folder / "runs" / "latest").resolve()


def codes_of(run: Path) -> dict[str, str]:
    """The codes of the errors that each reader of a run ends with, empty where it ends well."""
    commands = {
        "aos check": ["check", str(run), "--no-replay"],
        "aos runs": ["runs", "--runs", str(run.parent)],
        "aos decisions": ["decisions", "--run", str(run), "--json"],
    }
    codes = {name: _code_of(partial(_call, words)) for name, words in commands.items()}
    codes["verdict"] = _code_of(lambda: account_of(run).verdict())
    codes["aos-up --resume"] = _code_of(partial(_take_up, run))
    return codes


def what_becomes_of(run: Path, whole: list[JournalRow], usual: Mapping[str, str]) -> str:
    """The fate of a run with a flipped bit among its readers; AssertionError where one of them is misled."""
    codes = codes_of(run)
    unusual = {name: code for name, code in codes.items() if code not in ("AOS702", usual[name])}
    assert not unusual, f"unusual codes: {unusual}"
    try:
        with Journal.read(run / "journal.db") as journal:
            rows = journal.rows()
    except AosError:
        assert codes["verdict"] == codes["aos-up --resume"] == "AOS702", f"it cannot be read: {codes}"
        return "refused with AOS702"
    assert rows == whole[: len(rows)], "other rows than were written"
    if codes["aos-up --resume"] == "AOS702":
        return "the last rows are lost, and it is not taken up, with AOS702"
    return "all rows are there" if rows == whole else "the last rows are lost, and nobody was asked for them"


def _call(words: list[str]):
    said = io.TextIOWrapper(io.BytesIO())
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        aos_app(words)(words, standalone_mode=False)


def _take_up(run: Path):
    _, taken_up = take_up(run)
    taken_up.run.close()


def _code_of(read: Callable[[], object]) -> str:
    try:
        read()
    except AosError as error:
        return error.code
    except typer.Exit:
        return ""
    return ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--times", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    draw, found, faults = random.Random(options.seed), Counter[str](), 0
    with tempfile.TemporaryDirectory(prefix="aos-bits-") as name:
        folder = Path(name)
        (folder / "compiled").mkdir()
        compile_bundles(folder / "compiled")
        run = killed_run(folder)
        closed = folder / "closed" / run.name
        shutil.copytree(run, closed, symlinks=True)
        clear_log(closed / "journal.db")
        with Journal.read(closed / "journal.db") as journal:
            whole = journal.rows()
        usual = codes_of(closed)
        for number in range(options.times):
            form = (run, closed)[number % 2]
            shutil.rmtree(folder / "harmed", ignore_errors=True)
            harmed = folder / "harmed" / run.name
            shutil.copytree(form, harmed, symlinks=True)
            place = flip(harmed, draw)
            try:
                found[what_becomes_of(harmed, whole, usual)] += 1
            except Exception as error:
                faults += 1
                sys.stdout.write(f"{place}: {type(error).__name__}: {error}\n")
    sys.stdout.write(f"{len(whole)} rows, {options.times} flipped bits, {faults} misled somebody\n")
    sys.stdout.write(f"readers of the whole run: {usual}\n")
    sys.stdout.writelines(f"{times:5d}  {what}\n" for what, times in found.most_common())
    return int(faults > 0)


def clear_log(journal: Path):
    """Moves the rows out of the write-ahead log into the journal, as its writer does when it ends."""
    database = sqlite3.connect(journal)
    database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    database.close()


def flip(run: Path, draw: random.Random) -> str:
    """Flips a bit of the journal or its log; returns where."""
    (run / "journal.db-shm").unlink(missing_ok=True)
    contents = {file: (run / file).read_bytes() for file in _JOURNAL if (run / file).exists()}
    sizes = [len(content) for content in contents.values()]
    (file,) = draw.choices(list(contents), weights=sizes)
    harmed = bytearray(contents[file])
    place = draw.randrange(len(harmed))
    harmed[place] ^= 1 << draw.randrange(8)
    (run / file).write_bytes(harmed)
    return f"byte {place} of {file}"


if __name__ == "__main__":
    sys.exit(main())
