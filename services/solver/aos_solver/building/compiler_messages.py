"""The compiler's messages as diagnostics at the documents' places."""

import math
import re

import msgspec

from aos_language.reading.sdl_words import GRAMMARS
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.spelling import did_you_mean
from aos_solver.building.message_hints import hint_for, in_words, told_of_a_map
from aos_solver.emission.emit import EmittedModel

_PLACE = re.compile(
    r"(?P<file>[^\s:][^:]*):(?P<line>\d+):(?:(?P<column>\d+):)?\s+"
    r"(?P<kind>fatal error|error|Error|warning|note|required)\b:?\s*(?P<text>.*)"
)
"""The places of g++, clang and the assembler behind g++, which tells no column and writes `Error`."""
_ANOTHER_ENUM = re.compile(r"deleted .*(?:Named<.*operator\[\]|operator `\[\]`)")
"""g++ and clang say this of the one deleted operator that documents can meet, see named_array.hpp."""
_NOT_DECLARED = re.compile(r"`([A-Za-z_]\w*)` was not declared|use of undeclared identifier `([A-Za-z_]\w*)`")
_UNKNOWN = re.compile(
    r"(?:use of undeclared identifier )?`([A-Za-z_]\w*)`(?: (?:was not|has not been) declared|$)"
)
_OF_PYTHON = {"True": "true", "False": "false", "None": "nullptr", "elif": "else if", "pass": ";"}
_OF_PYTHON |= {"TRUE": "true", "FALSE": "false", "null": "nullptr"}
_OF_PYTHON |= {"Float": "double", "len": "values.size()", "str": "std::string"}
_OF_PYTHON |= {"AND": "&&", "OR": "||", "in": ":", "is": "=="}
_OF_STATEMENTS = {"auto", "break", "case", "const", "continue", "default", "return", "switch", "while"}
_A_TEXT = re.compile(
    r"`const char ?(?:\*|\[\d+\])`.*`(?!const char)|`(?!const char)[\w ]+`.*`const char ?(?:\*|\[\d+\])`"
)
"""A text meets another type: a number, an enum's value, a response."""
_WITHIN = re.compile(
    r"(?:\b\w+::)?\b\w+<aos::[^>]*>\((?:[^()]|\([^()]*\))*\)(?: const)?::"
    r"|(?:\w+ )?\w+\([^()]*\bauto:\d+[^()]*\)::| \[with .*?\](?=')"
)
"""The function of ours in which a struct or a lambda of a document's code stands, and the types it is for."""
_OF_STREAMS = re.compile(r".*`std::(\w+)` from `std::ios_base&.*")
"""A name without an enum is found in C++'s library: `left`, `right`, `fixed`, `internal` and their like."""
_SUFFIX = re.compile(
    r"unable to find numeric literal operator `operator\"\"\s*(\w+)`.*|invalid suffix [`\"](\w+)[`\"] on .*"
)
_BOUND = re.compile(r"binding reference of type `(.+?)&?` to (?:value of type )?`const .*")
_OF_STD = re.compile(r"`std::(\w+)` has not been declared")
"""g++ says this of a parameter, too, where an argument of its type is unknown."""
_CONSEQUENCES = re.compile(
    r"<expression error>|cannot be set to a list in braces|and these are others"
    r"|void value not ignored"
    rf"|template argument \d+ is invalid|no match for call to `\(<lambda|{_OF_STD.pattern}"
)
"""Said too where a name within was not declared."""
_POINTER = re.compile(r"request for member `(\w+)` in `(.+?)`, which is of pointer type .*")
_POINTER_TYPE = re.compile(r"member reference base type `(.+ ?\*)` is not a structure or union")
"""Clang tells no more of a pointer in place of a value."""
_PRIVATE = re.compile(
    r"`.*?(\w+::\w+)(?:\(.*\))?(?: const)?` is private within.*|`(\w+)` is a private member of .*"
)
_NO_SEMICOLON = "Is a semicolon missing at the end of the line above?"
_NO_BRACKET = "A condition stands in brackets: `if (...)`"
_CUTTING = (_NO_SEMICOLON, _NO_BRACKET, "C++ writes `:`")
"""The advice on errors at which g++ loses its place in the statement."""
_LOST = re.compile(r"expected `}` before|use of `\w+` before deduction")
_FAULTS = ("error", "fatal error", "Error")
_ENDLESS = re.compile(r"expected .*`;`.* before .*")
"""g++ tells a missing semicolon where it reads on, and skips what comes before the next one."""
_NO_VALUE = re.compile(r"expected (?:primary-)?expression\b.*")
_OPERATOR = re.compile(r"[^\w\s;{})\]\"'`]+(?=\s*$)")


