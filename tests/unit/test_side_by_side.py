"""Tests in two processes: each test once, and no failure is lost."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

FILES = 6


def run(root: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, root / "tests" / "side_by_side.py", "-q"],
        cwd=folder,
        env={**os.environ, "PYTEST_ADDOPTS": "", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


@pytest.mark.parametrize("failing", [(), (0, FILES - 1)])
def test_each_test_runs_once_and_failures_at_both_ends_are_told(
    failing: tuple[int, ...], root: Path, tmp_path: Path
) -> None:
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    for number in range(FILES):
        (tmp_path / f"test_{number}.py").write_text(
            "def test_it():\n"
            f"    open('ran', 'a').write('{number}')\n"
            f"    assert {number} not in {failing}\n\n\n"
            "def test_more():\n    pass\n"
        )
    done = run(root, tmp_path)
    assert done.returncode == (1 if failing else 0), done.stdout
    told = f"both: {f'{len(failing)} failed, ' if failing else ''}{2 * FILES - len(failing)} passed in "
    assert done.stdout.splitlines()[-1].startswith(told)
    assert sorted((tmp_path / "ran").read_text()) == [str(number) for number in range(FILES)]


def test_a_file_that_cannot_be_read_fails_the_run(root: Path, tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    (tmp_path / "test_broken.py").write_text("import nothing_of_this_name\n")
    assert run(root, tmp_path).returncode != 0
