"""Problem files of other planners: read into models of numbers, and written from them."""

from pathlib import Path

__all__ = ["is_problem_file", "problem_ending"]

_ENDINGS = (".pomdpx", ".pomdp")


def problem_ending(path: Path) -> str:
    """The ending in small letters, since the files of A. Cassandra's collection end in `.POMDP`."""
    return path.suffix.lower()


def is_problem_file(path: Path) -> bool:
    """Tell whether the name is that of a problem file. A folder is a bundle, whatever its name."""
    return problem_ending(path) in _ENDINGS and not path.is_dir()
