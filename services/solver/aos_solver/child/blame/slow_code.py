"""The search for the code that makes steps slow: what runs is looked at while random steps are made.

A running model tells the piece of document code that runs. A piece of several lines is narrowed down to a
statement by a build that tells of each of them.
"""

import asyncio
import logging

import msgspec

from aos_protocol.diagnostics import Span
from aos_protocol.errors import AosError, ModelError
from aos_solver.building.build import BuiltModel, build
from aos_solver.child.lines.command_line import command_line
from aos_solver.child.process.engine_child import EngineChild, EngineStart
from aos_solver.emission.trace import TracedModel, traced

log = logging.getLogger(__name__)

_LEAST_SHARE = 0.5
_LEAST_S = 0.02
_STEPS_S = 0.5
_LOOK_PERIOD_S = 0.002
_PERIODS = 100
"""Slow code may run for so many tenths of a second, also in a build without optimisation."""
_DEADLINE_S = 12.0


class SlowCode(msgspec.Struct, frozen=True):
    """The place of code that ran for so large a `share` of the processor time."""

    span: Span
    share: float


async def slow_code(built: BuiltModel, start: EngineStart) -> SlowCode | None:
    """The code in which random steps spend half of their time or more; None where there is no such place."""
    piece, share = _most(await _times_s(built, start))
    if share < _LEAST_SHARE:
        return None
    trace = traced(built.emitted)
    found = SlowCode(built.emitted.snippets[piece - 1], share)
    if not trace.has_later_statements(piece):
        return found
    return await _slow_statement(built, start, trace, piece) or found


async def _slow_statement(
    built: BuiltModel, start: EngineStart, trace: TracedModel, piece: int
) -> SlowCode | None:
    try:
        told = await build(trace.emitted, cache_dir=built.cache_dir, kind="unoptimized")
        number, share = _most(await _times_s(told, start))
    except AosError as error:
        log.info("the slow statement was not found: %s", error)
        return None
    is_of_it = share >= _LEAST_SHARE and trace.may_be_in(number, piece)
    return SlowCode(trace.emitted.snippets[number - 1], share) if is_of_it else None


async def _times_s(built: BuiltModel, start: EngineStart) -> dict[int, float]:
    """The processor times by the number of the code that ran, 0 for the engine's own.

    It is no real time: others may have the processor for long while a piece runs. They may also keep it from
    whoever looks, so the time between two looks is shared by what ran at both.
    """
    child = await EngineChild.launch(built, start, _PERIODS)
    times_s: dict[int, float] = {}
    try:
        await child.begin(_DEADLINE_S)
        command = command_line("rate", seconds=_STEPS_S, seed=start.seed)
        asking = asyncio.create_task(child.ask(command, dict, _DEADLINE_S))
        before, before_s = child.running_piece, child.ran_s()
        while not asking.done():
            await asyncio.wait({asking}, timeout=_LOOK_PERIOD_S)
            piece, ran_s = child.running_piece, child.ran_s()
            for each in (before, piece):
                times_s[each] = times_s.get(each, 0.0) + max(ran_s - before_s, 0.0) / 2
            before, before_s = piece, ran_s
        asking.result()
    except ModelError as error:
        log.info("slow code ended: %s", error)
    finally:
        await child.close()
    return times_s


def _most(times_s: dict[int, float]) -> tuple[int, float]:
    """The number of the documents' code that ran longest, and its share; 0 of too little."""
    in_all_s = sum(times_s.values())
    number = max(times_s.keys() - {0}, key=times_s.__getitem__, default=0)
    return (number, times_s[number] / in_all_s) if number and in_all_s >= _LEAST_S else (0, 0.0)
