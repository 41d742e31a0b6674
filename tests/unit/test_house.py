import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from places import ROOT

FOLDERS = ("protocol", "services", "deploy", "tests", "docs")
MOST_LINES = 60
MOST_PARAMETERS = 7
MOST_TRACKED_BYTES = 8_000_000

Function = ast.FunctionDef | ast.AsyncFunctionDef


def functions_of(path: Path) -> Iterator[Function]:
    """The functions of a file: statements, so no expression is looked at."""
    waiting: list[ast.AST] = [ast.parse(path.read_bytes())]
    while waiting:
        node = waiting.pop()
        if isinstance(node, Function):
            yield node
        for part in ("body", "orelse", "finalbody", "handlers", "cases"):
            inner = getattr(node, part, ())
            waiting += inner if isinstance(inner, list) else ()


def tracked_bytes(folder: Path) -> int:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=folder, capture_output=True, check=True).stdout
    paths = [folder / name.decode() for name in listed.split(b"\0") if name]
    return sum(path.lstat().st_size for path in paths if path.is_file())


def lines_of(function: Function) -> int:
    assert function.end_lineno is not None
    return function.end_lineno - function.lineno + 1


def parameters_of(function: Function) -> list[ast.arg]:
    arguments = function.args
    named = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    return [parameter for parameter in named if parameter.arg not in ("self", "cls")]


def faults_of(path: Path) -> Iterator[str]:
    """The functions of a file that are too long, or take too many values."""
    for function in functions_of(path):
        place = f"{path}:{function.lineno}: {function.name} has"
        if (lines := lines_of(function)) > MOST_LINES:
            yield f"{place} {lines} lines"
        many = len(parameters_of(function))
        if many > MOST_PARAMETERS:
            yield f"{place} {many} parameters"


def test_no_function_is_longer_than_a_screen_or_has_many_parameters():
    paths = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py"))]
    assert len(paths) > 400
    assert [fault for path in paths for fault in faults_of(path)] == []


def test_a_function_that_breaks_a_limit_is_noticed(tmp_path):
    path = tmp_path / "wide.py"
    path.write_text("def wide(a, b, c, d, e, f, g, *, h=1):\n" + "    pass\n" * MOST_LINES)
    assert list(faults_of(path)) == [
        f"{path}:1: wide has {MOST_LINES + 1} lines",
        f"{path}:1: wide has {MOST_PARAMETERS + 1} parameters",
    ]


def test_the_files_that_git_tracks_are_small_together():
    if not (ROOT / ".git").exists():
        pytest.skip("needs a checkout of git")
    assert 0 < tracked_bytes(ROOT) < MOST_TRACKED_BYTES


def test_a_tracked_file_counts_and_another_one_does_not(tmp_path):
    subprocess.run(["git", "init", "-q", tmp_path], check=True)
    (tmp_path / "tracked").write_bytes(b"1234")
    (tmp_path / "other").write_bytes(b"12345678")
    subprocess.run(["git", "add", "tracked"], cwd=tmp_path, check=True)
    assert tracked_bytes(tmp_path) == 4


def test_every_command_of_contributing_can_be_imported():
    named = sorted(set(re.findall(r"python -m (tests\.[\w.]+\w)", (ROOT / "CONTRIBUTING.md").read_text())))
    modules = [f"{name}.__main__" if (ROOT / name.replace(".", "/")).is_dir() else name for name in named]
    assert len(modules) > 10
    subprocess.run([sys.executable, "-c", f"import {', '.join(modules)}"], cwd=ROOT, check=True)


def test_the_walks_of_contributing_lead_to_files():
    table = (ROOT / "CONTRIBUTING.md").read_text().partition("| Question | Walk |\n| --- | --- |\n")[2]
    rows = table.partition("\n\n")[0].splitlines()
    walks = ["/".join(re.findall("`([^`]+)`", row.split("|")[2])) for row in rows]
    assert len(walks) == 6
    assert [walk for walk in walks if not (ROOT / walk).is_file()] == []
