"""Requests from AOS on the input, a JSON object a line; answers and events on the output.

    {"id": 1, "do": "call", "name": "/pick", "fields": {}}      ->  {"id": 1, "ok": {...}}
                                                                or  {"id": 1, "error": [code, text, hint]}
    {"id": 2, "do": "subscribe", "name": "/scan"}               ->  {"event": "message", "name": "/scan", ...}

Calls and actions have a thread each; all else is done in the order of the lines.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from typing import Any

BLOCKING = ("call", "run")


class Channel:
    """The lines to AOS. rospy and its users print; that goes to the error output instead."""

    def __init__(self) -> None:
        self._out = os.fdopen(os.dup(1), "w", encoding="utf-8")
        os.dup2(2, 1)
        self._lock = threading.Lock()

    def send(self, **line: Any) -> None:
        text = json.dumps(line)
        with self._lock:
            self._out.write(text + "\n")
            self._out.flush()


def main() -> None:
    """Serves until the input ends. The first line is the settings: `node`, and `files` of interfaces."""
    channel = Channel()
    settings = json.loads(sys.stdin.readline())
    try:
        from aos_skills.ros1.child.robot import Robot

        robot = Robot(channel, settings)
    except ImportError as error:
        channel.send(id=0, error=["AOS805", f"{sys.executable} cannot import ROS 1: {error}", ""])
        return
    except Exception as error:
        channel.send(id=0, error=["AOS605", f"{type(error).__name__}: {error}", ""])
        return
    channel.send(id=0, ok={})
    for line in sys.stdin:
        request = json.loads(line)
        if request["do"] in BLOCKING:
            threading.Thread(target=_answer, args=(channel, robot, request), daemon=True).start()
        else:
            _answer(channel, robot, request)
    # Threads of rospy would keep the process.
    os._exit(0)


def _answer(channel: Channel, robot: Any, request: dict[str, Any]) -> None:
    number, what = request.pop("id"), request.pop("do")
    try:
        result = getattr(robot, "do_" + what)(number=number, **request)
    except Exception as error:
        code, hint = robot.code_of(error)
        channel.send(id=number, error=[code, str(error) or type(error).__name__, hint])
    else:
        channel.send(id=number, ok=result)
