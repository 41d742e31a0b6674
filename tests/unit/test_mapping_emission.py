import ast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mapping_documents import emitted, mapping_of, skill_of
from mapping_runs import HEAD, emitted_with
from msgspec.structs import replace
from places import BUNDLES, ROOT
from projects import bundle_project

from aos_language.findings import Findings
from aos_language.load import load_files, read_bundle_files
from aos_language.reading.files import read_documents
from aos_middleware.emission.emit import emit_mapping
from aos_middleware.mappings.revisions import emit_project
from aos_protocol.diagnostics import Span
from aos_protocol.documents import (
    AbstractionMapping,
    ActivationField,
    Import,
    LowLevelConstant,
    LowLevelDocument,
    LowLevelType,
    Parameter,
    Snippet,
)
from aos_protocol.errors import DocumentError


def mistakes(text: str) -> list[tuple[str, str]]:
    with pytest.raises(DocumentError) as refusal:
        emitted(text)
    assert refusal.value.code == "AOS121"
    return [(str(finding.span), finding.message) for finding in refusal.value.diagnostics]


def refusal_of(mapping: AbstractionMapping) -> DocumentError:
    with pytest.raises(DocumentError) as refusal:
        emit_mapping(replace(skill_of(HEAD), mapping=mapping))
    return refusal.value


def test_a_mapping_without_rules_has_the_default_observation():
    assert 'return "DefaultObservation"' in emitted(HEAD).python


def test_a_response_variable_is_answered_as_text_whatever_the_rules_say():
    python = emitted_with("""\
local_variable: board
from_ros_service_response: true
code:
board = __input.state
response_local_variable: board
""").python
    assert "return None if board is None else str(board)" in python


def test_indentation_inside_a_text_is_left_alone():
    python = emitted_with("""\
local_variable: word
topic: /log
message_type: Log
code:
\tknown = '''one
  two'''
\tif __input.text in known:
\t\treturn __input.text
""").python
    lines = python[python.index("def word_from_topic(") :].splitlines()
    assert lines[2:5] == ["    known = '''one", "  two'''", "    if __input.text in known:"]


def test_an_import_stands_in_for_what_is_not_installed():
    python = emitted(HEAD.replace("path:", "imports: from: geometry_msgs.msg import: Point\npath:")).python
    assert "    from geometry_msgs.msg import Point\nexcept ImportError:\n" in python
    assert '    Point = stand_in("Point", "geometry_msgs.msg")' in python


def test_what_an_unknown_star_import_has_to_bring_is_what_the_code_calls():
    python = emitted(
        HEAD.replace("path:", "imports: from: robot.srv import: *\npath:")
        + "parameter: goal\ncode:\nGoal(x=float(x), y=str(len(y)))\n"
    ).python
    assert 'if "Goal" not in globals():\n    Goal = stand_in("Goal", "robot.srv")' in python
    assert python.count("stand_in(") == 1


def test_low_level_constants_are_left_out_where_no_parameter_can_bring_one():
    span = Span("environment.json", 3, 1)
    low_level = LowLevelDocument(
        "garden",
        span,
        (LowLevelType("Place", (Parameter("x", "float", span),), span),),
        (LowLevelConstant("___door", "Place", Snippet("___door.x = 1.0", (span,)), span),),
    )
    with_parameter = HEAD + "local_variable: place\naction_parameter: goal.place\n"
    assert "___door = Place()\n___door.x = 1.0\n" in emitted(with_parameter, low_level).python
    assert "___door" not in emitted(HEAD, low_level).python


def test_document_text_never_becomes_template_or_comment_source():
    text = HEAD + "parameter: a\ncode:\n'{{ 7 * 7 }} {% raw %}'\n"
    skill = skill_of(text)
    activation = replace(skill.mapping.activation, path='x"""\nimport os')
    mapping = replace(skill.mapping, project="p\nimport os", activation=activation)
    python = emit_mapping(replace(skill, mapping=mapping)).python
    assert "'{{ 7 * 7 }} {% raw %}'" in python
    assert "\nimport os" not in python


# --- places ---


def test_each_line_of_a_snippet_knows_its_line_in_a_text_document():
    project = bundle_project(BUNDLES / "armadillo-finer")
    mapping = next(generated for generated in emit_project(project) if generated.skill == "observe_holding")
    source = (BUNDLES / "armadillo-finer" / "observe_holding.am").read_text().splitlines()
    lines = mapping.python.splitlines()
    generated = lines.index("    return min(__input.left_force_n, __input.right_force_n)")
    span = mapping.locate(generated + 1, lines[generated].index("min") + 1)
    assert span.file == "observe_holding.am"
    assert source[span.line - 1][span.column - 1 :].startswith("min(__input.left_force_n")


def kettle(old: bytes, new: bytes) -> dict[str, bytes]:
    files = read_bundle_files(ROOT / "docs" / "examples" / "kettle-json")[0]
    assert old in files[GLUE]
    return files | {GLUE: files[GLUE].replace(old, new)}


GLUE = "pour glue.json"


def test_each_line_of_a_snippet_knows_its_line_and_column_in_a_json_document():
    files = kettle(b"(success or", rb"(success\n    or")
    (mapping,) = emit_project(load_files(files).project)
    source, lines = files[GLUE].decode().splitlines(), mapping.python.splitlines()
    for code in ("grams > 150", "return True", "(success", "or __skill_status", "handle.x,"):
        generated = next(index for index, line in enumerate(lines) if code in line)
        span = mapping.locate(generated + 1, lines[generated].index(code) + 1)
        assert source[span.line - 1][span.column - 1 :].startswith(code.rstrip(","))


