"""The process that speaks rospy, as its parent sees it: requests with answers, and events."""

from __future__ import annotations

import asyncio
import itertools
import json
import logging
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from aos_protocol.errors import AosError, BusError, SkillError, error_from_code
from aos_runtime.processes.children import PIPE, Child, guarded
from aos_skills.ros.definitions import interface_name, missing_interface

LONGEST_REASON = 200
START_S = 15.0
MAX_LINE_BYTES = 2**26
"""A line holds one message; a point cloud is large."""

_PACKAGES = str(Path(__file__).resolve().parents[2])
_LAUNCH = (
    "import sys; sys.path += [sys.argv[1], '/usr/lib/python3/dist-packages',"
    " '/opt/ros/noetic/lib/python3/dist-packages'];"
    " from aos_skills.ros1.child.main import main; main()"
)

_log = logging.getLogger("aos.ros1")


class Ros1Process:
    """Belongs to the event loop that started it."""

    def __init__(self, child: Child, on_event: Callable[[str, dict[str, Any]], None]) -> None:
        self._child = child
        self._on_event = on_event
        self._numbers = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._reading = asyncio.create_task(self._read())

    @classmethod
    async def start(
        cls,
        python: str,
        master: str,
        settings: Mapping[str, Any],
        on_event: Callable[[str, dict[str, Any]], None],
    ) -> Ros1Process:
        """Starts it; BusError AOS605 if no master answers, AOS805 if there is no rospy."""
        environment = {"ROS_MASTER_URI": master, "PYTHONPATH": os.environ.get("PYTHONPATH", "")}
        if "//127." in master or "//localhost" in master:
            environment.setdefault("ROS_IP", os.environ.get("ROS_IP", "127.0.0.1"))
        child = await Child.start(
            guarded([python, "-c", _LAUNCH, _PACKAGES]),
            name="ros1",
            env=environment,
            stdin=PIPE,
            stdout=PIPE,
            stream_limit_bytes=MAX_LINE_BYTES,
        )
        process = cls(child, on_event)
        ready = process._waiting[0] = asyncio.get_running_loop().create_future()
        process._write(dict(settings))
        try:
            async with asyncio.timeout(START_S):
                await ready
        except (TimeoutError, AosError) as error:
            await process.close()
            raise _start_error(python, master, error) from error
        return process

    async def ask(self, what: str, **fields: Any) -> Any:
        """The answer to a request."""
        number, answer = self.begin(what, **fields)
        try:
            return await answer
        finally:
            self._waiting.pop(number, None)

    def begin(self, what: str, **fields: Any) -> tuple[int, asyncio.Future[Any]]:
        """Sends a request; its number, and its answer when it comes."""
        number = next(self._numbers)
        answer: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self._waiting[number] = answer
        self._write({"id": number, "do": what, **fields})
        return number, answer

    def tell(self, what: str, **fields: Any) -> None:
        """Sends a request of whose answer only a failure is of interest."""

        def look(answer: asyncio.Future[Any]) -> None:
            self._waiting.pop(number, None)
            if not answer.cancelled() and (error := answer.exception()) is not None:
                _log.warning("%s: %s", what, error)

        number, answer = self.begin(what, **fields)
        answer.add_done_callback(look)

    async def close(self) -> None:
        """Ends the process."""
        self._reading.cancel()
        await asyncio.gather(self._reading, return_exceptions=True)
        await self._child.stop()
        self._fail_all("ended")

    def _write(self, line: dict[str, Any]) -> None:
        if not self._child.stdin.is_closing():
            self._child.stdin.write(json.dumps(line).encode() + b"\n")

    async def _read(self) -> None:
        while True:
            try:
                text = await self._child.stdout.readline()
            except ValueError:
                _log.warning("a message of more than %d bytes is left out", MAX_LINE_BYTES)
                continue
            if not text:
                break
            try:
                line = json.loads(text)
            except ValueError:
                # It is what remains of a line that was too long.
                continue
            if "event" in line:
                self._on_event(line.pop("event"), line)
                continue
            answer = self._waiting.get(line["id"])
            if answer is None or answer.done():
                continue
            if "ok" in line:
                answer.set_result(line["ok"])
            else:
                answer.set_exception(_error(*line["error"]))
        self._fail_all("was lost")
        self._on_event("names", {"services": {}, "actions": {}, "topics": {}})

    def _fail_all(self, how: str) -> None:
        for answer in self._waiting.values():
            if not answer.done():
                text = f"the process that speaks ROS 1 {how}"
                answer.set_exception(SkillError(text, code="AOS504", hint="See the adapter's log"))
                answer.exception()  # It has been seen: nobody may be waiting.


def _error(code: str, text: str, hint: str) -> AosError:
    if code == "AOS806":
        return missing_interface(interface_name(text, "msg"))
    return error_from_code(code, text, hint=hint)


def _start_error(python: str, master: str, error: Exception) -> AosError:
    if isinstance(error, AosError) and error.code == "AOS805":
        return error_from_code(
            "AOS805",
            error.message,
            hint="On Debian 12: sudo apt-get install python3-rospy python3-actionlib python3-rosservice; "
            "with another Python, name it under `python:` of the adapter",
        )
    why = error.message if isinstance(error, AosError) else f"{python} was not ready in {START_S:g} s"
    why = " ".join(why.split())  # Whoever is there may have answered anything.
    hint = "Start one with roscore, or name yours: adapters: {robot: {ros1: http://HOST:11311}}"
    return BusError(f"no ROS master answers at {master}: {why[:LONGEST_REASON]}", code="AOS605", hint=hint)
