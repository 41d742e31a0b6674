"""A model that tells of every statement that it runs, to find the one where another build of it failed.

A model that is in use tells only which piece of document code runs, since a step is a few statements and
one more store for each is not free. Statements are counted on from the pieces.
"""

import re

import msgspec
from msgspec.structs import replace

from aos_language.cpp.statements import Marks, Statement, marked
from aos_protocol.diagnostics import Span
from aos_solver.emission.emit import EmittedModel
from aos_solver.emission.program import Piece

_RESULTS = ("__reward", "__moduleResponse")
"""The reward is looked at first, so it has to be the last that tells of itself when the section is over."""


_STATE = re.compile(r"\b(state_{0,3})\s*(?:\.|->)\s*(\w+)")


class TracedModel(msgspec.Struct, frozen=True):
    """`emitted.snippets` are the pieces' places and after them those of the statements.

    `pieces[n - 1]` is the number of the piece that place number n is in.
    """

    emitted: EmittedModel
    pieces: tuple[int, ...]

    def may_be_in(self, place: int, piece: int) -> bool:
        """Returns whether a place is in the piece, or in a function that it may call."""
        return (
            self.pieces[place - 1] == piece or self.emitted.pieces[self.pieces[place - 1] - 1].is_declarations
        )

    def has_later_statements(self, piece: int) -> bool:
        """Returns whether a statement that runs with the piece stands on another line than the piece's
        first."""
        if any(other.is_declarations for other in self.emitted.pieces):
            return True
        first = self.emitted.snippets[piece - 1]
        places = zip(self.pieces, self.emitted.snippets, strict=True)
        return any(number == piece and span.line != first.line for number, span in places)


def traced(emitted: EmittedModel) -> TracedModel:
    """The model with a mark at every statement of document code; the lines stay."""
    lines = emitted.cpp.split("\n")
    lines[0] = '#include "aos/model/trace.hpp"'  # in place of a comment
    spans = list(emitted.snippets)
    pieces = list(range(1, len(spans) + 1))
    for piece in emitted.pieces:
        tracing = _Tracing(piece, len(spans))
        text = None
        if piece.is_declarations or piece.is_statements:
            text = marked(piece.text, tracing.marks, are_declarations=piece.is_declarations)
        if text is None:
            continue
        spans += tracing.spans.values()
        pieces += [piece.number] * len(tracing.spans)
        text = f"{tracing.start}{text}"
        note = f"aos::blame::at({piece.number}); "
        for number, line in enumerate(text.split("\n"), 1):
            at = _line_of(piece, number, emitted)
            lines[at] = f"{note}{line}" if lines[at].lstrip().startswith(note.rstrip()) else line
    return TracedModel(replace(emitted, cpp="\n".join(lines), snippets=tuple(spans)), tuple(pieces))


class _Tracing:
    def __init__(self, piece: Piece, places: int) -> None:
        self._piece = piece
        self._places = places
        self._given = [name for name in _RESULTS if _sets(piece.text, name)]
        self.spans: dict[tuple[int, int], Span] = {}
        self.marks = Marks(before=self._before, after=self._after, inside="aos::blame::Inside aos_inside;")

    @property
    def start(self) -> str:
        """The code before the first statement; the names are the piece's own, since sections have several."""
        givers = "".join(f"aos::blame::Giving {self._giver(name)}{{{name}}}; " for name in self._given)
        return f"{self._showing}{givers}"

    @property
    def _showing(self) -> str:
        """The code that tells the state if the piece does not end: the copies and variables that it names."""
        named: dict[str, list[str]] = {}
        for copy, variable in _STATE.findall(self._piece.text):
            named.setdefault(copy, []).append(variable)
        if not named or self._piece.is_declarations:
            return ""  # Of shared functions the caller's state is told.
        copies = ", ".join(f'{{"{copy}", {copy}, {{{_shown(named[copy])}}}}}' for copy in sorted(named))
        return f"aos::blame::Showing aos_showing_{self._piece.number}{{{{{copies}}}}}; "

    def _before(self, statement: Statement) -> str:
        return f"aos::blame::statement({self._place(statement)})"

    def _after(self, statement: Statement) -> str:
        given = [name for name in self._given if _sets(statement.text, name)]
        return " ".join(f"{self._giver(name)}.by({self._place(statement)});" for name in given)

    def _giver(self, name: str) -> str:
        return f"aos_{name.strip('_')}_by_{self._piece.number}"

    def _place(self, statement: Statement) -> int:
        key = (statement.line, statement.column)
        self.spans.setdefault(key, self._piece.locate(*key))
        return self._places + 1 + list(self.spans).index(key)


def _shown(variables: list[str]) -> str:
    """The variables' names as C++ lists them; none, which stands for all, where objects are gone through."""
    if any(name.endswith("Objects") for name in variables):
        return ""
    return ", ".join(f'"{name}"' for name in dict.fromkeys(variables))


def _sets(code: str, name: str) -> bool:
    return re.search(rf"\b{name}\s*([-+*/]?=(?!=))", code) is not None


def _line_of(piece: Piece, number: int, emitted: EmittedModel) -> int:
    """The index of the emitted file's line that is a line of the piece."""
    return next(
        line - 1
        for line, origins in emitted.origins.items()
        if origins[0].piece == piece.number and origins[0].line == number
    )
