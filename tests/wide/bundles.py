"""The bundles of all problems, by name."""

from pathlib import Path

from .apart import APART, APART_SIZES
from .inspection import inspection
from .problems import PROBLEMS, SIZES
from .upkeep import UPKEEP, UPKEEP_SIZES

__all__ = ["USUAL_SIZES", "write"]

_BUNDLES = PROBLEMS | APART | UPKEEP | {"inspection": inspection}
USUAL_SIZES = SIZES | APART_SIZES | UPKEEP_SIZES | {"inspection": 16}


def write(folder: Path, problem: str, size: int) -> Path:
    """Writes the bundle of a problem into a folder of its own and returns that."""
    bundle = folder / f"{problem}{size}"
    bundle.mkdir(parents=True, exist_ok=True)
    for name, text in _BUNDLES[problem](size).items():
        (bundle / name).write_text(text)
    return bundle
