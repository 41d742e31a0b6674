"""A picture of a state, drawn by a bundle's `picture.py` in a worker of its own, in the sandbox of mappings.

The worker is started for one picture and ends with it. Nothing that it does reaches whoever asks.
"""

import asyncio
import signal
import sys
from typing import Any

import msgspec

from aos_middleware.workers.evaluator import worker_confinement
from aos_middleware.workers.picture_worker import FILE_NAME, MOST_BYTES, Drawn, NotDrawn, Subject
from aos_protocol.codec import UNREADABLE
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.errors import DocumentError
from aos_protocol.messages import BeliefSummary
from aos_runtime.processes.children import PIPE, Child, Limits, guarded

__all__ = ["Drawn", "draw", "likeliest_state"]

_MOST_CPU_S = 2
_MOST_S = 15.0
_MEMORY_BYTES = 1024**3
_END_S = 2.0


async def draw(source: str, belief: BeliefSummary, step: dict[str, Any]) -> Drawn:
    """The picture of a belief's likeliest state at a step.

    DocumentError AOS148 where the code raises, takes more than 1 s of processor time or 15 s, or returns no
    picture; its diagnostic has the line.
    """
    subject = Subject(
        source, likeliest_state(belief), {each.variable: each.values for each in belief.marginals}, step
    )
    command = guarded(
        [sys.executable, "-I", "-m", "aos_middleware.workers.picture_worker"],
        Limits(address_space_bytes=_MEMORY_BYTES, cpu_s=_MOST_CPU_S, file_bytes=0),
        worker_confinement(),
    )
    child = await Child.start(
        command, name="picture", cwd="/", stdin=PIPE, stdout=PIPE, stderr=asyncio.subprocess.DEVNULL
    )
    try:
        async with asyncio.timeout(_MOST_S):
            found = await _answer(child, msgspec.msgpack.encode(subject))
    except TimeoutError:
        raise _fault(f"it took more than {_MOST_S:g} s and was stopped") from None
    finally:
        await child.stop()
        while await child.stdout.read(2**16):
            pass  # What is still in the pipe would keep it open.
    if isinstance(found, NotDrawn):
        raise _fault(found.error, found.line, found.column)
    return found


def likeliest_state(belief: BeliefSummary) -> dict[str, Any]:
    """Each variable's likeliest value: a bool or a number where the text is one, else the text.

    Of a number that has quantiles it is the median.
    """
    return {
        each.variable: each.quantiles[len(each.quantiles) // 2]
        if each.quantiles
        else _plain(max(each.values, key=each.values.__getitem__))
        for each in belief.marginals
        if each.values
    }


def _plain(text: str) -> Any:
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


async def _answer(child: Child, asked: bytes) -> Drawn | NotDrawn:
    try:
        child.stdin.write(asked)
        await child.stdin.drain()
    except (BrokenPipeError, ConnectionResetError):
        pass  # How it has ended says more.
    child.stdin.close()
    said = bytearray()
    while part := await child.stdout.read(2**16):
        said += part
        if len(said) > MOST_BYTES + 2**16:
            raise _fault(f"it has written more than {MOST_BYTES:,} bytes")
    try:
        return msgspec.msgpack.decode(bytes(said), type=Drawn | NotDrawn)
    except UNREADABLE:
        pass
    try:
        async with asyncio.timeout(_END_S):
            status = await child.wait()
    except TimeoutError:
        raise _fault("the code closed its worker's connection") from None
    if status in (-signal.SIGXCPU, -signal.SIGKILL, 128 + signal.SIGXCPU, 128 + signal.SIGKILL):
        raise _fault(
            f"it took more than {_MOST_CPU_S} s of processor time or too much memory, and was stopped"
        )
    how = f"by signal {-status}" if status < 0 else f"with status {status}"
    raise _fault(f"the code ended its process {how}")


def _fault(error: str, line: int = 0, column: int = 0) -> DocumentError:
    span = Span(FILE_NAME, max(line, 1), max(column, 1))
    diagnostic = Diagnostic(Severity.WARNING, "AOS148", error, span)
    return DocumentError(f"the state cannot be drawn: {error}", code="AOS148", diagnostics=(diagnostic,))
