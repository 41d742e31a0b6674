"""The RockSample bundles, which differ only by their layout: `python -m aos_lab.bench.rocksamples FOLDER`.

The environment comes from `rocksample.ef.template`; the skills are those of RockSample(7, 8), which is kept.
"""

import random
import sys
from pathlib import Path
from string import Template

from aos_deploy.places import shipped

BENCH = shipped("deploy/bundles/bench")
SKILLS_OF = "rocksample-7-8"


def drawn_layout(size: int, rocks: int, seed: int) -> tuple[int, int, list[tuple[int, int]]]:
    """A layout with the rocks in distinct cells other than the start, row by row."""
    start = (0, size // 2)
    cells = [(x, y) for y in range(size) for x in range(size) if (x, y) != start]
    drawn = random.Random(seed).sample(cells, rocks)
    return size, start[1], sorted(drawn, key=lambda cell: (cell[1], cell[0]))


LAYOUTS = {
    # Smith and Simmons, 2004, as the planners' own benchmark programs have it.
    "rocksample-7-8": (7, 3, [(2, 0), (0, 1), (3, 1), (6, 3), (2, 4), (3, 4), (5, 5), (1, 6)]),
    "rocksample-11-11": (
        11,
        5,
        [(0, 3), (0, 7), (1, 8), (2, 4), (3, 3), (3, 8), (4, 3), (5, 8), (6, 1), (9, 3), (9, 9)],
    ),
    "rocksample-15-15": drawn_layout(15, 15, seed=15),
}


def environment(size: int, start_y: int, rocks: list[tuple[int, int]]) -> str:
    """The environment document of a layout."""
    return Template((BENCH / "rocksample.ef.template").read_text()).substitute(
        size=size,
        cells=size**2,
        squares=2 * (size - 1) ** 2 + 1,
        start_y=start_y,
        rocks=len(rocks),
        rock_x=", ".join(str(x) for x, _ in rocks),
        rock_y=", ".join(str(y) for _, y in rocks),
    )


def bundle(name: str) -> dict[str, str]:
    """The documents of a layout, by the names of their files."""
    skills = sorted((BENCH / SKILLS_OF).glob("*.[sa][dm]"))
    return {
        "rocksample.ef": environment(*LAYOUTS[name]),
        **{document.name: document.read_text() for document in skills},
    }


def write_bundle(name: str, folder: Path) -> None:
    """Writes the bundle of a layout; leaves files alone that are as they should be."""
    folder.mkdir(parents=True, exist_ok=True)
    for file, text in bundle(name).items():
        path = folder / file
        if not path.is_file() or path.read_text() != text:
            path.write_text(text)


def main() -> None:
    for name in LAYOUTS:
        write_bundle(name, Path(sys.argv[1]) / name)


if __name__ == "__main__":
    main()
