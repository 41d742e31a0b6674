"""Names in messages: what was probably meant by one that does not exist, and what a terminal shows."""

import difflib
from collections.abc import Iterable
from pathlib import Path

_ALIKE = 0.65
"""The share of two names that has to be the same, from 0 to 1: of `itn` and `int` it is 0.67."""


_LONGEST_NAME = 200
_LONG_BEGINNING = 8


def nearest(name: str, known: Iterable[str]) -> str:
    """The known name that is most like `name`, else one that a long `name` begins, or nothing; letter case
    counts little."""
    by_lower = {candidate.lower(): candidate for candidate in reversed([*known])}
    lower = name[:_LONGEST_NAME].lower()
    close = difflib.get_close_matches(lower, by_lower, n=1, cutoff=_ALIKE)
    if not close and len(lower) >= _LONG_BEGINNING:
        close = [candidate for candidate in by_lower if candidate.startswith(lower)]
    return by_lower[close[0]] if close else ""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The hint that names the nearest known name; empty where none is near."""
    close = nearest(name, known)
    return f"Did you mean `{close}`?" if close else ""


def did_you_mean_path(path: Path) -> str:
    """The hint that names what a path that leads to nothing probably meant; empty where nothing is near."""
    try:
        beside = [entry.name for entry in path.parent.iterdir()]
    except OSError:
        return ""
    close = "" if path.name in beside else nearest(path.name, beside)
    return f"Did you mean `{path.parent / close}`?" if close else ""


def quoted(names: Iterable[str]) -> str:
    """Names for a message, in order: `a`, `b`."""
    return ", ".join(f"`{name}`" for name in names)


def printable(text: str) -> str:
    """The text for a terminal: what commands it is spelt out, and lines after the first are set in."""
    if text.isprintable():
        return text
    return "".join(map(_printable, text))


def _printable(character: str) -> str:
    if character.isprintable() or character == "\t":
        return character
    return "\n    " if character == "\n" else character.encode("unicode_escape").decode()


def column_of(line: str, byte_offset: int) -> int:
    """A column from 1 for an offset in UTF-8 bytes, as compilers and Python's own parser give it."""
    return len(line.encode()[:byte_offset].decode(errors="ignore")) + 1


def shortened(text: str, most: int) -> str:
    """The text; of a longer one its first `most` characters and the number of all."""
    return text if len(text) <= most else f"{text[:most]}... ({len(text):,} characters)"


def error_text(error: BaseException) -> str:
    """The type of an exception and its text, also where making the text raises."""
    name = type(error).__name__
    try:
        text = str(error)
    except BaseException as failure:
        text = f"(its text raised {type(failure).__name__})"
    return f"{name}: {text}" if text else name


def sendable_text(text: str) -> str:
    """The text; half of a surrogate pair, as in the name of a file that is no UTF-8, is escaped."""
    return text.encode(errors="backslashreplace").decode()
