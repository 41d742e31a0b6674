import re

import pytest
from places import ROOT
from projects import files_project
from scripted_models import scripted

from aos_language.convert import without_origins
from aos_language.load import load_files
from aos_language.reading.sdl_words import GRAMMARS

EXAMPLE = re.compile(r"^```sdl ([^\n]+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FOLDERS = {"json": "kettle-json", "ours": "kettle-sdl"}


def examples(dialect: str) -> dict[str, bytes]:
    if folder := FOLDERS.get(dialect):
        return {path.name: path.read_bytes() for path in (ROOT / "docs" / "examples" / folder).iterdir()}
    text = (ROOT / "docs" / "languages.md").read_text(encoding="utf-8")
    return {name: body.encode() for name, body in EXAMPLE.findall(text)}


def test_the_sdl_examples_make_a_bundle_without_findings():
    loaded = load_files(examples("sdl"))
    assert loaded.diagnostics == ()
    assert [skill.name for skill in loaded.project.skills] == ["heat", "pour"]


def test_the_json_examples_make_a_bundle_without_findings():
    loaded = load_files(examples("json"))
    assert loaded.diagnostics == ()
    assert loaded.project.low_level is not None


def test_the_page_names_every_word_of_sdl():
    text = (ROOT / "docs" / "languages.md").read_text(encoding="utf-8")
    words = {word for grammar in GRAMMARS.values() for word in grammar}
    words |= {part for grammar in GRAMMARS.values() for word in grammar.values() for part in word.parts}
    assert {word for word in words if word not in text} == set()


def test_sdl_with_our_words_says_what_the_json_examples_say():
    ours, json = (load_files(examples(dialect)) for dialect in ("ours", "json"))
    assert ours.diagnostics == ()
    assert without_origins(ours.project) == without_origins(json.project)


@pytest.mark.parametrize("dialect", ["sdl", "json"])
def test_the_examples_are_models_that_run(dialect):
    assert scripted(files_project(examples(dialect))).walk(1000)["steps"] == 1000
