"""The adapter `python`: skills that are functions in a file of the user's, or in an installed package.

    bind: {/drive: {python: my_robot.py:drive}, /turn: {python: "my_robot.py:Robot.turn"}}

A function gets the call, and the call's fields by name. The methods of a class share one object of it, made
when the adapter starts. The user's code runs on a thread of its own, with an event loop of its own: whatever
it does, calls and cancellations are answered.
"""

import asyncio
import importlib
import importlib.util
import inspect
import logging
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from aos_protocol.errors import DeployError, SkillError
from aos_protocol.spelling import error_text
from aos_runtime.adapters import Answer, Call, Host
from aos_runtime.code_places import place_of

_log = logging.getLogger("aos.adapter")

_END_S = 1.0
_LONG_S = 5.0
"""A start that takes longer is told with its place."""
_TOLD_S = 1.0
"""A function that goes on for so long after its cancellation is told with its place."""
_POSITIONAL = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)


class PythonAdapter:
    """Loads what paths are bound to, and calls it."""

    version = "1"

    def __init__(self, host: Host) -> None:
        self._host = host
        self._modules: dict[str, ModuleType] = {}
        self._objects: dict[tuple[str, str], Any] = {}
        self._functions: dict[str, Callable[..., Any]] = {}
        self._task: asyncio.Task[Any] | None = None
        self._working: int | None = None  # The thread of the function that runs.
        self._loop = asyncio.new_event_loop()
        # A daemon, so that a function that never ends does not keep the process.
        self._thread = threading.Thread(target=self._loop.run_forever, name="skills", daemon=True)

    async def start(self) -> None:
        """Loads every function; DeployError AOS801 names what cannot be found."""
        self._thread.start()
        self._working = self._thread.ident
        loading = asyncio.wrap_future(asyncio.run_coroutine_threadsafe(self._load_all(), self._loop))
        if not (await asyncio.wait({loading}, timeout=_LONG_S))[0]:
            _log.warning("the start takes long, and stands at %s", self._place())
        await loading
        await self._host.serve(*self._functions)

    async def call(self, call: Call) -> Answer:
        """Runs the function; one that is not asynchronous runs on a thread, and looks at `is_cancelled`."""
        function = self._functions[call.path]
        fields = _fitting(function, call)
        running = asyncio.run_coroutine_threadsafe(self._run(function, call, fields), self._loop)
        ended = asyncio.wrap_future(running)
        try:
            return await asyncio.shield(ended)
        except asyncio.CancelledError:
            if ended.done():
                raise
            stopping = asyncio.run_coroutine_threadsafe(self._cancel(call), self._loop)
            both = {asyncio.wrap_future(stopping), ended}
            _, going_on = await asyncio.wait(both, timeout=_TOLD_S)
            if going_on:
                _log.warning("%s is cancelled, and goes on at %s", call.path, self._place())
                await asyncio.wait(both)
            raise

    async def close(self) -> None:
        """Closes the objects that can be closed."""
        if self._thread.is_alive():
            closing = asyncio.run_coroutine_threadsafe(self._close_all(), self._loop)
            await asyncio.wait({asyncio.wrap_future(closing)}, timeout=_END_S)
            self._loop.call_soon_threadsafe(self._loop.stop)

    def _place(self) -> str:
        """File and line at which the function that runs stands, or awaits something."""
        frames, awaiting = [], self._task.get_coro() if self._task is not None else None
        while (frame := getattr(awaiting, "cr_frame", None)) is not None:
            frames.append((frame, frame.f_lineno))
            awaiting = getattr(awaiting, "cr_await", None)
        stack = traceback.extract_stack(sys._current_frames().get(self._working or 0))
        return place_of([*traceback.StackSummary.extract(frames), *stack])

    # --- on the user's thread ---

    async def _load_all(self) -> None:
        for path, binding in self._host.bound.items():
            target = binding.target
            target = target if isinstance(target, str) else ""
            if ":" not in target and "file" in self._host.options:
                target = f"{self._host.options['file']}:{target or path.rpartition('/')[2]}"
            if ":" not in target:
                hint = f"Write it as {path}: {{{self._host.name}: my_robot.py:function}}"
                raise DeployError(f"{path} is not bound to a function", hint=hint)
            self._functions[path] = self._function(path, target)

    def _function(self, path: str, target: str) -> Callable[..., Any]:
        place, _, name = target.rpartition(":")
        module = self._module(path, place)
        owner, _, attribute = name.rpartition(".")
        try:
            if owner:
                found = getattr(self._object(place, owner, getattr(module, owner)), attribute)
            else:
                found = getattr(module, name)
                if inspect.isclass(found):
                    found = self._object(place, name, found)
        except AttributeError as error:
            known = ", ".join(_own_names(module)) or "no function of its own"
            raise DeployError(
                f"{path} is bound to {target}, and {place} has no {name}", hint=f"It has {known}"
            ) from error
        if not callable(found):
            raise DeployError(f"{path} is bound to {target}, which cannot be called")
        if inspect.isgeneratorfunction(found) or inspect.isasyncgenfunction(found):
            hint = "A call would run nothing of it: tell progress by `call.progress`, and return the result"
            raise DeployError(f"{path} is bound to {target}, which has a `yield`", hint=hint)
        if not _takes_call(found):
            short = name.rpartition(".")[2]
            hint = f"A function gets the call first, and then the call's fields: def {short}(call)"
            raise DeployError(f"{path} is bound to {target}, which takes no arguments", hint=hint)
        return found  # type: ignore[no-any-return]

    def _module(self, path: str, place: str) -> ModuleType:
        if place in self._modules:
            return self._modules[place]
        _log.info("loading %s", place)  # The last line, where the file never comes to its end.
        try:
            if place.endswith(".py"):
                module = _from_file(self._host.folder / place)
            else:
                module = importlib.import_module(place)
        except (Exception, SystemExit) as error:
            frames = traceback.extract_tb(error.__traceback__)
            lines = [frame.lineno for frame in frames if frame.filename.endswith(place)]
            hint = f"A file is found from the deploy file's folder, {self._host.folder}; see the log too"
            hint = f"It was raised at {place}:{lines[-1]}" if lines else hint
            if isinstance(error, SystemExit):
                hint = "What it does as a program stands behind `if __name__ == '__main__':`"
            message = f"{path} is bound to {place}, which cannot be loaded: {error_text(error)}"
            raise DeployError(message, hint=hint) from error
        self._modules[place] = module
        return module

    def _object(self, place: str, name: str, kind: Any) -> Any:
        if (place, name) in self._objects:
            return self._objects[place, name]
        try:
            made = kind(self._host) if _takes_host(kind) else kind()
        except (Exception, SystemExit) as error:
            frame = traceback.extract_tb(error.__traceback__)[-1]
            raise DeployError(
                f"{name} of {place} cannot be made: {error_text(error)}",
                hint="It is made without arguments, or with the host alone"
                if frame.filename == __file__
                else f"It was raised at {Path(frame.filename).name}:{frame.lineno}",
            ) from error
        self._objects[place, name] = made
        return made

    async def _run(self, function: Callable[..., Any], call: Call, fields: dict[str, Any]) -> Any:
        self._task, self._working = asyncio.current_task(), self._thread.ident
        kind = type(function)
        if inspect.iscoroutinefunction(function) or inspect.iscoroutinefunction(kind.__call__):
            try:
                answer = await function(call, **fields)
            except (SystemExit, KeyboardInterrupt) as error:
                raise _failure(call, error) from error
        else:
            answer = await self._on_thread(function, call, fields)
            if inspect.iscoroutine(answer):  # As of a decorated `async def`.
                answer = await answer
        return {} if answer is None else answer

    async def _on_thread(self, function: Callable[..., Any], call: Call, fields: dict[str, Any]) -> Any:
        ended: asyncio.Future[Any] = self._loop.create_future()

        def settle(answer: Any, error: Exception | None) -> None:
            if ended.done():
                return
            if error is None:
                ended.set_result(answer)
            else:
                ended.set_exception(error)

        def work() -> None:
            answer: Any = None
            error: Exception | None = None
            try:
                answer = function(call, **fields)
            except BaseException as failure:
                error = _failure(call, failure)
            self._loop.call_soon_threadsafe(settle, answer, error)

        thread = threading.Thread(target=work, name=call.path, daemon=True)
        thread.start()
        self._working = thread.ident
        try:
            return await asyncio.shield(ended)
        except asyncio.CancelledError:
            await asyncio.wait({ended})
            raise

    async def _cancel(self, call: Call) -> None:
        call.cancel()
        if self._task is not None:
            self._task.cancel()
            await asyncio.wait({self._task})

    async def _close_all(self) -> None:
        for object in self._objects.values():
            close = getattr(object, "close", None)
            if callable(close):
                closed = close()
                if inspect.isawaitable(closed):
                    await closed


