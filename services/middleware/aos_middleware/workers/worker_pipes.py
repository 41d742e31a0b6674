"""The pipes between a worker and its service, out of reach of the code that the worker runs."""

import io
import os
import sys
from typing import BinaryIO

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
