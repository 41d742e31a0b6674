"""World files: where things stand, and the faults; the `kind` says which world it is."""

import importlib
import pkgutil
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from aos_protocol.errors import DeployError
from aos_protocol.spelling import did_you_mean
from aos_skills.pybullet import worlds
from aos_skills.pybullet.parts.world import World, WorldKind

_STEP = re.compile(r"\.(\w+)|\[(\d+|\.\.\.)\]")
_UNKNOWN = re.compile(r"unknown field `([^`]*)`()")


@dataclass(frozen=True)
class WorldFile:
    """A checked world file: `room` is of the kind's own form."""

    kind: WorldKind[Any, Any]
    room: Any

    def build(self, seed: int) -> World:
        """A fresh world; the seed draws its noise and its faults."""
        world: World = self.kind.build(self.room, seed)
        return world


def kinds() -> list[str]:
    """The folders under `worlds`."""
    return sorted(module.name for module in pkgutil.iter_modules(worlds.__path__) if module.ispkg)


def load_world_file(path: Path) -> WorldFile:
    """Reads and checks a world file; DeployError AOS801 names the file and what is wrong in it."""
    try:
        text = path.read_text(encoding="utf-8")
        data = YAML(typ="safe", pure=True).load(text)
    except OSError as error:
        raise DeployError(
            f"{path}: cannot be read: {error.strerror}", hint="Name another world file under `world:`"
        ) from error
    except (YAMLError, UnicodeDecodeError) as error:
        raise DeployError(f"{path}: not YAML: {error}", hint="Mend the file") from error
    kind = _kind(path, data)

    def fault() -> str:
        try:
            msgspec.convert(data, kind.file)
        except msgspec.ValidationError as error:
            return str(error)
        return ""

    if told := fault():
        place = f"{path}:{_line_of(told, text, data, fault)}"
        raise DeployError(f"{place}: {told}", hint="Compare with the files in deploy/worlds")
    return WorldFile(kind, msgspec.convert(data, kind.file))


def _line_of(told: str, text: str, data: Any, fault: Callable[[], str]) -> int:
    """The line that a message is about, by its path, such as `$.tables[...].can.radius`.

    `fault` gives the message for `data` as it is then; `data` is changed.
    """
    node, line = YAML(typ="safe", pure=True).compose(text), 1
    for key, index in [*_STEP.findall(told.rpartition("`$")[2]), *_UNKNOWN.findall(told)]:
        if index.isdigit():
            node, data = node.value[int(index)], data[int(index)]
            line = node.start_mark.line + 1
            continue
        entries = {str(name.value): (name, value) for name, value in getattr(node, "value", ())}
        key = _failing_key(data, told, fault) if index else key
        if key not in entries:
            break
        name, node = entries[key]
        line, data = name.start_mark.line + 1, data[key]
    return line


def _failing_key(data: dict[str, Any], told: str, fault: Callable[[], str]) -> str:
    """The key whose value alone has the same fault; all others are gone from `data` then."""
    entries = dict(data)
    for key, value in entries.items():
        data.clear()
        data[key] = value
        if fault() == told:
            return key
    return ""


def _kind(path: Path, data: Any) -> WorldKind[Any, Any]:
    """The folder that a file's `kind` names; only that one is imported."""
    known = kinds()
    name = data.pop("kind", None) if isinstance(data, dict) else None
    if name in known:
        kind: WorldKind[Any, Any] = importlib.import_module(f"{worlds.__name__}.{name}").KIND
        return kind
    if name is None:
        raise DeployError(f"{path}: has no `kind`", hint=f"Give one of {', '.join(known)}")
    hint = did_you_mean(str(name), known) or f"Known are {', '.join(known)}"
    raise DeployError(f"{path}: there is no world of the kind {name}", hint=hint)
