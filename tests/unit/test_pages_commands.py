import re
from collections.abc import Iterator

import pytest
import typer
from places import ROOT
from typer.core import TyperCommand, TyperGroup

from aos_deploy.cli import aos_app

PAGES = [
    *ROOT.glob("*.md"),
    *(page for page in (ROOT / "docs").rglob("*.md") if "experiments" not in page.parts),
]
TYPED = re.compile(r"`([^`\n]+)`|^\s*(?:\$ )?((?:\.venv/bin/)?aos(?:-up)? (?!=)[^\n]*)$", re.MULTILINE)
"""Code within a line, and the lines of blocks that begin with a command."""
CALL = re.compile(r"(?:\.venv/bin/)?(aos|aos-up) +(.*)")

Words = tuple[str, ...]
Options = dict[Words, frozenset[str]]


def options_of(command: TyperGroup | TyperCommand, path: Words = ()) -> Iterator[tuple[Words, str]]:
    yield path, "--help"
    for parameter in command.params:
        for name in (*parameter.opts, *parameter.secondary_opts):
            yield path, name
    if isinstance(command, TyperGroup):
        for name, below in command.commands.items():
            assert isinstance(below, TyperGroup | TyperCommand)
            yield from options_of(below, (*path, name))


def unknown_in(line: str, options: Options) -> str:
    """The command or option of a line that there is not; empty where all is there, or no command is."""
    called = CALL.match(line)
    if called is None:
        return ""
    words = called[2].partition("#")[0].split()
    path: Words = ("up",) if called[1] == "aos-up" else ()
    while words and (*path, words[0]) in options:
        path = (*path, words.pop(0))
    if not path and words and words[0][0].islower():
        return words[0]
    end = next((n for n, word in enumerate(words) if word in ("&&", "|")), None)
    named = (word.partition("=")[0].rstrip(".,;)") for word in words[:end] if word.startswith("--"))
    return next((name for name in named if path and name not in options[path]), "")


@pytest.fixture(scope="module")
def options() -> Options:
    root = typer.main.get_command(aos_app())
    assert isinstance(root, TyperGroup)
    found: dict[Words, set[str]] = {}
    for path, name in options_of(root):
        found.setdefault(path, set()).add(name)
    return {path: frozenset(names) for path, names in found.items()}


def typed() -> list[tuple[str, str]]:
    return [
        (page.name, (found[1] or found[2]).strip())
        for page in PAGES
        for found in TYPED.finditer(page.read_text(encoding="utf-8"))
    ]


def test_each_command_and_option_of_a_page_is_there(options: Options):
    lines = typed()
    assert sum(CALL.match(line) is not None for _, line in lines) > 250
    wrong = [(page, line) for page, line in lines if unknown_in(line, options)]
    assert wrong == []


def test_each_module_and_target_of_a_page_is_there():
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    wrong = []
    for page, line in typed():
        for module in re.findall(r"python -m (tests[\w.]*)", line):
            place = ROOT / module.replace(".", "/")
            if not place.with_suffix(".py").exists() and not (place / "__main__.py").exists():
                wrong.append((page, module))
        target = re.fullmatch(r"make ([a-z-]+)", line)
        if target is not None and target[1] not in targets:
            wrong.append((page, line))
    assert wrong == []


@pytest.mark.parametrize(
    ("line", "unknown"),
    [
        ("aos lint BUNDLE --no-compile", ""),
        ("aos lnt BUNDLE", "lnt"),
        (".venv/bin/aos bundle push DIR --fast", "--fast"),
        ("aos-up FILE --models", "--models"),
        ("aos mission start --set target=bob --belief keep   # --with a comment", ""),
    ],
)
def test_what_is_not_there_is_found(options: Options, line, unknown):
    assert unknown_in(line, options) == unknown
