"""Message classes of ROS 1, installed or made from the user's files. Values are dicts of fields."""

from __future__ import annotations

import tempfile
import threading
from pathlib import Path
from typing import Any, Type

import genmsg
import genmsg.msg_loader
import genpy
import genpy.dynamic
import roslib.message

from aos_skills.ros1.child.interfaces import (
    FeedbackMessage,
    Fields,
    GoalMessage,
    Message,
    ResultMessage,
    Service,
)

RULE = "=" * 80

_GENERATING = threading.Lock()
"""Held while genpy generates, since its folder for temporary files is that of the whole process."""

HEADER = "std_msgs/Header header\n"
PARTS = {
    "ActionGoal": HEADER + "actionlib_msgs/GoalID goal_id\n{0}Goal goal\n",
    "ActionResult": HEADER + "actionlib_msgs/GoalStatus status\n{0}Result result\n",
    "ActionFeedback": HEADER + "actionlib_msgs/GoalStatus status\n{0}Feedback feedback\n",
    "Action": "{0}ActionGoal action_goal\n{0}ActionResult action_result\n{0}ActionFeedback action_feedback\n",
}
"""The messages that ROS 1 derives from an action, by the suffix of its name."""


class Unknown(Exception):
    """A type that is neither installed nor among the user's files; its argument is `package/kind/Name`."""


class Misfit(Exception):
    """A value that does not fit its type."""


class ActionClasses:
    """The form of an action that actionlib wants: an object of a class with these three messages."""

    def __init__(self, types: Types, name: str) -> None:
        try:
            self.action_goal: GoalMessage = types.made(name + "ActionGoal")
            self.action_result: ResultMessage = types.made(name + "ActionResult")
            self.action_feedback: FeedbackMessage = types.made(name + "ActionFeedback")
        except Unknown as error:
            # The messages of an action come from its file.
            if error.args[0].startswith(name.replace("/", "/msg/")):
                raise Unknown(name.replace("/", "/action/"))
            raise


