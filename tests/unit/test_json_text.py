import json
import string

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from json_values import plain

from aos_language.findings import Findings
from aos_language.reading.json_text import JsonArray, JsonString, JsonValue, code_snippet, parse_json
from aos_language.reading.source import Source
from aos_protocol.diagnostics import Diagnostic


def parsed(text: str) -> tuple[JsonValue | None, tuple[Diagnostic, ...]]:
    findings = Findings()
    source = Source("a.json", text)
    findings.add_source(source.name, source.lines)
    return parse_json(source, findings), findings.sorted()


VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**15), 10**15)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0")),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(string.ascii_letters), inner),
    max_leaves=20,
)


@settings(max_examples=150, deadline=None)
@given(VALUES, st.booleans())
def test_whatever_is_json_reads_as_the_standard_library_reads_it(value: object, ascii_only: bool):
    text = json.dumps(value, ensure_ascii=ascii_only, indent=1)
    result, findings = parsed(text)
    assert findings == ()
    assert plain(result) == value


@settings(max_examples=200, deadline=None)
@given(st.text(alphabet='{}[]",:\\/*truefalsn0123.eE-+ \n'))
def test_any_text_gives_a_value_or_an_error(text: str):
    result, findings = parsed(text)
    assert (result is None) == any(finding.code == "AOS104" and finding.is_error for finding in findings) or (
        result is not None
    )


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ('{"a": }', "1:7", "expected a value, found '}'"),
        ('{"a" 1}', "1:6", 'expected ":" after "a", found \'1\''),
        ('{"a": 1', "1:1", 'this "{" is never closed'),
        ('{"a":\n [1, 2', "2:2", 'this "[" is never closed'),
        ('{\n "a": {\n "a": {\n  "b": 1\n },\n "c": 2\n}\n', "2:7", 'this "{" is never closed'),
        ('{\n "a": [\n "a": [\n 1\n ]\n}\n', "3:5", 'expected "," or "]", found \':\''),
        ('{"a": "x\n"}', "1:7", "this string is not closed on its line"),
        ('{"a": "x\\q"}', "1:9", "no such escape in JSON"),
        ('{"a": "\\ud800"}', "1:8", "half of a surrogate pair"),
        ('{"a": "\\u0000"}', "1:8", "a NUL character"),
        ("{'a': 1}", "1:2", 'expected a key in double quotes, found "\'"'),
        ('{"a": 01}', "1:7", "expected a value, found '0'"),
        ('{"a": 1e999}', "1:7", "this number is too large"),
        ("{} {}", "1:4", "text after the end of the document"),
        ("[1 true]", "1:4", 'expected "," or "]", found \'true\''),
        ("/* open", "1:1", "this comment is never closed"),
        ("[" * 70, "1:66", "values nested deeper than 64"),
        ("", "1:1", "expected a value, found the end of the file"),
    ],
)
def test_what_cannot_be_read_is_said_with_its_place(text, place, message):
    result, (finding, *_) = parsed(text)
    assert result is None
    assert (str(finding.span), finding.message) == (f"a.json:{place}", message)


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ('[{"a": 1,\n {"b": 2}]', 'The "{" on line 1 is still open'),
        ('{"a": [\n1}', 'The "[" on line 1 is still open'),
        ('{"a": "x, "b": 1}', "A text ended before it: is a quote missing there?"),
    ],
)
def test_what_is_missing_before_that_place_is_told(text, hint):
    _, (finding,) = parsed(text)
    assert finding.hint.startswith(hint)


def test_a_forgotten_comma_does_not_stop_the_reader():
    result, (finding,) = parsed('{"a": 1\n "b": [1 2]}'.replace("1 2", "1, 2"))
    assert plain(result) == {"a": 1, "b": [1, 2]}
    assert (finding.message, str(finding.span)) == ("a comma is missing here", "a.json:1:8")


def test_the_first_of_two_equal_keys_counts_and_the_second_is_an_error():
    result, (finding,) = parsed('{"a": 1,\n "a": 2}')
    assert plain(result) == {"a": 1}
    assert (finding.code, str(finding.span)) == ("AOS103", "a.json:2:2")


def test_each_character_of_a_string_has_its_place():
    text = '["a\\"b\\u00e9c\\ud83d\\ude00d\\r"]'
    result, _ = parsed(text)
    assert isinstance(result, JsonArray)
    (value,) = result.items
    assert isinstance(value, JsonString)
    assert value.text == 'a"béc😀d\r'
    assert [text[value.offset_of(index)] for index in range(7)] == ["a", "\\", "b", "\\", "c", "\\", "d"]


def test_lines_of_code_come_from_where_they_stand_in_the_string():
    text = '["if (a)\\n\\tx = \\"y\\" + z;",\n "last"]'
    result, _ = parsed(text)
    assert isinstance(result, JsonArray)
    strings = tuple(item for item in result.items if isinstance(item, JsonString))
    snippet = code_snippet(Source("a.json", text), strings)
    assert snippet.code == 'if (a)\n\tx = "y" + z;\nlast'
    assert [str(origin) for origin in snippet.origins] == ["a.json:1:3", "a.json:1:11", "a.json:2:3"]
    column_of_z = snippet.code.split("\n")[1].index("z") + 1
    assert text[snippet.locate(2, column_of_z).column - 1] == "z"
