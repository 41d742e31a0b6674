"""The result of a call, from what an adapter has answered, and calls that hold up its event loop."""

import asyncio
import faulthandler
import logging
import os
import sys
import threading
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from reprlib import Repr
from typing import Any

from aos_protocol.errors import SkillError
from aos_protocol.messages import SkillResult
from aos_protocol.spelling import error_text
from aos_runtime.adapters.adapter import Call, Observed
from aos_runtime.adapters.expressions import translated
from aos_runtime.adapters.outbox import sendable
from aos_runtime.adapters.settings import Binding
from aos_runtime.code_places import place_of

_shortened = Repr()
_shortened.maxother = _shortened.maxstring = 80
shown = _shortened.repr
"""The text of a value for a message, which may be as large as it likes."""


def result_of(
    call: Call, binding: Binding, answer: Any, published: dict[str, int], adapter: str
) -> SkillResult:
    """The result of a call whose adapter has given this answer.

    SkillError AOS504 if the bus cannot carry it: the skill has run, and nobody knows how it ended.
    `published` is the number of messages so far on each topic.
    """
    try:
        return _result_of(call, binding, answer, published, adapter)
    except SkillError as error:
        raise SkillError(error.message, code="AOS504", hint=error.hint) from error
    except Exception as error:  # Whatever a class of somebody's raises.
        message = f"the answer of {call.path} cannot be read: {error_text(error)}"
        raise SkillError(message, code="AOS504", hint=f"Mend the adapter {adapter}") from error


def _result_of(
    call: Call, binding: Binding, answer: Any, published: dict[str, int], adapter: str
) -> SkillResult:
    if isinstance(answer, Observed):
        what = f"the observation of {call.path}"
        for name, values in (("numbers", answer.numbers), ("monitors", answer.monitors)):
            if not isinstance(values, Mapping):
                message = f"the {name} of {what} are {shown(values)}, which is no mapping of names to values"
                raise SkillError(message, hint=f"Mend the adapter {adapter}")
        words = sendable(answer.monitors, what)
        response = sendable({"response": answer.response}, what)["response"]
        for word in (*words.values(), response):
            if not isinstance(word, str):
                raise SkillError(f"{what} is {shown(word)}, which is no word", code="AOS510")
        numbers = sendable(answer.numbers, what)
        return SkillResult(call.id, {}, published, response, numbers, words)
    try:
        given = dict(answer)
    except (TypeError, ValueError) as error:
        message = f"{call.path} answered {shown(answer)}, which is no mapping of field names to values"
        raise SkillError(message, code="AOS510", hint=f"Mend the adapter {adapter}") from error
    fields = translated(binding.result, given, f"the result of {call.path}")
    return SkillResult(call.id, sendable(fields, f"the result of {call.path}"), published)


_ANSWER_S = 5.0
"""The time that the loop may take to answer: after a pause of the whole process it has to catch up first."""

_LONGEST_S = 1e9
_STDERR = 2
"""The log, also where `sys.stderr` has been replaced."""

_log = logging.getLogger("aos.adapter")


@contextmanager
def ends_if_blocked(what: str, after_s: float) -> Iterator[None]:
    """Ends the process if the event loop stands still when the block has lasted for so many seconds.

    Whoever started it can then start it again. The log says where the loop stood.
    """
    loop, thread = asyncio.get_running_loop(), threading.get_ident()

    def end() -> None:
        turns = threading.Event()
        loop.call_soon_threadsafe(turns.set)
        if turns.wait(_ANSWER_S):
            return
        place = place_of(traceback.extract_stack(sys._current_frames().get(thread)))
        _log.critical(
            "%s holds up everything at %s, and cannot be stopped: the process ends. "
            "In an `async def`, await what takes time, or hand it to asyncio.to_thread",
            what,
            place,
        )
        logging.shutdown()
        os._exit(1)

    timer = threading.Timer(after_s, end)
    timer.daemon = True
    timer.start()
    # C code that keeps Python's lock lets no thread of Python run: this one is of C, and needs no lock.
    at_last_s = min(after_s + _ANSWER_S + 1.0, _LONGEST_S)
    faulthandler.dump_traceback_later(at_last_s, exit=True, file=_STDERR)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
        timer.cancel()
