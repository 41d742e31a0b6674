import io
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import redirect_stdout, suppress

import pytest
import typer
from places import ROOT
from typer.core import TyperGroup, TyperOption
from typer.testing import CliRunner

from aos_deploy.cli import aos_app


def paths_below(group: TyperGroup, path: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
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


def options_below(group: TyperGroup) -> Iterator[TyperOption]:
    for command in group.commands.values():
        if isinstance(command, TyperGroup):
            yield from options_below(command)
        else:
            yield from (option for option in command.params if isinstance(option, TyperOption))


def test_each_option_refuses_what_is_no_number_and_only_values_may_be_as_large_as_they_like():
    root = typer.main.get_command(aos_app())
    assert isinstance(root, TyperGroup)
    numbers = [option for option in options_below(root) if option.type.name.startswith("float")]
    taken: dict[str, set[str | None]] = {"nan": set(), "1e300": set()}
    for option in numbers:
        for text, takers in taken.items():
            with suppress(typer.BadParameter):
                option.process_value(typer.Context(root), text)
                takers.add(option.name)
    assert len(numbers) > 8
    assert taken == {"nan": set(), "1e300": {"precision", "stop_value", "stop_below_value"}}


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


def test_the_help_that_imports_no_command_says_what_the_commands_say(helps: dict[str, str]):
    root = typer.main.get_command(aos_app(["--help"]))
    assert isinstance(root, TyperGroup)
    assert sorted(help_of(root, ()).splitlines()) == sorted(helps["aos"].splitlines())


def test_the_help_of_all_commands_imports_none_of_them():
    code = "import sys; from aos_deploy.cli import main; main(lambda: print(*sys.modules))"
    done = subprocess.run(
        (sys.executable, "-c", code, "--help"), capture_output=True, text=True, check=True, timeout=60
    )
    assert "aos_deploy.told_numbers" in done.stdout
    assert not re.search(r"aos_deploy\.commands|aos_(lab|solver|gateway|editor)", done.stdout)


@pytest.mark.parametrize("arguments", [["--", "schema", "deploy"], ["schema", "deploy"]])
def test_a_command_is_found_behind_two_dashes(arguments):
    assert '"$schema"' in CliRunner().invoke(aos_app(arguments), arguments).stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("simulate x --runs two", "'--runs': 'two' is not a whole number of at least 1, such as 10"),
        ("plan x --horizon 10001", "'--horizon': 10001 is not a whole number from 1 to 10000, such as 1"),
        ("simulate x --runs 0", "'--runs': 0 is not a whole number of at least 1, such as 10"),
        ("plan x --threads 33", "'--threads': 33 is not a whole number from 1 to 32, such as 1"),
        ("solve x --discount 2", "'--discount': 2.0 is not a number from 0 to 1, such as 0.5"),
        (
            "simulate x --goal-probability 2",
            "'--goal-probability': 2.0 is not a number from 0.001 to 1, such as 0.5",
        ),
        ("plan x --time soon", "'--time': 'soon' is not a number from 0.001 to 604800.0, such as 1"),
        ("serve --port -1", "'--port': -1 is not a whole number from 0 to 65535, such as 7480"),
        ("runs prune --keep all", "'--keep': 'all' is not a whole number of at least 0, such as 1"),
        ("up x --seed z", f"'--seed': 'z' is not a whole number from 0 to {2**63 - 1}, such as 1"),
    ],
)
def test_a_number_that_is_not_taken_is_told_with_those_that_are(words, said):
    assert (
        CliRunner().invoke(aos_app(), words.split()).stderr.splitlines()[-1]
        == f"Error: Invalid value for {said}"
    )


def test_a_program_of_one_command_tells_of_numbers_too():
    program = (sys.executable, "-c", "from aos_deploy.cli import up_main; up_main()")
    done = subprocess.run(
        (*program, "x", "--seed", "z"), capture_output=True, text=True, check=False, timeout=60
    )
    assert f"'z' is not a whole number from 0 to {2**63 - 1}, such as 1" in done.stderr


def test_a_sentence_that_is_too_long_is_found():
    app = typer.Typer(rich_markup_mode=None, context_settings={"help_option_names": ["-h"]})
    app.callback()(lambda: None)
    app.command(help="word " * 40)(lambda: None)
    root = typer.main.get_command(app)
    assert isinstance(root, TyperGroup)
    assert cut_off(help_of(root, ()))
