import sys
from pathlib import Path

import jinja2
import pytest
from jinja2 import Environment

from aos_language.templates import templates_in


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    (tmp_path / "greeting.jinja").write_text("Hello {{ name }}\n")
    return tmp_path


def greeting(folder: Path) -> str:
    return templates_in(folder).get_template("greeting.jinja").render(name="robot")


def forbid_compiling(monkeypatch: pytest.MonkeyPatch):
    def refuse(*_: object):
        raise AssertionError("a template is compiled")

    monkeypatch.setattr(Environment, "_parse", refuse)


def test_what_was_compiled_is_used_by_the_next_process(folder: Path, monkeypatch):
    assert greeting(folder) == "Hello robot\n"
    (kept,) = (folder / "__pycache__").iterdir()
    forbid_compiling(monkeypatch)
    assert greeting(folder) == "Hello robot\n"
    kept.unlink()
    with pytest.raises(AssertionError, match="is compiled"):
        greeting(folder)


def test_a_template_that_has_changed_is_compiled_anew(folder: Path):
    greeting(folder)
    (folder / "greeting.jinja").write_text("Goodbye {{ name }}\n")
    assert greeting(folder) == "Goodbye robot\n"


@pytest.mark.parametrize("broken", [b"", b"no bytecode", None])
def test_a_broken_file_is_made_anew(folder: Path, broken):
    greeting(folder)
    (kept,) = (folder / "__pycache__").iterdir()
    kept.write_bytes(kept.read_bytes()[:-9] if broken is None else broken)
    assert greeting(folder) == "Hello robot\n"


def test_where_nothing_can_be_written_templates_are_compiled_each_time(folder: Path):
    (folder / "__pycache__").write_text("no folder")
    assert greeting(folder) == "Hello robot\n"


def test_nothing_is_written_where_python_writes_nothing(folder: Path, monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert greeting(folder) == "Hello robot\n"
    assert not (folder / "__pycache__").exists()


def test_a_name_that_is_not_given_is_an_error(folder: Path):
    with pytest.raises(jinja2.UndefinedError):
        templates_in(folder).get_template("greeting.jinja").render()
