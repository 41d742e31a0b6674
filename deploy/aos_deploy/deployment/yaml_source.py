"""A YAML file as plain values that know their place in it.

Only what a configuration needs: mappings with text keys, lists, scalars. A key given twice, anchors, aliases,
tags, characters that no text shows and numbers beyond 64 bits are findings, not features.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import msgspec
from ruamel.yaml import YAML
from ruamel.yaml.composer import MaxDepthExceededError
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from ruamel.yaml.reader import ReaderError

from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.spelling import did_you_mean_path

MAX_BYTES = 1_000_000
MAX_DEPTH = 32
_LONGEST_NUMBER = 100
_INTEGERS = range(-(2**63), 2**63)
_LARGE = 2**31 - 1


class YamlScalar(msgspec.Struct, frozen=True):
    """A number, text, bool or None. `style` is the sign that its text begins with, empty for plain text."""

    value: int | float | bool | str | None
    span: Span
    style: str = ""

    @property
    def is_block(self) -> bool:
        """True if its text begins in the line below."""
        return self.style in ("|", ">")

    @property
    def text_span(self) -> Span:
        """The place where its text begins: of one in quotes, behind the first."""
        quote = len(self.style) if not self.is_block else 0
        return Span(self.span.file, self.span.line, self.span.column + quote)


class YamlList(msgspec.Struct, frozen=True):
    items: tuple[YamlNode, ...]
    span: Span


class YamlMap(msgspec.Struct, frozen=True):
    """`keys` holds where each key stands."""

    entries: dict[str, YamlNode]
    keys: dict[str, Span]
    span: Span


YamlNode = YamlScalar | YamlList | YamlMap

_NO_TEXT = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters, those that turn the direction of writing, and halves of a character."""
_NO_KEY = re.compile(rf"{_NO_TEXT.pattern}|[\t\n\r\u2028\u2029]")


def read_yaml(path: Path, file: str) -> tuple[YamlMap | None, Findings]:
    """The mapping a file holds, None if it cannot be read as one. `file` names it in the findings."""
    findings = Findings()
    try:
        with path.open("rb") as source:
            data = source.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            findings.error("AOS104", f"the file has more than {MAX_BYTES} bytes", Span(file))
            return None, findings
        text = data.decode("utf-8")
    except OSError as error:
        findings.error(
            "AOS101", f"the file cannot be read: {error.strerror}", Span(file), did_you_mean_path(path)
        )
        return None, findings
    except UnicodeDecodeError as error:
        findings.error("AOS101", f"the file is not UTF-8 text (byte {error.start})", Span(file))
        return None, findings
    findings.add_source(file, text.splitlines())
    yaml = YAML(typ="safe", pure=True)
    yaml.max_depth = MAX_DEPTH
    try:
        root = yaml.compose(text)
    except MaxDepthExceededError as error:
        where = _span(file, error.problem_mark)
        findings.error("AOS104", f"nested in more than {MAX_DEPTH} lists and mappings", where)
        return None, findings
    except ReaderError as error:
        where = Span(file, text.count("\n", 0, error.position) + 1)
        findings.error("AOS104", f"a text cannot have the character U+{error.character:04X}", where)
        return None, findings
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = _span(file, mark) if mark else Span(file)
        context = f" {error.context}" if error.context else ""
        findings.error("AOS104", f"not well-formed YAML{context}: {error.problem}", where)
        return None, findings
    except (YAMLError, RecursionError, ValueError) as error:
        findings.error("AOS104", f"not well-formed YAML: {error}", Span(file))
        return None, findings
    if not isinstance(root, MappingNode):
        told = "this file is empty" if root is None else "not a mapping of keys to values"
        findings.error("AOS104", told, Span(file, 1))
        return None, findings
    return _Reader(file, findings).map(root), findings


class _Reader:
    """Nodes to plain values with their places."""

    def __init__(self, file: str, findings: Findings) -> None:
        self._file = file
        self._findings = findings
        self._met: set[int] = set()
        """The ids of the nodes that have been read: an alias leads to one again, or into itself."""

    def map(self, node: MappingNode) -> YamlMap:
        entries: dict[str, YamlNode] = {}
        keys: dict[str, Span] = {}
        for key_node, value_node in node.value:
            where = self._place(key_node)
            if not isinstance(key_node, ScalarNode):
                self._findings.error("AOS104", "a key is not a text", where)
                continue
            key = self._text(str(key_node.value), where, _NO_KEY)
            if key in entries:
                hint = f"First in line {keys[key].line}"
                self._findings.error("AOS103", f"the key {key} is given twice", where, hint)
                continue
            keys[key] = where
            entries[key] = self._node(value_node)
        return YamlMap(entries, keys, self._place(node))

    def _node(self, node: Node) -> YamlNode:
        where = self._place(node)
        if node.anchor:
            self._findings.error("AOS104", "anchors and aliases are not used here", where)
        if id(node) in self._met:
            return YamlScalar(None, where)
        self._met.add(id(node))
        if isinstance(node, MappingNode):
            return self.map(node)
        if isinstance(node, SequenceNode):
            return YamlList(tuple(self._node(item) for item in node.value), where)
        style = str(getattr(node, "style", "") or "")
        return self._scalar(str(node.value), str(node.tag), where, style)

    def _scalar(self, text: str, tag: str, where: Span, style: str) -> YamlScalar:
        match tag.rpartition(":")[2]:
            case "str":
                return YamlScalar(self._text(text, where, _NO_TEXT), where, style)
            case "null":
                return YamlScalar(None, where)
            case "bool":
                return YamlScalar(text.lower() == "true", where)
            case "int" | "float":
                return YamlScalar(self._number(text, where), where)
        self._findings.error("AOS104", f"the tag {tag} is not used here", where)
        return YamlScalar(None, where)

    def _text(self, text: str, where: Span, unwanted: re.Pattern[str]) -> str:
        """The text; a finding where it has a character that nothing is named by."""
        if found := unwanted.search(text):
            self._findings.error("AOS104", f"a text cannot have the character U+{ord(found[0]):04X}", where)
        return unwanted.sub("\ufffd", text)

    def _number(self, text: str, where: Span) -> int | float | str:
        number = _number(text) if len(text) <= _LONGEST_NUMBER else _INTEGERS.stop
        if isinstance(number, int) and number not in _INTEGERS:
            self._findings.error("AOS104", "the number is beyond 64 bits", where)
            return _LARGE if number > 0 else -_LARGE  # Nobody is told twice.
        return number

    def _place(self, node: Node) -> Span:
        return _span(self._file, node.start_mark)


def _span(file: str, mark: Any) -> Span:
    """The place of a position mark of the YAML reader."""
    return Span(file, mark.line + 1, mark.column + 1)


def _number(text: str) -> int | float | str:
    """The number; the text itself where YAML sees a number that Python does not."""
    plain = text.replace("_", "").replace(".inf", "inf").replace(".Inf", "inf").replace(".nan", "nan")
    for convert in (lambda: int(plain, 0), lambda: int(plain), lambda: float(plain)):
        try:
            return convert()
        except ValueError:
            continue
    return text
