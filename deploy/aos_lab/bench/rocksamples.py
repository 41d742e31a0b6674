"""The RockSample bundles, which differ only by their layout: `python -m aos_lab.bench.rocksamples FOLDER`.

All are RockSample(7, 8), which is kept, with another layout.
"""

import random
import re
import sys
from pathlib import Path

from aos_deploy.places import shipped

KEPT = shipped("deploy/bundles/bench/rocksample-7-8")


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


def bundle(name: str) -> dict[str, str]:
    """The documents of a layout, by the names of their files."""
    width, start_y, rocks = LAYOUTS[name]
    layout = {
        "constexpr int width = ": f"{width}, start_y = {start_y}, rocks = {len(rocks)}",
        "constexpr int cells = ": f"{width**2}, squares = {2 * (width - 1) ** 2 + 1}",
        "state.rock_x = ": f"{{{', '.join(str(x) for x, _ in rocks)}}}",
        "state.rock_y = ": f"{{{', '.join(str(y) for _, y in rocks)}}}",
    }
    documents = {document.name: document.read_text() for document in KEPT.iterdir()}
    for place, value in layout.items():
        line = re.compile(f"^{re.escape(place)}.*;$", re.MULTILINE)
        documents["rocksample.ef"], found = line.subn(f"{place}{value};", documents["rocksample.ef"])
        assert found == 1, f"the layout of {KEPT.name} has no single line `{place}...`"
    return documents


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
