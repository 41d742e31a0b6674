"""The sandbox of an engine: it reads its own file and libraries, and writes to what it is given."""

from pathlib import Path

from aos_runtime.processes.children import Confinement
from aos_runtime.sandbox.places import library_folders, loader_of


def confinement_of(executable: Path, *reads: Path) -> Confinement:
    """The sandbox of this executable, which may read some files besides."""
    loader = loader_of(str(executable))
    return Confinement(
        profile="engine",
        read=(*library_folders(), *(str(path) for path in reads)),
        execute=(str(executable), *([loader] if loader else [])),
    )
