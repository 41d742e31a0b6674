"""Runs all tests in two processes, for machines with two cores or more: much of a run is single compilations.

One process takes test files from the first on, the other from the last on, until they meet. What is compiled
is there for both. Each prints its own report; the second one's follows when the first has ended.

    python tests/side_by_side.py [PYTEST ARGUMENT...]

The exit code is pytest's, the worse of both.
"""

from __future__ import annotations

import itertools
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

__all__ = ["CACHE_VARIABLE"]

CACHE_VARIABLE = "AOS_TESTS_CACHE_DIR"
"""Names the directory of what tests compile, where several processes share it."""

_SHARE = "--share-of"
_OUTCOMES = ("failed", "error", "passed", "skipped", "xfailed", "xpassed")


class Share:
    """A pytest plugin that runs the test files which the other process has not begun.

    `folder` is of both processes: there a file is claimed by making a file.
    """

    def __init__(self, folder: Path, name: str) -> None:
        self._folder = folder
        self._name = name

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """In place of pytest's own loop over all tests."""
        if session.testsfailed:
            raise session.Interrupted(f"{session.testsfailed} errors during collection")
        for items in self._claimed(session.items):
            for item, following in itertools.zip_longest(items, items[1:]):
                item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
                if session.shouldfail:
                    raise session.Failed(session.shouldfail)
                if session.shouldstop:
                    raise session.Interrupted(session.shouldstop)
        return True

    def _claimed(self, items: list[pytest.Item]) -> Iterator[list[pytest.Item]]:
        files = [list(group) for _, group in itertools.groupby(items, key=lambda item: item.path)]
        for tests in files if self._name == "first" else reversed(files):
            try:
                (self._folder / tests[0].nodeid.partition("::")[0].replace("/", "+")).touch(exist_ok=False)
            except FileExistsError:
                return
            yield tests

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Leaves the numbers of outcomes for the sum."""
        counts = {outcome: len(terminalreporter.stats.get(outcome, [])) for outcome in _OUTCOMES}
        (self._folder / f"{self._name}.json").write_text(json.dumps(counts))


def main(arguments: list[str]) -> int:
    """Starts both processes and waits for them."""
    started_s = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="aos-tests-") as name:
        folder = Path(name)
        (folder / "cache").mkdir()
        environment = {**os.environ, CACHE_VARIABLE: str(folder / "cache")}
        command = [sys.executable, __file__, _SHARE, name]
        with (
            (folder / "last.txt").open("w+") as report,
            subprocess.Popen([*command, "first", *arguments], env=environment) as first,
            subprocess.Popen(
                [*command, "last", *arguments], env=environment, stdout=report, stderr=subprocess.STDOUT
            ) as last,
        ):
            # Both hear of Ctrl-C themselves, and need some time to end what they have started.
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            statuses = (first.wait(), last.wait())
            report.seek(0)
            print(report.read())
        print(f"both: {_sum(folder)} in {time.monotonic() - started_s:.0f} s")
    return max(statuses, key=abs)


def _sum(folder: Path) -> str:
    counts = [json.loads(path.read_text()) for path in folder.glob("*.json")]
    sums = {outcome: sum(count[outcome] for count in counts) for outcome in _OUTCOMES}
    return ", ".join(f"{number} {outcome}" for outcome, number in sums.items() if number > 0) or "none"


if __name__ == "__main__":
    if sys.argv[1:2] == [_SHARE]:
        sys.exit(pytest.main(sys.argv[4:], plugins=[Share(Path(sys.argv[2]), sys.argv[3])]))
    sys.exit(main(sys.argv[1:]))
