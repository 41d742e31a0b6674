"""A JSON object read by key: typed values, with a finding for each that is missing, wrong or unread."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from difflib import get_close_matches
from functools import partial
from typing import TypeVar

from msgspec.structs import replace

from aos_language.findings import Findings
from aos_language.reading.json_text import (
    JsonArray,
    JsonConstant,
    JsonNumber,
    JsonObject,
    JsonString,
    JsonValue,
    code_snippet,
    describe,
)
from aos_language.reading.source import Source, Text, expression, without_blank_lines
from aos_protocol.diagnostics import Severity, Span
from aos_protocol.documents import Snippet
from aos_protocol.spelling import quoted

T = TypeVar("T")

_NEARLY = 0.85
"""A share of a key, from 0 to 1: with so much of one that others build on it is that one, mistyped."""
_STANDS_FOR = 0.4
"""Such a share where an object lacks the one: `ActionPath` is 0.48 of `ServicePath`."""
_BUILT_ON = frozenset({
    "AssignServiceFieldCode", "AssignmentCode", "Constants", "Default", "DefaultCode", "Discount",
    "DynamicModel", "EnumName", "EnumValues", "EnvironmentGeneral", "FromGlobalVariable",
    "FromROSServiceResponse", "FromStringLocalVariable", "GlobalVariableModuleParameters",
    "GlobalVariableTypes", "GlobalVariablesDeclaration", "Horizon", "Import", "InitCode",
    "InputLocalVariable", "IsActionParameterValue", "IsArray", "IsGoalState", "ItemName",
    "LocalVariableName", "LocalVariableTypes", "LocalVariablesInitialization", "ModuleActivation",
    "ModuleResponse", "Name", "NextStateAssignments", "Parameters", "Project", "Response", "ResponseRules",
    "Reward", "RosAction", "RosService", "RosTopicPath", "ServiceFieldName", "ServiceName",
    "ServiceParameters", "ServicePath", "SpecialStates", "StateConditionCode", "StateFunctionCode",
    "TempVar", "Type", "TypeName", "Value", "VarName", "VariableType", "Variables",
})  # fmt: skip
_HOMES = {
    "FromStringLocalVariable": "ModuleResponse",
    "GlobalVariablePreconditionAssignments": "Preconditions",
    "NextStateAssignments": "DynamicModel",
    "PlannerAssistancePreconditionsAssignments": "Preconditions",
    "ResponseRules": "ModuleResponse",
    "RosService": "ModuleActivation",
    "ServicePath": "RosService",
    "ViolatingPreconditionPenalty": "Preconditions",
}
"""The keys of objects that people forget, or close too early, each with the object's key."""
_IN_PLACE_OF_TEXT = {
    "a list": "A list stands in brackets, each of its texts in quotes",
    "a number": "A number stands without quotes",
    "true or false": "Write true or false, without quotes",
}
_BOOLEANS = {"true": True, "false": False}


