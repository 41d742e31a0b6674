"""The folders of the missions of a system that stays: one for each, below the run directory, by number.

    <run>/missions/3/journal.db     the mission `<run>-3`
    <run>/missions/3/summary.json   how it ended

A system that ends with its mission has none: its mission has the run's name and the number 0, and its files
are the run's own.
"""

from pathlib import Path

from aos_protocol.errors import StorageError

JOURNAL = "journal.db"
_FOLDER = "missions"


def stays(run: Path) -> bool:
    """Says whether the run is one of a system that stays."""
    return (run / _FOLDER).is_dir()


def make_folder_of_missions(run: Path) -> None:
    """Makes the run one of a system that stays; StorageError AOS701 if that cannot be."""
    _made(run / _FOLDER)


def mission_folder(run: Path, number: int) -> Path:
    return run / _FOLDER / str(number) if number else run


def make_mission_folder(run: Path, number: int) -> Path:
    """The same, made if it is not there; StorageError AOS701 if that cannot be."""
    return _made(mission_folder(run, number))


def mission_folders(run: Path) -> dict[int, Path]:
    """The folders that are there, by number, in this order."""
    found = (run / _FOLDER).iterdir() if stays(run) else ()
    by_number = {int(path.name): path for path in found if path.name.isascii() and path.name.isdigit()}
    return dict(sorted(by_number.items()))


def journals(run: Path) -> dict[int, Path]:
    """The places of the missions' journals, by number, in this order."""
    folders = mission_folders(run) if stays(run) else {0: run}
    return {number: folder / JOURNAL for number, folder in folders.items()}


def mission_name(run: Path, number: int) -> str:
    """The name of a mission: `<run>-<number>`, or the run's own."""
    return f"{run.name}-{number}" if number else run.name


def number_of(mission: str) -> tuple[str, int] | None:
    """The run and the number in such a name; None for any other name."""
    run, dash, number = mission.rpartition("-")
    return (run, int(number)) if dash and number.isascii() and number.isdigit() else None


def number_in(run: str, mission: str) -> int | None:
    """The number of a mission of this run in a system that stays; None for any other mission."""
    place = number_of(mission)
    return place[1] if place is not None and place[0] == run else None


def is_before(mission: str, other: str) -> bool:
    """Says whether a mission is an earlier one of the other's system."""
    here, there = number_of(mission), number_of(other)
    return here is not None and there is not None and here[0] == there[0] and here[1] < there[1]


def _made(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StorageError(f"{folder} cannot be made: {error.strerror}", hint="Make space there") from error
    return folder
