"""The process in which mapping code runs: `python -I -m` of this module, started by `evaluator`.

Reads questions from its input and writes answers to its output, which mapping code cannot reach: what it
prints goes to the error output. An evaluation that takes too long ends the process by the alarm signal, with
a traceback there, even inside a C function: `faulthandler` writes it, and then the signal does what it does.
"""

import builtins
import copy
import faulthandler
import os
import signal
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from numbers import Number
from types import CodeType
from typing import Any

from aos_middleware.workers import frames
from aos_middleware.workers.values import (
    is_truth,
    message_from,
    plain_from,
    put,
    share_what_cannot_be_copied,
    text_of,
)
from aos_middleware.workers.worker_pipes import NoTruthValue, raised, take_over_pipes
from aos_protocol.spelling import shortened

Function = Callable[..., Any]

_TOLD_CHARACTERS = 100


class ImportRefused(Exception):
    """An import that the deployment does not allow; no ImportError, so that nothing stands in for it."""


class UnsendableField(TypeError):
    """A field of the call whose value the bus cannot carry."""

    def __init__(self, field: str, why: Exception) -> None:
        super().__init__(f"the field {field} of the call cannot be sent: {why}")
        self.field = field


class LoadedMapping:
    """A mapping's module, loaded, and the local variables of the activation that runs."""

    def __init__(self, load: frames.Load) -> None:
        """Runs the module; whatever it raises comes through."""
        self._load = load
        self._lines = load.python.split("\n")
        self._values: dict[str, Any] = {}
        self._last_given: dict[str, Any] = {}
        self._assigned: dict[str, Any] = {}
        self._of_skill: dict[str, Any] = {}
        self._silent: set[str] = set()
        self._has_stopped = False
        self._holds = False
        namespace: dict[str, Any] = {
            "__name__": load.file_name.removesuffix(".py"),
            "__builtins__": _builtins(load.allowed_imports),
        }
        with warnings.catch_warnings(), _watched(load.load_s):
            warnings.simplefilter("ignore", SyntaxWarning)
            exec(compile(load.python, load.file_name, "exec", dont_inherit=True), namespace)
        self._namespace = namespace
        self._shared: dict[int, Any] = {}
        with _watched(load.load_s):
            share_what_cannot_be_copied(namespace.get("CONSTANTS", {}), self._shared)

    def answer(self, question: frames.Question) -> frames.Answer:
        """The answer to a question; Raised if mapping code raised."""
        try:
            return self._answer(question)
        except UnsendableField as error:
            return frames.Raised(str(error), 0, 0, (), self._texts(), error.field)
        except BaseException as error:
            # Also SystemExit: it ends an evaluation, not the worker.
            unset = tuple(name for name, value in self._last_given.items() if value is None)
            return raised(error, self._load.file_name, self._lines, unset, self._texts())

    def _answer(self, question: frames.Question) -> frames.Answer:
        match question:
            case frames.Begin(parameters, low_level):
                return frames.Begun(self._begin(parameters, low_level))
            case frames.Take(messages):
                for number, (topic, fields) in enumerate(messages, start=1):
                    self._take(topic, fields)
                    if self._stops():
                        return frames.Taken(number, stops=True)
                return frames.Taken(len(messages))
            case frames.Finish(result, status, error):
                return frames.Observed(self._finish(result, status, error), self._texts(), self._assigned)
            case frames.Load():
                raise ValueError("the module is loaded already")

    def _begin(self, parameters: dict[str, Any], low_level: dict[str, Any]) -> dict[str, Any]:
        self._values = {}
        self._last_given = {}
        self._assigned = {}
        self._has_stopped = self._holds = False
        with _watched(self._load.evaluation_s):
            # As for parameters: what mapping code does to a constant ends with the activation.
            self._namespace.update(self._copied(self._namespace.get("CONSTANTS", {})))
            named = self._with_constants(parameters)
            for path, value in low_level.items():
                put(named, path, message_from(value))
            self._values = self._namespace["local_variables"](named)
            # A monitor calls nothing.
            request = self._namespace.get("request")
            values: dict[str, Any] = self._call(request) if request is not None else {}
            plain = {name: _sendable(name, value) for name, value in values.items()}
        of_topics = {name for functions in self._namespace.get("TOPICS", {}).values() for name in functions}
        self._silent = {name for name in of_topics if self._values[name] is None}
        return plain

    def _take(self, topic: str, fields: dict[str, Any]) -> None:
        self._update(self._namespace.get("TOPICS", {}).get(topic, {}), message_from(fields))

    def _stops(self) -> bool:
        """Returns whether what runs is to be stopped: for a skill the first time that the condition holds,
        for a monitor each time that it becomes true.

        It is not asked before each topic that it reads has said something, or has an initial value.
        """
        stop_when = self._namespace.get("stop_when")
        if stop_when is None or self._has_stopped:
            return False
        code: CodeType = stop_when.__code__
        if not self._silent.isdisjoint(code.co_varnames[: code.co_argcount]):
            return False
        with _watched(self._load.evaluation_s):
            value = self._call(stop_when)
            if not is_truth(value):
                raise NoTruthValue(f"stop_when is {text_of(value)}, which is neither True nor False", code)
        held, self._holds = self._holds, bool(value)
        self._has_stopped = self._holds and "request" in self._namespace
        return self._holds and not held

    def _finish(self, result: dict[str, Any], status: str, error: str) -> str | None:
        self._of_skill = {"__skill_status": status, "__skill_error": error}
        if status == "succeeded":
            self._update(self._namespace.get("RESPONSE", {}), message_from(result))
        with _watched(self._load.evaluation_s):
            observe = self._namespace["observe"]
            takes_assign = observe.__code__.co_varnames[:1] == ("__assign",)
            response: str | None = self._call(observe, *([self._assign] if takes_assign else []))
        return response

    def _assign(self, path: str, value: Any) -> None:
        """Keeps a low-level value that a rule gives; the rule calls it for each."""
        self._assigned[path] = plain_from(value)

    def _update(self, functions: Mapping[str, Function], message: Any) -> None:
        for name, function in functions.items():
            with _watched(self._load.evaluation_s):
                value = self._call(function, message)
                if name in self._load.truths:
                    _check_truth(name, value, function.__code__)
                self._values[name] = value
            self._silent.discard(name)

    def _call(self, function: Function, *message: Any) -> Any:
        """Calls a generated function with the local variables it names."""
        code: CodeType = function.__code__
        names = code.co_varnames[len(message) : code.co_argcount]
        values = self._values | self._of_skill
        self._last_given = {name: values[name] for name in names}
        return function(*message, **self._last_given)

    def _with_constants(self, plain: Any) -> Any:
        """Plain data with the low-level constants in place of their names, each activation its own copy."""
        constants = self._namespace.get("CONSTANTS", {})
        if isinstance(plain, dict):
            return {name: self._with_constants(value) for name, value in plain.items()}
        if isinstance(plain, list):
            return [self._with_constants(value) for value in plain]
        if isinstance(plain, str) and plain in constants:
            return self._copied(constants[plain])
        return plain

    def _copied(self, value: Any) -> Any:
        return copy.deepcopy(value, dict(self._shared))

    def _texts(self) -> dict[str, str]:
        return {name: text_of(value) for name, value in self._values.items()}


