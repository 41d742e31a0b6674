"""A folder where a deploy file is expected: the one deploy file in it, or what to give in its place."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

from aos_deploy.deployment.yaml_source import YamlList, YamlMap, YamlScalar, read_yaml
from aos_language.load import read_bundle_files
from aos_protocol.errors import DeployError
from aos_protocol.spelling import did_you_mean_path

_SUFFIXES = (".yaml", ".yml")


def deploy_file_at(path: Path) -> Path:
    """The path itself, of a folder its deploy file; DeployError AOS801 where there is none, or several."""
    if not is_there(path):
        raise DeployError(
            f"there is no deploy file {named(path)}",
            hint=did_you_mean_path(path)
            or "`aos new adapter KIND --in BUNDLE` writes one, `aos new example NAME` one that runs",
        )
    if not is_folder(path):
        return path
    inside = [file for file, _ in deploy_files_in(path)]
    if len(inside) == 1:
        return inside[0]
    if inside:
        raise _refusal(path, f"has {len(inside)} deploy files", f"Name one: {_named(inside)}")
    folder = path.resolve()
    of_bundle = [
        Path(os.path.relpath(file)) for file, bundles in deploy_files_in(folder.parent) if folder in bundles
    ]
    if of_bundle:
        raise _refusal(path, "is a bundle, and no deploy file", f"Name one that has it: {_named(of_bundle)}")
    documents, _ = read_bundle_files(path)
    if documents:
        hint = f"Write one for it: aos new adapter model --in {path}"
        raise _refusal(path, "is a bundle, and no deploy file", hint)
    hint = "Name a deploy file, or a folder with one; `aos new example NAME` writes one that runs"
    raise _refusal(path, "is a folder without a deploy file", hint)


def deploy_files_in(folder: Path) -> Iterator[tuple[Path, list[Path]]]:
    for file in sorted(folder.iterdir()):
        if file.suffix not in _SUFFIXES or not file.is_file():
            continue
        node, _ = read_yaml(file, file.name)
        if isinstance(node, YamlMap) and {"aos", "robot", "bundles"} <= node.entries.keys():
            given = node.entries["bundles"]
            items = given.items if isinstance(given, YamlList) else ()
            names = [str(item.value) for item in items if isinstance(item, YamlScalar)]
            yield file, [absolute(folder / name) for name in names]


def _named(files: list[Path]) -> str:
    return ", ".join(map(str, files))


def _refusal(path: Path, what: str, hint: str) -> DeployError:
    return DeployError(f"{path} {what}", hint=hint)


_LONGEST = 200


def is_there(path: Path) -> bool:
    """Returns whether there is anything; False where there cannot be."""
    return _holds(path.exists)


def is_file(path: Path) -> bool:
    """Returns whether there is a file; False where there cannot be one."""
    return _holds(path.is_file)


def is_folder(path: Path) -> bool:
    """Returns whether there is a folder; False where there cannot be one."""
    return _holds(path.is_dir)


def _holds(of_path: Callable[[], bool]) -> bool:
    try:
        return of_path()
    except OSError:
        return False


def absolute(path: Path) -> Path:
    """The whole path without links; of a link in a circle the path to it."""
    return Path(os.path.realpath(path))


def named(path: Path) -> str:
    """The path as a message names it, of a very long one the beginning."""
    text = str(path)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
