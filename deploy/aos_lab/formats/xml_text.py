"""XML elements that know where they stand."""

from __future__ import annotations

from collections.abc import Iterator
from xml.parsers import expat

from aos_lab.formats.problem_text import ProblemFindings, Word, words_of


class Element:
    """An element with its place; the text of its children does not belong to its own."""

    __slots__ = ("attributes", "children", "column", "line", "pieces", "tag")

    def __init__(self, tag: str, attributes: dict[str, str], line: int, column: int) -> None:
        self.tag = tag
        self.attributes = attributes
        self.line = line
        self.column = column
        self.children: list[Element] = []
        self.pieces: list[tuple[str, int, int]] = []

    def words(self) -> list[Word]:
        """The words of the text, each with its place."""
        return [word for piece in _joined(self.pieces) for word in words_of(*piece)]

    def all(self, tag: str) -> Iterator[Element]:
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        return next(self.all(tag), None)


def read_xml(data: bytes, findings: ProblemFindings) -> Element | None:
    """The outermost element; None, with a finding, where the text is no XML."""
    parser = expat.ParserCreate()
    # Tables come in pieces of a line otherwise, each with a call.
    parser.buffer_text = False
    open_elements: list[Element] = [Element("", {}, 1, 1)]

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)
        open_elements[-1].children.append(element)
        open_elements.append(element)

    def end(_: str) -> None:
        open_elements.pop()

    def text(piece: str) -> None:
        place = (parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)
        open_elements[-1].pieces.append((piece, *place))

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = text
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        message = f"this is not well-formed XML: {expat.ErrorString(error.code)}"
        last = open_elements[-1]
        hint = f"<{last.tag}> of line {last.line} is open here" if last.tag else ""
        findings.error("AOS104", message, Word("", error.lineno, error.offset + 1), hint)
        return None
    return open_elements[0].children[0]


def _joined(pieces: list[tuple[str, int, int]]) -> Iterator[tuple[str, int, int]]:
    """Pieces that follow one another as one: expat may cut within a word."""
    text, line, column = "", 0, 0
    for piece, piece_line, piece_column in pieces:
        if not text:
            line, column = piece_line, piece_column
        text += piece
        if piece == "\n":
            yield text, line, column
            text = ""
    if text:
        yield text, line, column