def _own_names(module: ModuleType) -> list[str]:
    """The functions and classes that a module defines itself, with the methods of the classes."""
    own: list[str] = []
    for name, value in vars(module).items():
        if name.startswith("_") or getattr(value, "__module__", None) != module.__name__:
            continue
        methods = [each for each in vars(value) if not each.startswith("_")] if inspect.isclass(value) else []
        own += [f"{name}.{each}" for each in methods if callable(getattr(value, each))] or [name]
    return own


def _from_file(path: Path) -> ModuleType:
    """A module by its file; what stands beside it can be imported."""
    if not path.is_file():
        raise FileNotFoundError(f"there is no file {path}")
    folder = str(path.resolve().parent)
    if folder not in sys.path:
        sys.path.insert(0, folder)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def _takes_host(kind: Any) -> bool:
    """Returns whether a class is made with the host: its one argument has no default, or is called `host`."""
    try:
        parameters = list(inspect.signature(kind).parameters.values())
    except (TypeError, ValueError):
        return False
    if len(parameters) != 1 or parameters[0].kind not in _POSITIONAL:
        return False
    return parameters[0].default is inspect.Parameter.empty or parameters[0].name == "host"


def _failure(call: Call, error: BaseException) -> Exception:
    """The exception of a call; one that no future can hold, or that would end the process, told in words."""
    if isinstance(error, Exception) and not isinstance(error, StopIteration):
        return error
    text = f"{call.path} failed: {error_text(error)}"
    return SkillError(text, code="AOS510", hint="A function ends by an answer or an error of its own")


def _takes_call(function: Callable[..., Any]) -> bool:
    """Returns whether the function has a place for the call; where Python cannot tell, it is supposed to."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return True
    return any(parameter.kind in (*_POSITIONAL, inspect.Parameter.VAR_POSITIONAL) for parameter in parameters)


def _fitting(function: Callable[..., Any], call: Call) -> dict[str, Any]:
    """The call's fields; SkillError AOS502 where the function does not take them."""
    signature = inspect.signature(function)
    try:
        signature.bind(call, **call.fields)
    except TypeError as error:
        first, *others = list(signature.parameters)
        takes = ", ".join(others) or "no fields"
        sends = ", ".join(call.fields) or "none"
        hint = f"The function takes {takes}; the mapping sends {sends}. See `fields:` in the deploy file"
        if first in call.fields:
            hint = f"The first argument is the call, and no field: write (call, {sends})"
        raise SkillError(f"{call.path} cannot be called with these fields: {error}", hint=hint) from error
    return call.fields
