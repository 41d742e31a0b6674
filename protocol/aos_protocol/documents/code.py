"""Code in documents: text with its places, and the blocks that it stands in."""

from bisect import bisect_right
from functools import lru_cache
from itertools import accumulate

import msgspec

from aos_protocol.diagnostics import Span


@lru_cache(maxsize=256)
def _line_starts(text: str) -> tuple[int, ...]:
    return tuple(accumulate((len(line) + 1 for line in text.split("\n")), initial=0))


def line_and_column(text: str, offset: int) -> tuple[int, int]:
    """The place of a character of a text, counted from 1."""
    starts = _line_starts(text)
    line = bisect_right(starts, offset)
    return line, offset - starts[line - 1] + 1


class Snippet(msgspec.Struct, frozen=True):
    """Code from a document, verbatim.

    `origins[i]` is the place in the document where line `i` of `code` starts, so that a compiler's or an
    interpreter's complaint comes back to the document whatever the dialect did to the text. `escapes` holds
    (line, column, width) of each character of `code` that takes `width` characters of its document, not 1.
    """

    code: str
    origins: tuple[Span, ...]
    escapes: tuple[tuple[int, int, int], ...] = ()

    @property
    def span(self) -> Span:
        """The place where the snippet starts."""
        return self.origins[0]

    def at(self, offset: int) -> Span:
        """The document place of a character of `code`."""
        return self.locate(*line_and_column(self.code, offset))

    def locate(self, line: int, column: int = 1) -> Span:
        """The document place of a line and column of `code`, both from 1; clamped to the snippet."""
        line = min(max(line, 1), len(self.origins))
        column = max(column, 1)
        origin = self.origins[line - 1]
        extra = sum(width - 1 for at, before, width in self.escapes if at == line and before < column)
        return Span(origin.file, origin.line, origin.column + column - 1 + extra)


class TemporaryVariable(msgspec.Struct, frozen=True):
    """A variable of a code block. For an enum, `enum_name` and `enum_values` declare its type on the spot."""

    name: str
    type: str
    span: Span
    enum_name: str = ""
    enum_values: tuple[str, ...] = ()


class Iteration(msgspec.Struct, frozen=True):
    """A loop over all state variables of compound type `type`: `body` runs where `condition` holds."""

    type: str
    item: str
    span: Span
    condition: Snippet | None = None
    body: Snippet | None = None


class Assignment(msgspec.Struct, frozen=True):
    """One block of model code. Order of effect: the temporary variable, the loops, then `code`.

    The loops of one tuple are nested; `over_previous` runs over `state`, `over_next` over the copy that the
    block writes.
    """

    span: Span
    name: str = ""
    temporary: TemporaryVariable | None = None
    over_previous: tuple[Iteration, ...] = ()
    over_next: tuple[Iteration, ...] = ()
    code: Snippet | None = None
