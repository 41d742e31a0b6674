import pytest
from lint_texts import ENVIRONMENT, MAPPING, SKILL, found
from test_reading_rules import JSON
from texts import encoded

from aos_language.follow_ups import told_once
from aos_language.load import load_files
from aos_protocol.diagnostics import Diagnostic, Severity, Span

TEXTS = {"environment": ENVIRONMENT, "skill": SKILL, "mapping": MAPPING}
SENSES = MAPPING.replace(
    "response_rule: True", "response_rule: far_m > 2\nresponse: stayed\nresponse_rule: True"
)
SENSES += """
local_variable: far_m
from_ros_service_response: true
code:
far_m = __input.far
"""
TWO_RESPONSES = {
    "mapping": SENSES,
    "skill": SKILL.replace("= walked", "= AOS.Bernoulli(0.5) ? walked : stayed"),
}


def told(*changes: tuple[str, str, str], texts: dict[str, str] = TEXTS) -> list[str]:
    changed = TEXTS | texts
    for document, before, after in changes:
        assert before in changed[document]
        changed[document] = changed[document].replace(before, after, 1)
    findings = told_once(found(**changed))
    return [f"{one.span.file}:{one.span.line} {one.code} {one.hint}".rstrip() for one in findings]


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (
            ("mapping", "from_ros_service_response: true\n", ""),
            "walk.am:16 AOS105 Take it from a skill parameter (`action_parameter:`), ",
        ),
        (("mapping", "far_m = __input.far\n", ""), "walk.am:16 AOS105"),
        (("mapping", "code:\nfar_m", "far_m"), "walk.am:18 AOS104"),
        (("mapping", "parameter: steps\ncode:\n", "parameter: steps\n"), "walk.am:10 AOS104"),
        (("mapping", "module_activation: skill\n", ""), "walk.am:7 AOS102"),
        (("mapping", "response: walked\n", ""), "walk.am:2 AOS102"),
        (("mapping", "response: stayed\n", "response: stayed\n" * 2), "walk.am:4 AOS105"),
        (("skill", "dynamic_model:\n", ""), "walk.sd:8 AOS104"),
        (("skill", "= AOS.Bernoulli(0.5)", "AOS.Bernoulli(0.5))"), "walk.sd:10 AOS108"),
        (("environment", "__reward = 10", "__reard = 10"), "hall.ef:23 AOS110"),
        (("environment", "state_variable: Cell second\n", ""), "hall.ef:8 AOS103"),
        (("environment", "project: hall", "project: hal"), "hall.ef:1 AOS113"),
        (("environment", "reward_code:", "reward code:"), "hall.ef:22 AOS102 Did you mean `reward_code:`?"),
        (("environment", "action_parameter: int near\n", ""), "hall.ef:12 AOS103"),
        (("environment", "define_type: Cell\n", ""), "hall.ef:4 AOS102"),
        (("environment", "variable: int x 0", "variable: int y 0"), "hall.ef:9 AOS110"),
    ],
)
def test_a_mistake_is_told_without_what_follows_from_it(change, place):
    texts = TWO_RESPONSES
    (only,) = told(change, texts=texts)
    assert only.startswith(place)


def test_what_code_says_by_itself_is_told_beside_an_error_of_another_line():
    code = "__reward = 1/2;\n__reward += state.thrid + 1/2;\n"
    changed = told(("skill", "state__.second", f"{code}state__.second"))
    assert [one.split()[:2] for one in changed] == [["walk.sd:9", "AOS149"], ["walk.sd:10", "AOS110"]]


def test_a_name_that_nothing_declares_is_told_once_with_its_places():
    (only,) = told(("environment", "state_variable: Cell second", "state_variable: Cell secnd"))
    assert only.startswith("hall.ef:13 AOS110")
    assert only.endswith("Also: line 23, walk.sd:9")


def test_text_without_its_section_is_told_once_however_many_pieces_it_has():
    (only,) = told(("skill", "dynamic_model:\n", "a line\n// It walks.\n"))
    assert only == "walk.sd:8 AOS104 Also: line 10"


def test_mistakes_that_have_nothing_to_do_with_each_other_are_told_together():
    codes = told(
        ("environment", "horizon: 4", "horizon: ten"),
        ("skill", "state.first.x > 0", "state.third.y > 0"),
        ("mapping", "from_ros_service_response: true\n", ""),
        texts=TWO_RESPONSES,
    )
    assert [one.split()[1] for one in codes] == ["AOS106", "AOS105", "AOS110"]
    codes = told(
        ("environment", "state.first.x", "state.third.x"),
        ("mapping", "code:\nfar_m", "far_m"),
        texts=TWO_RESPONSES,
    )
    assert [one.split()[1] for one in codes] == ["AOS110", "AOS104"]


def test_what_a_compiler_says_of_one_line_or_one_name_is_told_once():
    def said(line: int, column: int, message: str) -> Diagnostic:
        return Diagnostic(Severity.ERROR, "AOS201", message, Span("walk.sd", line, column))

    first, name = said(20, 4, "expected `(` before `AOS`"), said(40, 1, "`far` was not declared")
    found = told_once(
        (first, said(20, 9, "`in` was not declared"), name, said(41, 1, "`far` was not declared"))
    )
    assert [(one.span.line, one.hint) for one in found] == [(20, ""), (40, "Also: line 41")]


@pytest.mark.parametrize("name", ["at", "door", "closed"])
def test_a_variable_of_a_json_document_that_lacks_its_name_is_one_error(name):
    nameless = JSON["room.json"].replace(f'"Name": "{name}"', '"Name": ""', 1)
    (only,) = told_once(load_files(encoded(JSON | {"room.json": nameless})).diagnostics)
    assert (only.span.file, only.code) == ("room.json", "AOS105")
