"""The files of this machine that confined programs need: libraries, compilers, Python."""

import importlib.util
import os
import shutil
import site
import struct
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

LIBRARIES = (
    "/lib", "/lib32", "/lib64", "/usr/lib", "/usr/lib32", "/usr/lib64", "/usr/local/lib", "/usr/local/lib64",
    "/nix/store", "/gnu/store",
    "/etc/ld.so.cache", "/etc/ld-musl-x86_64.path", "/etc/ld-musl-aarch64.path",
    "/etc/localtime", "/usr/share/zoneinfo", "/sys/devices/system/cpu",
)  # fmt: skip
"""The folders and files from which programs load libraries, and what those look at."""

SYSTEM = (*LIBRARIES, "/bin", "/sbin", "/usr", "/etc/alternatives", "/etc/ld.so.conf", "/etc/ld.so.conf.d")
"""The folders and files of tools that the system has installed."""

_PARTS_OF_TOOLS = ("bin", "lib", "lib32", "lib64", "libexec", "include", "sysroot")
_LOADER_SEGMENT = 3


def library_folders() -> tuple[str, ...]:
    """The libraries' folders, with those that the environment names."""
    named = os.environ.get("LD_LIBRARY_PATH", "").split(":")
    return (*LIBRARIES, *(folder for folder in named if folder.startswith("/")))


@cache
def loader_of(program: str) -> str:
    """The path of the loader that a program of 64 bits names; empty for another program."""
    try:
        with Path(program).open("rb") as file:
            head = file.read(64)
            if head[:5] != b"\x7fELF\x02":
                return ""
            start, size, count = (*struct.unpack_from("=Q", head, 32), *struct.unpack_from("=HH", head, 54))
            file.seek(start)
            segments = file.read(size * count)
            for place in range(0, len(segments), size):
                if struct.unpack_from("=I", segments, place)[0] == _LOADER_SEGMENT:
                    offset, length = struct.unpack_from("=Q24xQ", segments, place + 8)
                    file.seek(offset)
                    return file.read(length).rstrip(b"\0").decode()
    except (OSError, struct.error, UnicodeDecodeError):
        pass
    return ""


def folders_of_tool(command: Iterable[str]) -> Iterator[str]:
    """The folders of a tool that stands elsewhere than the system's, and the paths that its words name.

    A tool in a folder `bin` has the folders of programs, libraries and headers beside that one; any other
    tool has its own folder.
    """
    program, *words = command
    found = shutil.which(program)
    for path in {found, os.path.realpath(found)} if found else ():
        yield from _beside(Path(path))
    for word in words:
        start = word.find("/")
        is_option = word.startswith("-") and (word[start - 1] == "=" or start == 2)
        if start == 0 or (start > 0 and is_option):
            yield word[start:]


def _beside(program: Path) -> Iterator[str]:
    folder = program.parent
    if folder.name != "bin":
        home = Path.home()
        if folder not in (home, *home.parents):
            yield str(folder)
        return
    for entry in folder.parent.iterdir():
        # Compilers for one kind of machine keep its parts in a folder like x86_64-conda-linux-gnu.
        if entry.name in _PARTS_OF_TOOLS or entry.name.count("-") >= 2:
            yield str(entry)


@cache
def python_folders() -> tuple[str, ...]:
    """The folders and files of this Python, of what is installed in it, and of installations in place."""
    standard = [sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")]
    named = os.environ.get("PYTHONPATH", "").split(":")
    mine = (site.getusersitepackages(), str(Path.cwd()), "", *named)
    added = [path for path in sys.path[1:] if path not in mine and Path(path).is_absolute()]
    own = [sys.executable, f"{sys.prefix}/pyvenv.cfg", f"{sys.base_prefix}/lib"]
    installed = [*standard, *site.getsitepackages(), *added]
    return tuple(dict.fromkeys([*own, *installed, *_linked_from(installed), *_installed_in_place()]))


def _linked_from(folders: Iterable[str]) -> Iterator[str]:
    """The places that the packages of some folders are linked to: uv links each file, others the folders."""
    for folder in {folder for folder in folders if Path(folder).is_dir()}:
        for entry in Path(folder).iterdir():
            if entry.is_symlink():
                yield os.path.realpath(entry)
            elif (entry / "__init__.py").is_symlink():
                yield str(Path(os.path.realpath(entry / "__init__.py")).parent)


def _installed_in_place() -> Iterator[str]:
    """The folders of packages that are installed as they lie in their sources; AOS itself may be one."""
    for finder in sys.meta_path:
        module = sys.modules.get(getattr(finder, "__module__", ""))
        mapping = getattr(module, "MAPPING", None)
        if isinstance(mapping, dict):
            yield from (str(folder) for folder in mapping.values())
    for name in ("aos_protocol", "aos_runtime"):
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.origin is not None:
            yield str(Path(spec.origin).parent)
