"""The process in which a bundle's `picture.py` runs, once: `python -I -m` of this module.

It reads what is to be drawn from its input and writes the picture to its output, which the code that draws
does not reach: what that prints goes to the error output.
"""

import faulthandler
import os
import signal
import warnings
from typing import Any
from xml.etree import ElementTree

import msgspec

from aos_middleware.workers.worker_pipes import raised, take_over_pipes

FILE_NAME = "picture.py"
MOST_BYTES = 1024 * 1024
_SOFT_S = 1.0
"""The code is interrupted after so much processor time, so that its line can be told."""
_PNG = b"\x89PNG\r\n\x1a\n"
_SVG = "{http://www.w3.org/2000/svg}svg"


class Subject(msgspec.Struct, frozen=True):
    """The code that draws, and what it is to draw."""

    source: str
    state: dict[str, Any]
    belief: dict[str, dict[str, float]]
    step: dict[str, Any]


class Drawn(msgspec.Struct, frozen=True, tag=True):
    """A picture: a PNG, or where it `is_svg` an SVG."""

    data: bytes
    is_svg: bool


class TooSlow(BaseException):
    """The code has had its time."""


class NotDrawn(msgspec.Struct, frozen=True, tag=True):
    """The reason why there is no picture, and the line and column of `picture.py` where it has one, else
    0."""

    error: str
    line: int = 0
    column: int = 0


def main() -> None:
    """Draws once."""
    error_output = os.dup(2)
    questions, answers = take_over_pipes(error_output)
    faulthandler.enable(file=error_output)
    signal.signal(signal.SIGPROF, _interrupt)
    subject = msgspec.msgpack.decode(questions.read(), type=Subject)
    answers.write(msgspec.msgpack.encode(_drawn(subject)))
    answers.flush()


def _interrupt(*_: object) -> None:
    raise TooSlow(f"it took more than {_SOFT_S:g} s of processor time")


def _drawn(subject: Subject) -> Drawn | NotDrawn:
    namespace: dict[str, Any] = {"__name__": "picture"}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SyntaxWarning)
            signal.setitimer(signal.ITIMER_PROF, _SOFT_S)
            exec(compile(subject.source, FILE_NAME, "exec", dont_inherit=True), namespace)
        result = namespace["draw"](subject.state, subject.belief, subject.step)
        signal.setitimer(signal.ITIMER_PROF, 0)
        picture = _picture_of(result)
    except BaseException as error:
        signal.setitimer(signal.ITIMER_PROF, 0)
        if isinstance(error, KeyError) and "draw" not in namespace:
            return NotDrawn("there is no function draw")
        if isinstance(error, SyntaxError) and error.filename == FILE_NAME:
            return NotDrawn(f"no valid Python: {error.msg}", error.lineno or 0, error.offset or 0)
        found = raised(error, FILE_NAME, subject.source.split("\n"))
        said = str(error) if isinstance(error, TooSlow) else found.error
        return NotDrawn(said, found.line, found.column)
    return picture


def _picture_of(result: Any) -> Drawn | NotDrawn:
    if isinstance(result, str):
        data = result.encode("utf-8", "replace")
        try:
            root = ElementTree.fromstring(data)
        except ElementTree.ParseError as error:
            return NotDrawn(f"draw has returned text that is no SVG: {error}")
        if root.tag != _SVG:
            return NotDrawn(
                'draw has returned no SVG: its root is not <svg xmlns="http://www.w3.org/2000/svg">'
            )
        is_svg = True
    elif isinstance(result, bytes | bytearray) and bytes(result[:8]) == _PNG:
        data, is_svg = bytes(result), False
    else:
        kind = type(result).__name__
        return NotDrawn(f"draw has returned {kind}, and neither an SVG as text nor a PNG as bytes")
    if len(data) > MOST_BYTES:
        return NotDrawn(f"the picture has {len(data):,} bytes, and may have {MOST_BYTES:,}")
    return Drawn(data, is_svg)


if __name__ == "__main__":
    main()
