"""The search for the statement that failed: a build of the model that tells of every statement runs again
what failed.

A running model tells only the piece of document code that runs. After a fault the model is built once more,
traced and without optimisation, and asked the same from the same belief. If that goes well, random actions
are tried. A fault that does not come again stays where it was told.
"""

import asyncio
import logging
import re
from collections import deque
from collections.abc import Coroutine, Sequence
from typing import Any, TypeVar

import msgspec
from msgspec.structs import replace

from aos_protocol.diagnostics import Span
from aos_protocol.errors import AosError, CodeFaultError, EndlessCodeError, ModelError, error_from_code
from aos_solver.building.build import BuiltModel, build
from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.child.lines.command_line import command_line
from aos_solver.child.process.engine_child import HANG_PERIODS, EngineChild, EngineStart
from aos_solver.emission.trace import TracedModel, traced

log = logging.getLogger(__name__)

A = TypeVar("A")

REPLAY_DEADLINE_S = 12.0
_HANG_PERIODS = 4
"""An endless loop is known to be one: it runs again for its statement alone."""
_RANDOM_ACTIONS_S = 2.0
_SAMPLE_PERIOD_S = 0.02
_LAST_SAMPLES = 20


async def at_its_statement(
    fault: AosError, built: BuiltModel, start: EngineStart, commands: Sequence[str]
) -> AosError:
    """The fault at the document place of its statement, or as it is if that cannot be found.

    `commands` are what a new child was asked until it failed; without any it failed to start.
    """
    if not isinstance(fault, CodeFaultError) or not fault.diagnostics:
        return fault
    place = fault.diagnostics[0].span
    trace = traced(built.emitted)
    is_endless = isinstance(fault, EndlessCodeError)  # Then only the replay tells the state.
    if not is_endless and not trace.has_later_statements(built.emitted.snippets.index(place) + 1):
        return fault
    try:
        slow = await build(trace.emitted, cache_dir=built.cache_dir, kind="unoptimized")
        found = await _Replay(fault, place, trace, slow, start).statement(commands)
    except AosError as error:
        log.info("the statement of a fault was not found: %s", error)
        return fault
    return fault if found is None else _moved(fault, found)


class _Found(msgspec.Struct, frozen=True):
    """The statement of a fault, and what was said of it when it came again."""

    span: Span
    message: str


def _moved(fault: CodeFaultError, found: _Found) -> AosError:
    (original,) = fault.diagnostics
    hint = "Look at this statement"
    # Of code that does not come to an end the state is known now.
    message = found.message if found.message.startswith(original.message) else original.message
    diagnostic = replace(original, span=found.span, message=message, hint=hint)
    text = f"{found.span}: {message}"
    return error_from_code(fault.code, text, hint=hint, diagnostics=(diagnostic,))


class _Replay:
    """The same once more, with the traced model."""

    def __init__(
        self, fault: CodeFaultError, place: Span, trace: TracedModel, built: BuiltModel, start: EngineStart
    ) -> None:
        self._fault = fault
        self._trace = trace
        self._spans = trace.emitted.snippets
        self._piece = self._spans.index(place) + 1
        self._built = built
        self._start = start
        self._samples: deque[int] = deque(maxlen=_LAST_SAMPLES)

    async def statement(self, commands: Sequence[str]) -> _Found | None:
        """Returns the statement at which the same fault comes again."""
        found = await self._fault_of([_with_one_thread(command) for command in commands])
        if found is not None and found.message.startswith(self._fault.diagnostics[0].message):
            return found
        # It did not come again, or only as a question that took too long.
        by_chance = await self._fault_of(
            [command_line("rate", seconds=_RANDOM_ACTIONS_S, seed=self._start.seed)]
        )
        return by_chance if by_chance is not None and self._is_in_the_piece(by_chance.span) else found

    async def _fault_of(self, commands: Sequence[str]) -> _Found | None:
        periods = _HANG_PERIODS if isinstance(self._fault, EndlessCodeError) else HANG_PERIODS
        child = await EngineChild.launch(self._built, self._start, periods)
        try:
            await self._watched(child, child.begin(REPLAY_DEADLINE_S))
            for command in commands:
                await self._asked(child, command)
        except ModelError as error:
            span = self._span_of(error, is_told_by_code=child.is_running)
            return None if span is None else _Found(span, error.diagnostics[0].message)
        finally:
            await child.close()
        return None

    async def _asked(self, child: EngineChild, command: str) -> None:
        if not command.startswith("update\t"):
            await self._watched(child, child.ask(command, dict, REPLAY_DEADLINE_S))
            return
        update = await self._watched(child, child.ask(command, BeliefUpdate, REPLAY_DEADLINE_S))
        if (fault := update.uncorrected) is not None:
            raise child.fault(fault.code, fault.text, fault.piece)

    async def _watched(self, child: EngineChild, question: Coroutine[Any, Any, A]) -> A:
        """The answer; what runs until then is looked at."""
        asking = asyncio.create_task(question)
        while not asking.done():
            self._samples.append(child.running_piece)
            await asyncio.wait({asking}, timeout=_SAMPLE_PERIOD_S)
        return asking.result()

    def _span_of(self, error: ModelError, *, is_told_by_code: bool) -> Span | None:
        if error.code != self._fault.code or not error.diagnostics:
            return None
        # Code that told its state told the head of its loop as well.
        if is_told_by_code or not isinstance(error, EndlessCodeError):
            return error.diagnostics[0].span
        # What never ends is the first of the statements that still run in the end: the head of its loop.
        if not self._samples or any(not self._is_number_in_the_piece(number) for number in self._samples):
            return None
        return self._spans[min(self._samples) - 1]

    def _is_number_in_the_piece(self, number: int) -> bool:
        return number > 0 and self._trace.may_be_in(number, self._piece)

    def _is_in_the_piece(self, span: Span) -> bool:
        return self._is_number_in_the_piece(self._spans.index(span) + 1)


def _with_one_thread(command: str) -> str:
    """Returns the command for one thread: of several it would not be known which failed, nor would they
    meet the fault again."""
    return re.sub(r"\tthreads=\d+", "\tthreads=1", command)
