"""Documents that must have no mistakes which the registry finds, as projects."""

from collections.abc import Mapping
from pathlib import Path

from texts import encoded

from aos_language.load import LoadedBundle, load_bundle, load_files
from aos_protocol.documents import Project


def text_project(files: Mapping[str, str]) -> Project:
    return files_project(encoded(files))


def files_project(files: Mapping[str, bytes]) -> Project:
    return _whole(load_files(files))


def bundle_project(bundle: Path) -> Project:
    return _whole(load_bundle(bundle))


def _whole(loaded: LoadedBundle) -> Project:
    assert loaded.project is not None, [finding for finding in loaded.diagnostics if finding.is_error]
    return loaded.project