def test_generated_lines_stand_for_the_document_part_that_made_them():
    mapping = emitted_with("local_variable: level\naction_parameter: tank.level\n")
    line = mapping.python.splitlines().index('        "level": parameters["tank"]["level"],') + 1
    assert str(mapping.locate(line)).startswith("look.am:4")


def test_a_line_that_no_document_part_made_stands_for_the_mapping():
    mapping = emitted(HEAD)
    assert mapping.locate(1) == mapping.locate(10_000) == mapping.mapping.span


# --- mistakes ---


def test_every_mistake_of_a_mapping_is_found_in_one_run():
    found = mistakes(
        HEAD
        + """\
parameter: a
code:
1 +
response: full
response_rule: level >
local_variable: level
topic: /level
message_type: Level
initial_value: (1
code:
if __input.x:
return 3
"""
    )
    assert [place.rsplit(":", 1)[0] for place, _ in found] == [f"look.am:{line}" for line in (6, 8, 12, 15)]


def test_a_mistake_in_a_json_document_is_found_at_its_line_and_column():
    files = kettle(b"is_full and (", b"is_full and and (")
    (mistake,) = refusal_of(read_documents(files, Findings())[GLUE].content).diagnostics
    source = files[GLUE].decode().splitlines()
    assert source[mistake.span.line - 1][mistake.span.column - 1 :].startswith("and (")


def test_what_only_shows_in_the_whole_module_is_found_too():
    found = mistakes(
        HEAD
        + """\
local_variable: level
topic: /level
message_type: Level
code:
global level
level = 1
"""
    )
    assert found == [("look.am:8:1", "this is not valid Python: name 'level' is parameter and global")]


@pytest.mark.parametrize("code", ["yield 1", "x = [(yield)]", "return 1) + (2", "def f(:"])
def test_code_that_is_no_function_body_is_refused(code):
    assert mistakes(HEAD + f"local_variable: level\ntopic: /level\nmessage_type: Level\ncode:\n{code}\n")


@pytest.mark.parametrize("code", ["a = 1", "1)(", "print(1); print(2)", "yield", "x for x in", "\u0000"])
def test_what_is_no_expression_is_refused(code):
    mapping = mapping_of(HEAD)
    field = ActivationField("a", Snippet(code, (Span("look.am", 6, 1),)))
    refusal = refusal_of(replace(mapping, activation=replace(mapping.activation, fields=(field,))))
    assert [finding.code for finding in refusal.diagnostics] == ["AOS121"]


def test_names_that_would_break_the_module_are_refused():
    mapping = mapping_of(HEAD + "local_variable: level\naction_parameter: level\n")
    (variable,) = mapping.local_variables
    for name in ("class", "__input", "parameters", "a b", "x\n"):
        refusal = refusal_of(replace(mapping, local_variables=(replace(variable, name=name),)))
        assert refusal.diagnostics[0].code == "AOS126"


def test_an_import_that_is_none_is_refused():
    mapping = mapping_of(HEAD)
    for module, name in (("os; import sys", "x"), ("os", "x\nimport sys"), ("", "1")):
        bad = Import(module, (name,), Span("look.am", 2, 1))
        refusal = refusal_of(replace(mapping, activation=replace(mapping.activation, imports=(bad,))))
        assert [finding.span for finding in refusal.diagnostics] == [bad.span]


BRACKETS = ["(", ")", "[", "]", "{", "}", '"""', "#", ",", ":", "=", "\\"]
BLANKS = ["\n", "\n    ", "\t", " ", "\r", "\x0c"]
WORDS = ["x", "1", "'a'", "é", "if x", "return", "yield", "lambda: 0", "def f()", "global x", "__input"]
CODE = st.lists(st.sampled_from([*BRACKETS, *BLANKS, *WORDS]), max_size=12).map("".join)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(CODE, CODE)
def test_any_text_is_either_refused_or_becomes_a_module_with_a_place_for_each_line(
    expression: str, body: str
):
    mapping = mapping_of(HEAD + "local_variable: x\ntopic: /t\nmessage_type: T\ncode:\npass\n")

    def snippet(code: str) -> Snippet:
        return Snippet(code, tuple(Span("look.am", line + 1, 1) for line in range(code.count("\n") + 1)))

    field = ActivationField("a", snippet(expression))
    variable = replace(mapping.local_variables[0], code=snippet(body))
    mapping = replace(
        mapping, activation=replace(mapping.activation, fields=(field,)), local_variables=(variable,)
    )
    try:
        emission = emit_mapping(replace(skill_of(HEAD), mapping=mapping))
    except DocumentError as error:
        places = [finding.span.file for finding in error.diagnostics]
    else:
        places = [emission.locate(line).file for line in range(1, emission.python.count("\n") + 2)]
        assert len(places) == len(emission.origins)
        functions = [
            statement
            for statement in ast.parse(emission.python).body
            if isinstance(statement, ast.FunctionDef)
        ]
        assert [function.name for function in functions] == [
            "local_variables",
            "request",
            "x_from_topic",
            "observe",
        ]
    assert set(places) == {"look.am"}