def _sendable(field: str, value: Any) -> Any:
    """The plain data of a field's value."""
    try:
        plain = plain_from(value)
        frames.pack(frames.Begun({field: plain}))
    except Exception as error:
        raise UnsendableField(field, error) from None
    return plain


def _check_truth(name: str, value: Any, code: CodeType) -> None:
    """NoTruthValue where a value of a variable of the type bool is none: as a rule, the text `no` would hold.

    None is no value, and 0 and 1 are what messages without truth values send.
    """
    is_number = isinstance(value, Number)
    if value is None or is_truth(value) or (is_number and value in (0, 1)):
        return
    said = shortened(repr(value), _TOLD_CHARACTERS)
    raise NoTruthValue(f"{name} has the type bool and is {said}, which is neither True nor False", code)


@contextmanager
def _watched(deadline_s: float) -> Iterator[None]:
    """Ends the process if the block takes longer. A timer of the kernel costs no thread."""
    signal.setitimer(signal.ITIMER_REAL, deadline_s)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


def _builtins(allowed_imports: tuple[str, ...] | None) -> dict[str, Any]:
    """The builtins of mapping code; its own imports are held to the list, not those of what it imports."""
    names = dict(vars(builtins))
    if allowed_imports is None:
        return names
    allowed = {"aos_middleware", *allowed_imports}

    def guarded(name: str, *arguments: Any, **named: Any) -> Any:
        if name.partition(".")[0] not in allowed:
            raise ImportRefused(f"this deployment does not allow mappings to import {name}")
        return builtins.__import__(name, *arguments, **named)

    names["__import__"] = guarded
    return names


def _answer_of(
    mapping: LoadedMapping | None, question: frames.Question
) -> tuple[LoadedMapping | None, bytes]:
    """The next state of the worker and the frame to send."""
    if isinstance(question, frames.Load) and mapping is None:
        try:
            return LoadedMapping(question), frames.pack(frames.Done())
        except BaseException as error:
            return None, frames.pack(raised(error, question.file_name, question.python.split("\n")))
    if mapping is None:
        raise ValueError("a mapping worker is told what to load first")
    answer = mapping.answer(question)
    try:
        return mapping, frames.pack(answer)
    except Exception as error:
        # Whole numbers beyond 64 bits, texts that are not Unicode: plain in Python, not on the bus.
        return mapping, frames.pack(raised(error, "", []))


def main() -> None:
    """Answers questions until the input ends."""
    error_output = os.dup(2)
    questions, answers = take_over_pipes(error_output)
    faulthandler.enable(file=error_output)
    faulthandler.register(signal.SIGALRM, file=error_output, chain=True)
    mapping: LoadedMapping | None = None
    while len(head := questions.read(4)) == 4:
        body = questions.read(int.from_bytes(head, "big"))
        mapping, frame = _answer_of(mapping, frames.read_question(body))
        try:
            answers.write(frame)
            answers.flush()
        except BrokenPipeError:
            os._exit(0)  # The middleware has ended. The interpreter's own end would flush once more.


if __name__ == "__main__":
    main()
