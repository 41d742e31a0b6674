"""The host of an adapter: which paths it serves, the documents it sees, how its process begins and ends.

Calls are in `calls.py`, messages on topics in `outbox.py`.
"""

import asyncio
import importlib
import inspect
import logging
import os
import socket
import sys
import threading
from collections.abc import AsyncIterator, Awaitable, Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from aos_protocol.errors import AosError, DeployError, LateAnswerError
from aos_protocol.keys import Lack, Serving, instance_name
from aos_protocol.messages import Cancel, Missions, MissionsQuery, ProjectQuery, ProjectRevision, SkillCall
from aos_protocol.spelling import did_you_mean
from aos_runtime.adapters.adapter import Adapter
from aos_runtime.adapters.calls import Calls
from aos_runtime.adapters.outbox import Outbox
from aos_runtime.adapters.pauses import Pauses
from aos_runtime.adapters.settings import AdapterSettings, Binding
from aos_runtime.bus.subscription import together
from aos_runtime.parties.asking import ask_until_answered
from aos_runtime.processes.lifecycle import Service

_ASK_TIMEOUT_S = 5.0
_LAST_WORDS_S = 2.0
"""A process has this time for saying why it ends, when something in it cannot be ended."""

_PARTS = ("version", "start", "call", "close")

_log = logging.getLogger("aos.adapter")


async def serve_adapter(service: Service[AdapterSettings]) -> None:
    """Carries the adapter of the settings until stopped; then it stops what moves."""
    host = Host(service)
    try:
        await host.run()
    except Exception:
        try:
            await host.close()
        except Exception:  # What ended `run` is the reason, and may be the reason of this, too.
            _log.exception("the adapter did not close")
        raise
    except BaseException:
        await host.close()
        raise


