"""The helps of commands are whole on a terminal of 80 columns, and each has an example."""

import io
import re
from collections.abc import Iterator
from contextlib import redirect_stdout
from pathlib import Path

import pytest
import typer
from typer.core import TyperGroup

from aos_deploy.cli import aos_app

ROOT = Path(__file__).resolve().parents[2]


def paths_below(group: TyperGroup, path: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """The words after `aos` of each command, groups before their own."""
    yield path
    for name, command in group.commands.items():
        if isinstance(command, TyperGroup):
            yield from paths_below(command, (*path, name))
        else:
            yield (*path, name)


def help_of(root: TyperGroup, path: tuple[str, ...]) -> str:
    text = io.StringIO()
    with redirect_stdout(text), pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", "80")
        root.main([*path, "-h"], prog_name="aos", standalone_mode=False)
    return text.getvalue()


def cut_off(text: str) -> list[str]:
    """The lines of the list of commands that do not end with the sentence."""
    return [line for line in text.partition("Commands:")[2].splitlines() if line.endswith("...")]


@pytest.fixture(scope="module")
def helps() -> dict[str, str]:
    root = typer.main.get_command(aos_app())
    assert isinstance(root, TyperGroup)
    return {" ".join(("aos", *path)): help_of(root, path) for path in paths_below(root, ())}


def test_each_command_has_an_example_of_itself(helps: dict[str, str]):
    assert len(helps) > 50
    examples = {name: " ".join(text.split()).replace("aos-up", "aos up") for name, text in helps.items()}
    assert [name for name, text in examples.items() if f"Example: {name}" not in text] == []


def test_files_of_examples_are_there_or_made_by_commands(helps: dict[str, str]):
    named = set()
    for text in helps.values():
        example = re.sub(
            r"(--out|--junit|--write|>) \S+", "", " ".join(text.partition("Example: ")[2].split())
        )
        named |= set(re.findall(r"[\w./-]+/[\w/.-]+|\b[\w-]+\.(?:yaml|txt|policy)\b", example))
    files = {re.sub(r"\.$", "", word) for word in named if not word.startswith(("runs/", "/"))}
    assert len(files) > 5
    assert [name for name in files - {"armadillo/armadillo.yaml"} if not (ROOT / name).exists()] == []


def test_no_list_of_commands_cuts_a_sentence_off(helps: dict[str, str]):
    assert [line for text in helps.values() for line in cut_off(text)] == []


def test_a_sentence_that_is_too_long_is_found():
    app = typer.Typer(rich_markup_mode=None, context_settings={"help_option_names": ["-h"]})
    app.callback()(lambda: None)
    app.command(help="word " * 40)(lambda: None)
    root = typer.main.get_command(app)
    assert isinstance(root, TyperGroup)
    assert cut_off(help_of(root, ()))
