"""The search for the code that makes steps slow: what runs is looked at while random steps are made.

A running model tells the piece of document code that runs. A piece of several lines is narrowed down to a
statement by a build that tells of each of them.
"""

import asyncio
import logging
from collections import Counter
from collections.abc import Iterable

import msgspec

from aos_protocol.diagnostics import Span
from aos_protocol.errors import AosError, ModelError
from aos_solver.building.build import BuiltModel, build
from aos_solver.child.command_line import command_line
from aos_solver.child.engine_child import EngineChild, EngineStart
from aos_solver.emission.trace import TracedModel, traced

log = logging.getLogger(__name__)

_LEAST_SHARE = 0.5
_LEAST_LOOKS = 20
_STEPS_S = 0.5
_LOOK_PERIOD_S = 0.002
_PERIODS = 100
"""Slow code may run for so many tenths of a second, also in a build without optimisation."""
_DEADLINE_S = 12.0


class SlowCode(msgspec.Struct, frozen=True):
    """The place of code that ran at so large a `share` of the looks."""

    span: Span
    share: float


async def slow_code(built: BuiltModel, start: EngineStart) -> SlowCode | None:
    """The code in which random steps spend half of their time or more; None where there is no such place."""
    looks = await _looks(built, start)
    piece, share = _most(looks)
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
        number, share = _most(await _looks(told, start))
    except AosError as error:
        log.info("the slow statement was not found: %s", error)
        return None
    is_of_it = share >= _LEAST_SHARE and trace.may_be_in(number, piece)
    return SlowCode(trace.emitted.snippets[number - 1], share) if is_of_it else None


async def _looks(built: BuiltModel, start: EngineStart) -> list[int]:
    """The numbers of the code that ran at each look, 0 for the engine's own."""
    child = await EngineChild.launch(built, start, _PERIODS)
    looks = []
    try:
        await child.begin(_DEADLINE_S)
        command = command_line("rate", seconds=_STEPS_S, seed=start.seed)
        asking = asyncio.create_task(child.ask(command, dict, _DEADLINE_S))
        while not asking.done():
            looks.append(child.running_piece)
            await asyncio.wait({asking}, timeout=_LOOK_PERIOD_S)
        asking.result()
    except ModelError as error:
        log.info("slow code ended: %s", error)
    finally:
        await child.close()
    return looks


def _most(looks: Iterable[int]) -> tuple[int, float]:
    """The number of the documents' code that ran at most looks, and its share of them; 0 of too few."""
    counts = Counter(looks)
    in_all = counts.total()
    counts.pop(0, None)
    if in_all < _LEAST_LOOKS or not counts:
        return 0, 0.0
    number, times = counts.most_common(1)[0]
    return number, times / in_all
