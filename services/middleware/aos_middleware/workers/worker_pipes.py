"""The pipes between a worker and its service, out of reach of its code, and the errors that code raises."""

import io
import os
import re
import sys
from types import CodeType, TracebackType
from typing import BinaryIO

from aos_middleware.workers.frames import Raised
from aos_protocol.spelling import column_of, error_text, sendable_text, shortened

_MAX_PRINTED_BYTES = 1024 * 1024


class _Printed(io.TextIOBase):
    """The output that mapping code prints: it goes to the error output at once, up to a limit, and never
    raises."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._remaining_bytes = _MAX_PRINTED_BYTES

    def writable(self) -> bool:
        return True

    def write(self, text: str) -> int:
        if self._remaining_bytes > 0:
            printed = text.encode(errors="backslashreplace")
            self._remaining_bytes -= len(printed)
            try:
                os.write(self._descriptor, printed)
                if self._remaining_bytes <= 0:
                    os.write(self._descriptor, b"\n(the rest is left out)\n")
            except OSError:
                self._remaining_bytes = 0
        return len(text)


def take_over_pipes(error_output: int) -> tuple[BinaryIO, BinaryIO]:
    """The pipes to the service, moved to where prints and reads of mapping code do not reach them."""
    questions = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    sys.stdout = sys.stderr = _Printed(error_output)
    return questions, answers


_MAX_ERROR_CHARACTERS = 2000
_NAME = re.compile(r"(?<![\w.])[^\W\d]\w*")


class NoTruthValue(TypeError):
    """A condition that is neither True nor False; `code` is that of its function."""

    def __init__(self, message: str, code: CodeType) -> None:
        super().__init__(message)
        self.code = code


def raised(
    error: BaseException,
    file_name: str,
    lines: list[str],
    unset: tuple[str, ...] = (),
    local_variables: dict[str, str] | None = None,
) -> Raised:
    """Returns what an exception says, and where in the module it was: at the innermost of the module's
    frames.

    A TypeError has the values of the variables in its expression. Of the `unset` variables those are told
    that stand in it, else all.
    """
    failed = ""
    if isinstance(error, NoTruthValue):
        text, (line, column) = f"TypeError: {error}", _start(error.code, lines)
    else:
        text = error_text(error)
        line, column, failed = _place(error.__traceback__, file_name, lines)
    text = sendable_text(text[:_MAX_ERROR_CHARACTERS])
    named = set(_NAME.findall(failed))
    if isinstance(error, TypeError):
        values = (local_variables or {}).items()
        text += "".join(f"; {name} is {shortened(value, 60)}" for name, value in values if name in named)
    told = tuple(name for name in unset if name in named) or unset
    return Raised(text, line, column, told, local_variables or {})


def _place(trace: TracebackType | None, file_name: str, lines: list[str]) -> tuple[int, int, str]:
    """The line and the column, and the text of the expression up to the end of its line."""
    place = (0, 0, "")
    while trace is not None:
        code = trace.tb_frame.f_code
        if code.co_filename == file_name:
            line = trace.tb_lineno
            _, end_line, start, end = list(code.co_positions())[trace.tb_lasti // 2]
            text = lines[line - 1] if 0 < line <= len(lines) else ""
            failed = text.encode()[start or 0 : end if end_line == line else None]
            place = (line, column_of(text, start or 0), failed.decode(errors="ignore"))
        trace = trace.tb_next
    return place


def _start(code: CodeType, lines: list[str]) -> tuple[int, int]:
    """The place of the expression that a function returns: behind the word, or on the line below it."""
    numbers = [number for _, _, number in code.co_lines() if number is not None]
    line = min(number for number in numbers if number > code.co_firstlineno)
    text = lines[line - 1]
    return line, len(text) - len(text.lstrip().removeprefix("return ")) + 1