class Record:
    """Every key that is asked for counts as known; `finish` reports the others.

    `what` names the object in messages: "a state variable".
    """

    def __init__(self, source: Source, value: JsonObject, what: str, findings: Findings) -> None:
        self.source = source
        self.findings = findings
        self.span = source.span(value.start)
        self.what = what
        self._members = {key.text: (key, item) for key, item in value.members}
        self._known: dict[str, None] = {}
        self._lacking: list[str] = []

    def __contains__(self, key: str) -> bool:
        return self._value(key) is not None

    @property
    def is_blank(self) -> bool:
        """True where nothing in it says anything: a form that was left empty."""
        return all(_is_blank(value) for _, value in self._members.values())

    @property
    def has_unread_text(self) -> bool:
        """True where a key that nobody has asked for has text, or lines."""
        unread = (item for name, (_, item) in self._members.items() if name not in self._known)
        lines = (item.items if isinstance(item, JsonArray) else (item,) for item in unread)
        return any(isinstance(line, JsonString) and line.text.strip() for each in lines for line in each)

    def has(self, key: str) -> bool:
        """Returns whether the key is there, whatever its value."""
        self._ask(key)
        return key in self._members

    def is_text(self, key: str) -> bool:
        """Returns whether the key's value is a string."""
        return isinstance(self._value(key), JsonString)

    def is_code(self, key: str) -> bool:
        """Returns whether the key's value is text or lines that say more than true or false."""
        value = self._value(key)
        return isinstance(value, JsonArray) or (
            isinstance(value, JsonString) and value.text.strip().lower() not in _BOOLEANS
        )

    def key_span(self, key: str) -> Span:
        """Returns the place of the key; that of the object where the key is missing."""
        member = self._members.get(key)
        return self.source.span(member[0].start) if member else self.span

    def ignore(self, *keys: str) -> None:
        """Keys that have a meaning for people or other programs only."""
        self._known.update(dict.fromkeys(keys))

    def obsolete(self, key: str, reason: str) -> None:
        """A key that is understood and has no effect."""
        self._known[key] = None
        if key in self._members:
            self.findings.warning("AOS102", f'"{key}" has no effect', self.key_span(key), reason)

    def lack(self, *keys: str) -> None:
        """Notes that one of these keys is needed, and none is there."""
        self._lacking += keys

    def finish(self) -> None:
        """Reports the keys that nobody asked for: as errors where one may stand for a key that is lacking."""
        for name, (key, _) in self._members.items():
            if name in self._known:
                continue
            message, span = f'unknown key "{name}" in {self.what}', self.source.span(key.start + 1)
            home = f"It belongs in `{_HOMES[name]}`" if name in _HOMES else ""
            if self._lacking:
                near = get_close_matches(name, self._lacking, 1, _STANDS_FOR)
                hint = f"Did you mean `{near[0]}`?" if near else f"Missing here: {quoted(self._lacking)}"
                self.findings.error("AOS102", message, span, home or hint)
            elif home:
                self.findings.warning("AOS102", message, span, f"{home}. Here it is ignored")
            else:
                unknown = partial(self.findings.unknown, code="AOS102", severity=Severity.WARNING)
                unknown(name, self._known, message, span, "It is ignored")

    # --- scalars ---

    def text(self, key: str, *, required: bool = False) -> Text | None:
        """A string without the blanks around it; None, and a finding if required, where there is none."""
        value = self._read(key, required, "text", lambda v: v if isinstance(v, JsonString) else None)
        if value is None:
            return None
        lead = len(value.text) - len(value.text.lstrip())
        text = Text(value.text.strip(), self.source.span(value.offset_of(lead)))
        if required and not text.text:
            self.findings.error("AOS105", f'"{key}" of {self.what} is empty', text.span)
            return None
        return text

    def number(self, key: str, *, required: bool = False) -> float | None:
        """A number, with or without decimals."""
        value = self._read(key, required, "a number", lambda v: v if isinstance(v, JsonNumber) else None)
        return None if value is None else float(value.value)

    def integer(self, key: str, *, required: bool = False) -> int | None:
        number = self.number(key, required=required)
        if number is None:
            return None
        if number != int(number):
            self.findings.error("AOS106", f'"{key}" must be an integer', self.value_span(key))
            return None
        return int(number)

    def boolean(self, key: str, *, default: bool = False) -> bool:
        """true or false; as text too, with a warning."""
        value = self._value(key)
        if isinstance(value, JsonString) and value.text.strip().lower() in _BOOLEANS:
            message, span = f'"{key}" is given as text', self.value_span(key)
            self.findings.warning("AOS127", message, span, _IN_PLACE_OF_TEXT["true or false"])
            return _BOOLEANS[value.text.strip().lower()]
        found = self._read(key, False, "true or false", _boolean)
        return default if found is None else found

    def value_span(self, key: str) -> Span:
        """Returns the place of a key's value; that of the object where the key is missing."""
        member = self._members.get(key)
        if member is None:
            return self.span
        inside = 1 if isinstance(member[1], JsonString) else 0
        return self.source.span(member[1].start + inside)

    # --- code ---

    def code(self, key: str) -> Snippet | None:
        """Code as one string or as a list of lines; None where there is none or it is blank."""
        value = self._value(key)
        strings: tuple[JsonString, ...] = ()
        if isinstance(value, JsonString):
            strings = (value,)
        elif isinstance(value, JsonArray):
            strings = tuple(item for item in value.items if isinstance(item, JsonString))
            for item in value.items:
                if not isinstance(item, JsonString):
                    self._wrong(f'a line of "{key}"', "text", item)
        elif value is not None:
            self._wrong(f'"{key}"', "text or a list of lines", value)
        if not any(string.text.strip() for string in strings):
            return None
        return without_blank_lines(code_snippet(self.source, strings))

    def expression(self, key: str) -> Snippet | None:
        """One C++ expression; a number, true or false stands for itself, a final semicolon is dropped."""
        if (literal := self._literal(key)) is not None:
            return replace(literal, code=literal.code.lower())
        snippet = self.code(key)
        if snippet is None:
            return None
        short = expression(snippet, drop_semicolon=True)
        return short if short.code else None

    def python_expression(self, key: str) -> Snippet | None:
        """One Python expression; a number, true or false stands for itself."""
        if (literal := self._literal(key)) is not None:
            return literal
        snippet = self.code(key)
        return None if snippet is None else expression(snippet)

    def _literal(self, key: str) -> Snippet | None:
        """A value that should be code and is no text, as Python writes it."""
        value = self._value(key)
        if not isinstance(value, JsonNumber | JsonConstant):
            return None
        span = self.source.span(value.start)
        self.findings.warning("AOS127", f'"{key}" should be text', span, "Put it in double quotes")
        return Snippet(str(value.value), (span,))

    # --- composites ---

    def record(self, key: str, what: str, *, required: bool = False) -> Record | None:
        """An object within this one."""
        value = self._read(key, required, "an object", lambda v: v if isinstance(v, JsonObject) else None)
        return None if value is None else Record(self.source, value, what, self.findings)

    def records(self, key: str, what: str, form: str = "") -> Iterator[Record]:
        """The objects of a list; anything else is reported, with the `form` that is meant, and left out."""
        value = self._value(key)
        if form and value is not None and not isinstance(value, JsonArray):
            self._wrong(f'"{key}"', "a list", value, f"Write `[{form}]`")
            return
        for item in self._items(key):
            if isinstance(item, JsonObject):
                yield Record(self.source, item, what, self.findings)
            else:
                self._wrong(f'an item of "{key}"', "an object", item, f"Write `{form}`" if form else "")

    def texts(self, key: str) -> list[Text]:
        """The strings of a list, without the blanks around them; those of a single text, with an error."""
        if isinstance(value := self._value(key), JsonString):
            self._wrong(f'"{key}"', "a list", value)
            return [Text(part.strip(), self.source.span(value.start)) for part in value.text.split(",")]
        texts = []
        for item in self._items(key):
            if isinstance(item, JsonString):
                texts.append(Text(item.text, self.source.span(item.start + 1)).strip())
            else:
                self._wrong(f'an item of "{key}"', "text", item)
        return texts

    def _items(self, key: str) -> tuple[JsonValue, ...]:
        found = self._read(key, False, "a list", lambda v: v if isinstance(v, JsonArray) else None)
        return found.items if found is not None else ()

    # --- common ---

    def _ask(self, key: str) -> None:
        """Takes a key as known. One that others build on is read where it is mistyped too: that is one
        mistake."""
        self._known[key] = None
        if key in self._members or key not in _BUILT_ON:
            return
        unknown = [name for name in self._members if name not in self._known and name not in _BUILT_ON]
        for name in get_close_matches(key, unknown, 1, _NEARLY):
            self._members[key] = self._members.pop(name)
            message = f'unknown key "{name}" in {self.what}'
            span = self.source.span(self._members[key][0].start + 1)
            self.findings.unknown(name, (key,), message, span, code="AOS102")

    def _value(self, key: str) -> JsonValue | None:
        """The value of a key; null counts as absent."""
        self._ask(key)
        member = self._members.get(key)
        if member is None or (isinstance(member[1], JsonConstant) and member[1].value is None):
            return None
        return member[1]

    def _read(
        self, key: str, required: bool, expected: str, accept: Callable[[JsonValue], T | None]
    ) -> T | None:
        value = self._value(key)
        if value is None:
            if required:
                self.findings.error("AOS105", f'{self.what} lacks "{key}"', self.span)
                self.lack(key)
            return None
        accepted = accept(value)
        if accepted is None:
            self._wrong(f'"{key}"', expected, value)
        return accepted

    def _wrong(self, what: str, expected: str, value: JsonValue, hint: str = "") -> None:
        message = f"{what} must be {expected}, not {describe(value)}"
        if not hint and isinstance(value, JsonString):
            hint = _IN_PLACE_OF_TEXT.get(expected, "")
        self.findings.error("AOS106", message, self.source.span(value.start), hint)


def _boolean(value: JsonValue) -> bool | None:
    return value.value if isinstance(value, JsonConstant) else None


def _is_blank(value: JsonValue) -> bool:
    match value:
        case JsonString():
            return not value.text.strip()
        case JsonArray():
            return all(map(_is_blank, value.items))
        case JsonObject():
            return all(_is_blank(item) for _, item in value.members)
        case JsonNumber():
            return False
    return value.value is None