class Host:
    """The surroundings of an adapter. `options` are its own, from the deploy file in `folder`."""

    def __init__(self, service: Service[AdapterSettings]) -> None:
        settings = service.settings
        self.name = settings.service
        self.options = settings.options
        self.folder = Path(settings.folder)
        self.run_dir = Path(settings.run_dir)
        self.seed = settings.seed
        self._service = service
        self._settings = settings
        self._outbox = Outbox(service.bus, service.keys)
        self._pauses = Pauses()
        self._calls = Calls(service, self._outbox, self._pauses, self._serves, self.fail)
        self._serving: dict[str, str] = {}
        self._lacks: dict[str, str] = {}
        self._answered: set[str] = set()
        self._failed: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._adapter: Adapter | None = None

    # --- for adapters ---

    @property
    def bound(self) -> dict[str, Binding]:
        """The paths that the deploy file binds to this adapter."""
        return self._settings.bind

    def chosen(self, known: Iterable[str]) -> list[str]:
        """The paths to serve for an adapter that knows its targets: those that are bound, and for `"*"` the
        others that it has. DeployError AOS801 if a path is bound to a target that it does not know."""
        targets = {path.strip("/"): path for path in known}
        for path, binding in self.bound.items():
            target = str(binding.target if binding.target is not None else path)
            if target.strip("/") not in targets:
                has = f"It has {', '.join(sorted(targets.values())) or 'none'}"
                hint = f"{did_you_mean(target, targets.values())} {has}".strip()
                raise DeployError(f"the adapter {self.name} has no skill at {target}", hint=hint)
        return [*self.bound, *(path for path in targets.values() if self.wants(path))]

    def wants(self, path: str) -> bool:
        """Returns whether a path that is not bound by name falls to this adapter, by `"*"`."""
        named = {bound.strip("/") for bound in (*self.bound, *self._settings.elsewhere)}
        return self._settings.serves_others and path.strip("/") not in named

    async def serve(self, *paths: str) -> None:
        """Answers calls of these paths from now on, and makes that known. May be called at any time."""
        bus, keys = self._service.bus, self._service.keys
        # All in one round trip of a link that may be slow. The router takes them in in this order.
        declared: list[Awaitable[None]] = []
        for path in paths:
            if path not in self._answered:
                self._answered.add(path)
                declared.append(bus.answer(keys.call(path), SkillCall, self._calls.run))
                declared.append(bus.answer(keys.cancel(path), Cancel, self._calls.cancel))
            if path not in self._serving:
                assert self._adapter is not None
                instance = instance_name(socket.gethostname(), os.getpid(), bus.instance)
                serving = Serving(self.name, self._adapter.version, instance, path)
                self._serving[path] = keys.serve(serving)
                self._forget_lack(path)
                declared.append(bus.announce(self._serving[path]))
        await asyncio.gather(*declared)
        _log.info("serves %s", ", ".join(sorted(self._serving)))

    def _serves(self, path: str) -> bool:
        return path in self._serving

    def withdraw(self, *paths: str) -> None:
        """Makes known that these paths cannot be called for now: what stands behind them has gone."""
        for path in paths:
            if path in self._serving:
                self._service.bus.withdraw(self._serving.pop(path))

    async def lack(self, path: str, reason: str) -> None:
        """Makes known why a path is not served, until it is: one line, which says what to do."""
        key = self._service.keys.lack(Lack(self.name, reason, path))
        if self._lacks.get(path) != key:
            self._forget_lack(path)
            self._lacks[path] = key
            await self._service.bus.announce(key)

    def _forget_lack(self, path: str) -> None:
        if path in self._lacks:
            self._service.bus.withdraw(self._lacks.pop(path))

    def fail(self, error: AosError) -> None:
        """Ends the process with an error: what the adapter needs is not there, and will not come."""
        if not self._failed.done():
            self._failed.set_exception(error)

    def publish(self, topic: str, fields: Mapping[str, Any] | None = None, /, **more: Any) -> None:
        """Sends a message on a topic, its fields as a mapping or by name. From any thread, in order.

        SkillError AOS510 if a field is nothing that the bus can carry.
        """
        self._outbox.publish(topic, {**(fields or {}), **more})

    async def revisions(self) -> AsyncIterator[ProjectRevision]:
        """The project's documents as they stand, and each newer revision when it comes."""
        bus, keys, name = self._service.bus, self._service.keys, self._settings.project
        async with bus.listen(keys.announced, ProjectRevision) as announced:
            newest = 0
            if (current := await self._current_revision(name)) is not None:
                newest = current.revision
                yield current
            async for _, revision in announced:
                if revision.project.name == name and revision.revision > newest:
                    newest = revision.revision
                    yield revision

    async def _current_revision(self, project: str) -> ProjectRevision | None:
        """The documents that the registry holds now, or None. It is asked until it has said so."""
        bus, keys = self._service.bus, self._service.keys
        while True:
            try:
                return await bus.ask(
                    keys.project, ProjectQuery(project), ProjectRevision, timeout_s=_ASK_TIMEOUT_S
                )
            except LateAnswerError:
                continue
            except AosError as error:
                _log.info("no documents yet: %s", error.message)
                return None

    async def missions(self) -> Missions:
        """The missions of the system so far; BusError where the solver stays away."""
        bus, keys = self._service.bus, self._service.keys
        return await ask_until_answered(
            bus,
            keys.missions,
            MissionsQuery(),
            Missions,
            server=keys.live("solver"),
            timeout_s=_ASK_TIMEOUT_S,
        )

    # --- the process ---

    async def run(self) -> None:
        """Runs until it is stopped, or cannot go on."""
        folder, name = self._settings.class_place
        if folder not in sys.path:
            sys.path.append(folder)  # For classes that stand beside the deploy file.
        self._adapter = load_adapter(name, self)
        self._calls.go_to(self._adapter)
        # Before anything is served: whoever calls may be gone a moment later.
        bus, keys = self._service.bus, self._service.keys
        middleware, solver = bus.presence(keys.live("middleware")), bus.presence(keys.live("solver"))
        async with together(middleware, solver):
            watching = [asyncio.create_task(self._calls.watch_solver(solver))]
            try:
                with self._pauses:
                    await self._adapter.start()
                    await self._service.ready()
                    watching.append(asyncio.create_task(self._calls.watch_middleware(middleware)))
                    await self._failed
            finally:
                for task in watching:
                    task.cancel()

    async def close(self) -> None:
        # Whoever stops the process cancels what `run` waits for, which is no failure.
        is_stuck = self._failed.done() and not self._failed.cancelled()
        if not is_stuck:
            is_stuck = not await self._calls.stop_all()
            if self._adapter is not None:
                await self._adapter.close()
        if is_stuck:
            # A thread that never ends would keep the process.
            ending = threading.Timer(_LAST_WORDS_S, os._exit, (1,))
            ending.daemon = True
            ending.start()
        self._outbox.send()
        self._calls.close()


def load_adapter(name: str, host: Host) -> Adapter:
    """An adapter by `module:Class`; DeployError AOS802 where there is no such class, or it is no adapter."""
    adapter: Adapter = _made(name, _class_named(name), host)
    lacking = [f"`{attribute}`" for attribute in _PARTS if not hasattr(adapter, attribute)]
    if lacking:
        message = f"{name} is no adapter: it has no {' and no '.join(lacking)}"
        hint = "An adapter has `version`, and `async def` start(self), call(self, call) and close(self)"
        raise DeployError(message, code="AOS802", hint=hint)
    return adapter


def _made(name: str, of: Any, host: Host) -> Any:
    with suppress(ValueError):  # Of what is written in C nobody knows.
        try:
            inspect.signature(of).bind(host)
        except TypeError as error:
            message = f"the adapter {name} cannot be made with its host: {error}"
            raise DeployError(message, code="AOS802", hint="Write `def __init__(self, host)`") from error
    return of(host)


def _class_named(name: str) -> Any:
    module, _, attribute = name.partition(":")
    try:
        return getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        message = f"the adapter {name} cannot be loaded: {error}"
        hint = "It is named module:Class; see that the module can be imported here"
        raise DeployError(message, code="AOS802", hint=hint) from error
    except SyntaxError as error:
        message = f"the adapter {name} cannot be loaded: {error.filename}:{error.lineno}: {error.msg}"
        raise DeployError(message, code="AOS802", hint="It is no Python as it stands there") from error