class CompilerReport(msgspec.Struct, frozen=True):
    """Errors at document places, and the lines about code that no document gave."""

    diagnostics: tuple[Diagnostic, ...]
    outside: tuple[str, ...]


class _Message(msgspec.Struct):
    file: str
    line: int
    column: int
    text: str
    related: list[tuple[str, int, int]]


def without_line_directives(cpp: str) -> str:
    """The same lines with the #line directives as comments.

    The directives are for those who compile or debug the file themselves. Through them a compiler could not
    tell two lines of a JSON string apart, nor give columns; so our own builds map the file's places back.
    """
    return re.sub(r"^#line", "//ne", cpp, flags=re.MULTILINE)


def read_messages(output: str, source_name: str, emitted: EmittedModel) -> CompilerReport:
    """Reads the text that g++ and clang write, for the emitted file compiled as `source_name`."""
    diagnostics: list[Diagnostic] = []
    outside: list[str] = []
    lines = emitted.cpp.encode().split(b"\n")
    unread: set[str] = set()
    for message in _messages(output):
        places = [(message.file, message.line, message.column), *message.related]
        spans = (_document_place(place, source_name, emitted) for place in places)
        span = next((span for span in spans if span is not None), None)
        if span is None:
            outside.append(f"{message.file}:{message.line}:{message.column}: {message.text}")
            continue
        text, hint = _plain(message.text)
        unknown = _NOT_DECLARED.fullmatch(text)
        name = unknown[1] or unknown[2] if unknown is not None else ""
        if (parameter := _OF_STD.fullmatch(text)) is not None:
            unread.add(parameter[1])
        if name and message.file.endswith(source_name):
            unread.update(_declared_with(name, lines[message.line - 1][message.column - 1 :].decode()))
        if name in unread:
            continue  # Its declaration was not taken up.
        if _ENDLESS.fullmatch(text) and message.file.endswith(source_name):
            line, start = lines[message.line - 1], message.column - 1
            unread.update(re.findall(r"[A-Za-z_]\w*", line[start:].decode()))
            hint = "" if line[:start].strip() else _NO_SEMICOLON
            word = text.partition(" before `")[2].rstrip("`")
            hint = f"C++ writes `{_OF_PYTHON[word]}`" if word in _OF_PYTHON else hint
        if text.startswith("expected `(` before"):
            hint = _NO_BRACKET
        if _NO_VALUE.fullmatch(text) and message.file.endswith(source_name):
            before = lines[message.line - 1][: message.column - 1].decode("utf-8", "replace")
            text = next((f"a value is missing behind `{m[0]}`" for m in _OPERATOR.finditer(before)), text)
        diagnostics.append(Diagnostic(Severity.ERROR, "AOS201", text, span, _advice(name, hint, emitted)))
    return CompilerReport(
        tuple(_without_consequences(_without_repeats(diagnostics), emitted)), tuple(outside)
    )


def _declared_with(type_name: str, code: str) -> list[str]:
    """The name that code declares, which begins with the name of its type."""
    return re.findall(rf"^{type_name}(?:<.*?>)?[&*\s]+(\w+)\s*[=;{{]", code)


def _advice(name: str, hint: str, emitted: EmittedModel) -> str:
    """Returns what to write in place of an undeclared name; `hint` is what the message says itself."""
    if name in emitted.layout.shapes:
        return f"Did you mean `state.{name}`?"
    if hint and _may_be_meant(hint, emitted):
        return hint
    if "_" in name and any(name in words for words in GRAMMARS.values()):
        return f"A section begins with its word and a colon: `{name}:`"
    if name in _OF_PYTHON:
        return f"C++ writes `{_OF_PYTHON[name]}`"
    if name in emitted.names:
        return "It has to stand before its first use"
    return did_you_mean(name, sorted((emitted.names | _OF_STATEMENTS) - {name})) if name else ""


def _may_be_meant(hint: str, emitted: EmittedModel) -> bool:
    """Returns whether a document may name what the compiler suggests, which knows all of C's library."""
    suggested = re.fullmatch(r"Did you mean `(\w+)`\?", hint)
    if suggested is None or hasattr(math, suggested[1]):
        return True
    return re.search(rf"\b{suggested[1]}\b", emitted.cpp) is not None


def _without_consequences(diagnostics: list[Diagnostic], emitted: EmittedModel) -> list[Diagnostic]:
    """Leaves out names that the documents declare, where another document has a mistake of its own: the
    declaration may be what is wrong."""

    def is_declared(found: Diagnostic) -> bool:
        name = _UNKNOWN.match(found.message)
        return name is not None and name[1] in emitted.names

    causes = {found.span.file for found in diagnostics if not is_declared(found)}
    return [found for found in diagnostics if not is_declared(found) or not causes - {found.span.file}]


