"""Old runs removed from their folder: the newest stay, and whatever goes on."""

import re
import shutil
from pathlib import Path

import msgspec

from aos_deploy.runs.bus_socket import remove_left_sockets
from aos_deploy.runs.directory import LATEST, RunDirectory
from aos_protocol.errors import StorageError

_NAME = re.compile(r"(\d{8}T\d{6}Z)-.+")
"""The name of a run directory begins with the time of its start."""


class Removed(msgspec.Struct, frozen=True):
    """A run that was removed, and the space on the disk that it had taken."""

    directory: str
    size_bytes: int


class Pruned(msgspec.Struct, frozen=True):
    """The runs that were removed, the oldest first, and how many are there still."""

    removed: tuple[Removed, ...]
    kept: int

    @property
    def freed_bytes(self) -> int:
        """The space of all that was removed."""
        return sum(run.size_bytes for run in self.removed)


def pruned(folder: Path, keep: int) -> Pruned:
    """Removes all runs of a folder but the `keep` newest; StorageError AOS701 if one cannot be removed.

    A run that goes on stays, however old it is. The run that `latest` names is the newest, also where the
    clock has been set back since the others. Nothing else in the folder is touched. The sockets of runs
    that were killed are removed as well, where they had a folder of their own.
    """
    remove_left_sockets()
    runs = sorted(_runs_in(folder), key=lambda path: path.stat().st_mtime)
    newest = (folder / LATEST).resolve().name
    runs.sort(key=lambda path: (path.name == newest, path.name[: path.name.index("-")]))
    removed = []
    for path in runs[: max(len(runs) - keep, 0)]:
        run = RunDirectory(path)
        if run.hold():
            try:
                size_bytes = sum(inside.lstat().st_blocks * 512 for inside in path.rglob("*"))
                removed.append(Removed(str(path), size_bytes))
                shutil.rmtree(path)
            except OSError as error:
                raise StorageError(f"{path} cannot be removed: {error.strerror}") from error
            finally:
                run.close()
    latest = folder / LATEST
    if latest.is_symlink() and not latest.exists():
        latest.unlink()
    return Pruned(tuple(removed), len(runs) - len(removed))


def _runs_in(folder: Path) -> list[Path]:
    """The directories of runs, also of those that did not come as far as their record."""
    found = (path for path in folder.resolve().iterdir() if _NAME.fullmatch(path.name))
    return [path for path in found if not path.is_symlink() and (path / "logs").is_dir()]