class Types:
    """Names are those of ROS 1, `package/Name`. The user's files come before what is installed."""

    def __init__(self, files: dict[str, str]) -> None:
        """`files` gives paths by `package/kind/Name`."""
        self._files: dict[str, str] = {}
        self._texts: dict[str, str] = {}
        self._classes: dict[str, Type[Message]] = {}
        self._services: dict[str, Type[Service]] = {}
        for name, path in files.items():
            package, kind, short = name.split("/")
            if kind == "msg":
                self._texts[f"{package}/{short}"] = Path(path).read_text(encoding="utf-8")
            elif kind == "srv":
                self._files[f"{package}/{short}"] = path
            else:
                self._add_action(package, short, Path(path).read_text(encoding="utf-8"))

    def _add_action(self, package: str, short: str, text: str) -> None:
        parts = [""]
        for line in text.splitlines():
            if line.strip() == "---":
                parts.append("")
            else:
                parts[-1] += line + "\n"
        for suffix, part in zip(("Goal", "Result", "Feedback"), parts):
            self._texts[f"{package}/{short}{suffix}"] = part
        for suffix, part in PARTS.items():
            self._texts[f"{package}/{short}{suffix}"] = part.format(short)

    def message(self, name: str) -> Type[Message]:
        if name not in self._classes:
            if name in self._texts:
                context = genmsg.MsgContext.create_default()
                spec = self._loaded(context, name, self._texts[name])
                full = genmsg.gentools.compute_full_text(context, spec)
                self._classes[name] = _generated(name, full)
            else:
                found = roslib.message.get_message_class(name)
                if found is None:
                    raise Unknown(name.replace("/", "/msg/"))
                self._classes[name] = found
        return self._classes[name]

    def made(self, name: str) -> Any:
        """An empty message of the class of this name."""
        return self.message(name)()

    def service(self, name: str) -> Type[Service]:
        if name not in self._services:
            self._services[name] = (
                self._made_service(name) if name in self._files else _installed_service(name)
            )
        return self._services[name]

    def _made_service(self, name: str) -> Any:
        context = genmsg.MsgContext.create_default()
        text = Path(self._files[name]).read_text(encoding="utf-8")
        spec = genmsg.msg_loader.load_srv_from_string(context, text, name)
        parts = {}
        for part, suffix in ((spec.request, "Request"), (spec.response, "Response")):
            self._register_used(context, part)
            full = genmsg.gentools.compute_full_text(context, part)
            parts[suffix] = _generated(name + suffix, full)
        members = {
            "_type": name,
            "_md5sum": genmsg.compute_md5(context, spec),
            "_request_class": parts["Request"],
            "_response_class": parts["Response"],
        }
        return type(name.rpartition("/")[2], (), members)

    def _loaded(self, context: Any, name: str, text: str) -> Any:
        spec = genmsg.msg_loader.load_msg_from_string(context, text, name)
        context.register(name, spec)
        self._register_used(context, spec)
        return spec

    def _register_used(self, context: Any, spec: Any) -> None:
        """The definitions that compute_md5 and compute_full_text look up."""
        used = []
        for written in spec.types:
            base = genmsg.msgs.bare_msg_type(written)
            if not genmsg.msgs.is_builtin(base):
                used.append(base)
                if not context.is_registered(base):
                    self._loaded(context, base, self._text(base))
        context.set_depends(spec.full_name, used)
        context.set_file(spec.full_name, spec.full_name)

    def _text(self, name: str) -> str:
        if name in self._texts:
            return self._texts[name]
        return str(self.message(name)._full_text).split(RULE)[0]

    def filled(self, message: Message, fields: Fields, where: str = "") -> Message:
        """A message with these fields; those that are left out keep their zero."""
        if not isinstance(fields, dict):
            raise Misfit(f"{where or 'the value'} is a {message._type} and cannot be {fields!r}")
        known = dict(zip(message.__slots__, message._slot_types))
        for name, value in fields.items():
            if name not in known:
                has = ", ".join(message.__slots__) or "none"
                raise Misfit(f"{message._type} has no field {where}{name}; its fields are {has}")
            setattr(message, name, self._part(known[name], getattr(message, name), value, where + name))
        return message

    def _part(self, type_name: str, zero: Any, value: Any, where: str) -> Any:
        base = genmsg.msgs.bare_msg_type(type_name)
        if type_name != base:
            if isinstance(value, (str, dict)) or not hasattr(value, "__iter__"):
                raise Misfit(f"{where} is a {type_name} and cannot be {value!r}")
            if base in ("uint8", "char"):
                return bytes(value)
            items = list(value)
            return [
                self._part(base, self._zero(base), item, f"{where}[{at}]") for at, item in enumerate(items)
            ]
        if base in ("time", "duration"):
            made = genpy.Time if base == "time" else genpy.Duration
            return made(int(value.get("secs", 0)), int(value.get("nsecs", 0)))
        if genmsg.msgs.is_builtin(base):
            return _builtin(base, value, where)
        return self.filled(zero, value, where + ".")

    def _zero(self, base: str) -> Any:
        return None if genmsg.msgs.is_builtin(base) else self.message(genmsg.msgs.resolve_type(base, ""))()


def _generated(name: str, text: str) -> Any:
    """Makes a message's class of its full text.

    genpy leaves the source in the folder for temporary files until its process ends in order, which a
    process with threads of rospy never does.
    """
    with _GENERATING, tempfile.TemporaryDirectory(prefix="aos-ros1-") as folder:
        before, tempfile.tempdir = tempfile.tempdir, folder
        try:
            return genpy.dynamic.generate_dynamic(name, text)[name]
        finally:
            tempfile.tempdir = before


def _installed_service(name: str) -> Any:
    found = roslib.message.get_service_class(name)
    if found is None:
        raise Unknown(name.replace("/", "/srv/"))
    return found


def _builtin(base: str, value: Any, where: str) -> Any:
    if base == "string":
        if isinstance(value, str):
            return value
    elif base == "bool":
        if value in (0, 1):
            return bool(value)
    elif base.startswith("float"):
        if isinstance(value, (int, float)):
            return float(value)
    elif isinstance(value, (int, float)) and value == int(value):
        return int(value)
    raise Misfit(f"{where} is a {base} and cannot be {value!r}")


def plain(value: Any) -> Any:
    """A message as a dict, with everything in it."""
    if isinstance(value, (genpy.Time, genpy.Duration)):
        return {"secs": value.secs, "nsecs": value.nsecs}
    if isinstance(value, genpy.Message):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value