def _without_repeats(diagnostics: list[Diagnostic]) -> list[Diagnostic]:
    """Each complaint once for a line: a template is complained about for every use of it."""
    first: dict[tuple[str, int, str], Diagnostic] = {}
    cut = {f.span.file for f in diagnostics if f.hint in _CUTTING}
    bound = {(f.span.file, f.span.line) for f in diagnostics if f.message.endswith("this is only read")}
    named = {found.span for found in diagnostics if _NOT_DECLARED.fullmatch(found.message)}
    for diagnostic in diagnostics:
        if "std::ios_base" in diagnostic.message and diagnostic.span in named:
            continue  # Said of the same name.
        if diagnostic.span.file in cut and _LOST.match(diagnostic.message):
            continue
        if named and _CONSEQUENCES.search(diagnostic.message):
            continue  # It follows from another.
        line = (diagnostic.span.file, diagnostic.span.line)
        if diagnostic.message.startswith("no match for call") and line in bound:
            continue  # The argument is told.
        first.setdefault((*line, diagnostic.message), diagnostic)
    return list(first.values())


def _messages(output: str) -> list[_Message]:
    """Errors with the places that led to them, which g++ tells before an error, and clang after it."""
    messages: list[_Message] = []
    led_by: list[tuple[str, int, int]] = []
    for line in output.splitlines():
        match = _PLACE.match(line)
        if match is None:
            continue
        place = (match["file"], int(match["line"]), int(match["column"] or 1))
        if match["kind"] == "required":
            led_by.append(place)
        elif match["kind"] in _FAULTS:
            messages.append(_Message(*place, match["text"], led_by))
            led_by = []
        elif match["kind"] == "note" and messages:
            messages[-1].related.append(place)
    return messages


def _document_place(place: tuple[str, int, int], source_name: str, emitted: EmittedModel) -> Span | None:
    file, line, column = place
    return emitted.locate(line, column) if file.rsplit("/", 1)[-1] == source_name else None


def _plain(text: str) -> tuple[str, str]:
    """The message in the documents' terms, and the compiler's suggestion as a hint."""
    text = re.sub(r"\bmodel::(?:aos_skill_\w+::)?", "", text)
    text = re.sub(r"\.<lambda\([^)]*\)>(?=\()", "", _WITHIN.sub("", text))
    text = re.sub(r"\s*\[-[\w+=-]+\]$", "", text).replace("'", "`")
    text = re.sub(r"there are no arguments to (`[^`]+`) that depend on .*", r"\1 was not declared", text)
    text = re.sub(r"`\(lambda at [^)]*\)`", "a lambda", text)
    text = re.sub(r"^(`\w+`) has not been declared$", r"\1 was not declared", text)
    text = text.replace("was not declared in this scope", "was not declared").replace(
        "aos::AnySource::", "AOS."
    )
    if (of_a_map := told_of_a_map(text)) is not None:
        return of_a_map
    if _ANOTHER_ENUM.search(text):
        return (
            "this array is indexed by another enum",
            "Use a value of its own enum, or a number: `int(value)`",
        )
    if (pointer := _POINTER.fullmatch(text)) is not None:
        return f"`{pointer[2]}` is a pointer", f"Write `{pointer[2]}->{pointer[1]}`"
    if (pointer := _POINTER_TYPE.fullmatch(text)) is not None:
        return f"a value of type `{pointer[1]}` is a pointer", "Write `->` in place of `.`"
    if (private := _PRIVATE.fullmatch(text)) is not None:
        hint = "Write `struct` in place of `class`, or `public:` before it"
        return f"`{private[1] or private[2]}` is private", hint
    text, hint = in_words(text)
    if hint or "cannot be set to" in text:
        return text, hint
    if (suffix := _SUFFIX.fullmatch(text)) is not None:
        return (
            f"a number cannot have `{suffix[1] or suffix[2]}` behind it",
            "Write the number alone; a unit belongs into a name, as `size_ml`",
        )
    if (name := _OF_STREAMS.fullmatch(text)) is not None:
        return f"`{name[1]}` was not declared", ""
    if _A_TEXT.search(text):
        return text, "Numbers, values of enums and responses are written without quotes"
    if (bound := _BOUND.fullmatch(text)) is not None:
        return (
            f"`{bound[1]}&` may change what it is given, and this is only read",
            f"Write `const {bound[1]}&`, or give a copy of the state that may change here",
        )
    message, separator, suggestion = text.partition("; ")
    if separator and suggestion.startswith("did you mean"):
        return message, suggestion[0].upper() + suggestion[1:]
    return text, hint_for(text)
