"""Document code in the emitted file: each piece in its place, with what leads back from the lines."""

import re

import msgspec
from msgspec.structs import replace

from aos_protocol.diagnostics import Span
from aos_solver.emission.program import Piece

MODEL_FILE = "model.cpp"
"""The name that the emitted file has for itself in its #line directives."""

MARK, END = "\ue000", "\ue001"
_PLACE = re.compile(f"{MARK}(\\d+){END}")
_MAX_COLUMNS = 110
_COMMA = re.compile(r'"(?:[^"\\]|\\.)*"|(, )')
"""Text in quotes, or a comma outside of quotes."""
_NOTE = re.compile(r"\s*aos::blame::at\(\d+\);")
_PLAIN_VALUE = re.compile(r"[\w.+-]*")


class Origin(msgspec.Struct, frozen=True):
    """Document code in a line of the emitted file: from character `column` on stands a line of a piece."""

    column: int
    length: int
    piece: int
    line: int


def put_code(text: str, pieces: tuple[Piece, ...]) -> tuple[str, dict[int, tuple[Origin, ...]]]:
    """The file with the pieces in their places, and where each line of a piece went."""
    lines = _Lines()
    for line in text.split("\n"):
        places = [pieces[int(number) - 1] for number in _PLACE.findall(line)]
        if not places:
            lines.add(line)
        elif _PLACE.fullmatch(line.strip()) or any(_needs_lines(piece) for piece in places):
            _put_block(lines, _PLACE.split(line), pieces)
        else:
            _put_inline(lines, _PLACE.split(line), pieces)
    return "\n".join(lines.lines), lines.origins


class _Lines:
    """The file as it grows. `_note` stands before the next line of document code, on that line."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.origins: dict[int, tuple[Origin, ...]] = {}
        self._is_in_document = False
        self._next: tuple[str, int] = ("", 0)
        self._note = ""

    def add(self, line: str) -> None:
        """A line of ours. A note of what runs next does not part document code from document code."""
        if self._is_in_document:
            if _NOTE.fullmatch(line) and not self._note:
                self._note = f"{line.strip()} "
                return
            self.lines.append(f'#line {len(self.lines) + 2} "{MODEL_FILE}"')
            self._is_in_document = False
        self.lines += [*([self._note] if self._note else []), *_wrapped(line)]
        self._note = ""

    def add_code(self, line: str, span: Span, origins: tuple[Origin, ...]) -> None:
        """A line with document code, of which `span` is the document line."""
        if not self._is_in_document or self._next != (span.file, span.line):
            self.lines.append(f"#line {span.line} {string_literal(span.file)}")
        code = line.lstrip()
        shift = len(self._note)
        self.lines.append(f"{line[: len(line) - len(code)]}{self._note}{code}".rstrip())
        self.origins[len(self.lines)] = tuple(
            replace(origin, column=origin.column + shift) for origin in origins
        )
        self._is_in_document = True
        self._next = (span.file, span.line + 1)
        self._note = ""

    def add_plain(self, line: str, origins: tuple[Origin, ...]) -> None:
        """A line of ours that shows a plain value from a document."""
        self.add("")
        self.lines[-1] = line  # Whole, since its columns lead back to the document.
        self.origins[len(self.lines)] = origins


def _wrapped(line: str) -> list[str]:
    """A line of ours as lines of at most `_MAX_COLUMNS`, where its commas allow that."""
    lines: list[str] = []
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    while len(line) > _MAX_COLUMNS and not line.lstrip().startswith(("//", "#")):
        commas = [found.end() for found in _COMMA.finditer(line) if found[1] and found.end() <= _MAX_COLUMNS]
        if not commas:
            break
        lines.append(line[: commas[-1]].rstrip())
        line = indent + line[commas[-1] :]
    return [*lines, line]


def _needs_lines(piece: Piece) -> bool:
    return "\n" in piece.text or "//" in piece.text


def _put_block(lines: _Lines, parts: list[str], pieces: tuple[Piece, ...]) -> None:
    """Every piece on lines of its own, indented; the code around it on lines before and after."""
    indent = " " * (len(parts[0]) - len(parts[0].lstrip())) if parts[0].strip() else parts[0]
    for index, part in enumerate(parts):
        if index % 2 == 0:
            if part.strip():
                lines.add(part)
            continue
        piece = pieces[int(part) - 1]
        before = "" if _has_long_literals(piece) else indent
        for number, text in enumerate(piece.text.split("\n"), 1):
            origin = Origin(len(before) + 1, len(text), piece.number, number)
            lines.add_code(before + text, piece.snippet.locate(number), (origin,))


def _has_long_literals(piece: Piece) -> bool:
    """Returns whether a literal may go over lines, whose blanks would then belong to it."""
    return 'R"' in piece.text or "\\\n" in piece.text


def _put_inline(lines: _Lines, parts: list[str], pieces: tuple[Piece, ...]) -> None:
    line = ""
    origins: list[Origin] = []
    for index, part in enumerate(parts):
        if index % 2 == 1:
            piece = pieces[int(part) - 1]
            text = piece.text.strip()
            lead = len(piece.text) - len(piece.text.lstrip())
            origins.append(Origin(len(line) + 1 - lead, lead + len(text), piece.number, 1))
            line += text
        else:
            line += part
    first = pieces[origins[0].piece - 1]
    if all(_PLAIN_VALUE.fullmatch(pieces[o.piece - 1].text.strip()) for o in origins):
        lines.add_plain(line, tuple(origins))
    else:
        lines.add_code(line, first.snippet.locate(1), tuple(origins))


def string_literal(text: str) -> str:
    """A C++ string literal of the UTF-8 bytes of `text`."""
    pieces = []
    for byte in text.encode():
        character = chr(byte)
        if character in '"\\?':
            pieces.append("\\" + character)
        else:
            pieces.append(character if 32 <= byte < 127 else f"\\{byte:03o}")
    return f'"{"".join(pieces)}"'
