"""World files: where things stand, and the faults; the `kind` says which world it is."""

import importlib
import pkgutil
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
        data = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
        kind = _kind(path, data)
        return WorldFile(kind, msgspec.convert(data, kind.file))
    except OSError as error:
        raise DeployError(
            f"{path}: cannot be read: {error.strerror}", hint="Name another world file under `world:`"
        ) from error
    except (YAMLError, UnicodeDecodeError) as error:
        raise DeployError(f"{path}: not YAML: {error}", hint="Mend the file") from error
    except msgspec.ValidationError as error:
        raise DeployError(f"{path}: {error}", hint="Compare with the files in deploy/worlds") from error


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
