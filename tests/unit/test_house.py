"""Limits of the house that a test can hold everybody to: the length of functions, and their parameters."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("protocol", "services", "deploy", "tests", "docs")
MOST_LINES = 60
MOST_PARAMETERS = 7

Function = ast.FunctionDef | ast.AsyncFunctionDef


def functions_of(path: Path) -> Iterator[Function]:
    return (node for node in ast.walk(ast.parse(path.read_bytes())) if isinstance(node, Function))


def lines_of(function: Function) -> int:
    assert function.end_lineno is not None
    return function.end_lineno - function.lineno + 1


def parameters_of(function: Function) -> list[ast.arg]:
    """The parameters that a caller gives."""
    arguments = function.args
    named = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    return [parameter for parameter in named if parameter.arg not in ("self", "cls")]


def is_command(function: Function, options: frozenset[str]) -> bool:
    """Returns whether a parameter is an option or an argument of a command line, by its annotation."""
    notes = [
        ast.unparse(parameter.annotation) for parameter in parameters_of(function) if parameter.annotation
    ]
    return any("typer." in note or note in options for note in notes)


def options_in(path: Path) -> frozenset[str]:
    """The names that a file gives to annotations of typer."""
    return frozenset(
        target.id
        for node in ast.parse(path.read_bytes()).body
        if isinstance(node, ast.Assign) and "typer." in ast.unparse(node.value)
        for target in node.targets
        if isinstance(target, ast.Name)
    )


@pytest.fixture(scope="module")
def sources() -> dict[str, list[Function]]:
    """The functions of every file of ours."""
    paths = (path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py")))
    return {str(path.relative_to(ROOT)): list(functions_of(path)) for path in paths}


def test_no_function_is_longer_than_a_screen(sources: dict[str, list[Function]]) -> None:
    assert len(sources) > 400
    long = [
        f"{path}:{function.lineno}: {function.name} has {lines_of(function)} lines"
        for path, functions in sources.items()
        for function in functions
        if lines_of(function) > MOST_LINES
    ]
    assert not long


def test_no_function_but_a_command_has_many_parameters(sources: dict[str, list[Function]]) -> None:
    many = [
        f"{path}:{function.lineno}: {function.name} has {len(parameters_of(function))} parameters"
        for path, functions in sources.items()
        for function in functions
        if len(parameters_of(function)) > MOST_PARAMETERS
        and not is_command(function, options_in(ROOT / path))
    ]
    assert not many


def test_a_function_that_breaks_a_limit_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "wide.py"
    path.write_text("def wide(a, b, c, d, e, f, g, *, h=1):\n" + "    pass\n" * MOST_LINES)
    (wide,) = functions_of(path)
    assert (lines_of(wide), len(parameters_of(wide))) == (MOST_LINES + 1, MOST_PARAMETERS + 1)
    assert not is_command(wide, options_in(path))
