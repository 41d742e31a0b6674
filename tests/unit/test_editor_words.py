import json
import re
import shutil
from typing import Any

import pytest
from commands import aos
from places import BUNDLES

from aos_editor.checking import check_folder
from aos_editor.documents import meaning_at, outline, proposals_at


def test_a_part_is_explained_as_part_of_its_section():
    text = "project: p\nstate_variable: int n\ncode:\nstate.n = 1;\n"
    found = meaning_at("p.ef", text, 3, 2)
    assert found[0] == "code:"
    assert "at the start" in found[1]
    assert meaning_at("p.ef", text, 4, 7) is None


def test_what_lies_beside_the_documents_is_told_at_none_of_them(tmp_path):
    folder = tmp_path / "armadillo"
    shutil.copytree(BUNDLES / "armadillo-finer", folder)
    (folder / "runs").mkdir()
    (folder / "up.yaml").write_text("aos: 1\n")
    checked = check_folder(folder, {"navigate.sd": (folder / "navigate.sd").read_text()})
    assert [found for _, findings in checked.values() for found in findings if found.code == "AOS107"] == []


def test_built_ins_are_completed_within_code():
    text = "project: p\ndynamic_model:\nbool x = AOS.B\n"
    (proposal,) = proposals_at("x.sd", text, 3, 14)
    assert (proposal.text, proposal.replaced) == ("AOS.Bernoulli", 5)


def test_the_open_sections_parts_are_proposed_before_the_sections():
    text = "project: p\n\ndefine_type: Side\n\n"
    labels = [proposal.label for proposal in proposals_at("p.ef", text, 4, 0)]
    assert labels[:2] == ["variable:", "enum_members:"]
    assert "reward_code:" in labels


def test_the_outline_ends_each_section_before_the_next():
    entries = outline("p.ef", "project: p\n\ndefine_type: Side\nenum_members: A\n\nhorizon: 3\n")
    assert [(entry.title, entry.line, entry.last_line) for entry in entries] == [
        ("p", 1, 2),
        ("Side", 3, 5),
        ("3", 6, 7),
    ]


def test_files_that_are_no_sdl_have_no_words():
    assert meaning_at("x.json", "{}", 1, 0) is None
    assert proposals_at("x.json", "{}", 1, 0) == []
    assert outline("x.json", "{}") == ()


@pytest.fixture(scope="module")
def colours() -> dict[str, Any]:
    grammar: dict[str, Any] = json.loads(aos("language-server", "--grammar").stdout)
    return grammar


def rule_at(rules: list[dict[str, Any]], line: str) -> dict[str, Any]:
    return next(rule for rule in rules if re.search(rule.get("begin", rule.get("match", "")), line))


@pytest.mark.parametrize(
    ("section", "part", "scope"),
    [
        ("dynamic_model:", None, "meta.embedded.cpp"),
        ("  reward_code: state.n = 1;", None, "meta.embedded.cpp"),
        ("code:", None, "meta.embedded.cpp"),
        ("local_variable: depth", "code:", "meta.embedded.python"),
        ("response: taken", "response_rule: success", "meta.embedded.python"),
        ("module_activation: skill", "path: /take", None),
        ("project: fetch", None, None),
    ],
)
def test_a_grammar_for_editors_knows_which_language_a_section_holds(
    colours: dict[str, Any], section, part, scope
):
    rule = rule_at(colours["patterns"], section)
    if part is not None:
        assert not re.search(rule["end"], part), "the section goes on with its part"
        rule = rule_at(rule["patterns"], part)
    assert rule.get("contentName") == scope
    if "end" in rule:
        assert re.search(rule["end"], "version: 2.0")
        assert not re.search(rule["end"], "project::f();")
