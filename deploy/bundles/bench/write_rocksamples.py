"""Writes the RockSample bundles, which differ only by their layout; `--check` only compares.

The environment comes from `rocksample.ef.template`; the skills are those of RockSample(7, 8).
"""

import random
import sys
from collections.abc import Iterator
from pathlib import Path
from string import Template

HERE = Path(__file__).parent
SKILLS_OF = "rocksample-7-8"

LAYOUTS = {
    # Smith and Simmons, 2004, as the planners' own benchmark programs have it.
    "rocksample-7-8": (7, 3, [(2, 0), (0, 1), (3, 1), (6, 3), (2, 4), (3, 4), (5, 5), (1, 6)]),
    "rocksample-11-11": (
        11,
        5,
        [(0, 3), (0, 7), (1, 8), (2, 4), (3, 3), (3, 8), (4, 3), (5, 8), (6, 1), (9, 3), (9, 9)],
    ),
}


def drawn_layout(size: int, rocks: int, seed: int) -> tuple[int, int, list[tuple[int, int]]]:
    """A layout with the rocks in distinct cells other than the start, row by row."""
    start = (0, size // 2)
    cells = [(x, y) for y in range(size) for x in range(size) if (x, y) != start]
    drawn = random.Random(seed).sample(cells, rocks)
    return size, start[1], sorted(drawn, key=lambda cell: (cell[1], cell[0]))


def environment(size: int, start_y: int, rocks: list[tuple[int, int]]) -> str:
    """The environment document of a layout."""
    return Template((HERE / "rocksample.ef.template").read_text()).substitute(
        size=size,
        cells=size**2,
        squares=2 * (size - 1) ** 2 + 1,
        start_y=start_y,
        rocks=len(rocks),
        rock_x=", ".join(str(x) for x, _ in rocks),
        rock_y=", ".join(str(y) for _, y in rocks),
    )


def bundles() -> Iterator[tuple[Path, str]]:
    """Every file of the bundles with its text."""
    for name, layout in {**LAYOUTS, "rocksample-15-15": drawn_layout(15, 15, seed=15)}.items():
        yield HERE / name / "rocksample.ef", environment(*layout)
        for document in sorted((HERE / SKILLS_OF).glob("*.[sa][dm]")):
            yield HERE / name / document.name, document.read_text()


def main() -> None:
    """Writes, or with `--check` ends with 1 if a file is not as it would be written."""
    stale = [path for path, text in bundles() if not path.is_file() or path.read_text() != text]
    if "--check" in sys.argv[1:]:
        for path in stale:
            print(f"{path.relative_to(HERE)} is not as {Path(__file__).name} writes it", file=sys.stderr)
        sys.exit(1 if stale else 0)
    for path, text in bundles():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)


if __name__ == "__main__":
    main()
