"""The result of a call, from what an adapter has answered."""

from collections.abc import Mapping
from reprlib import Repr
from typing import Any

from aos_protocol.errors import SkillError
from aos_protocol.messages import SkillResult
from aos_protocol.spelling import error_text
from aos_runtime.adapters.adapter import Call, Observed
from aos_runtime.adapters.expressions import translated
from aos_runtime.adapters.outbox import sendable
from aos_runtime.adapters.settings import Binding

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
