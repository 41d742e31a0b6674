"""Kills, freezes and fills the disks of missions, holds each against its journal, and prints a table."""

import argparse
import sys
import tempfile
from pathlib import Path

import msgspec
from tests.chaos.campaign import PARTS, names_of, run_all, table
from tests.chaos.up import compile_bundles


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.chaos", description=__doc__)
    for part, counted in PARTS.items():
        parser.add_argument(f"--{part}", type=int, default=0, help=counted)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="runs at the same time")
    parser.add_argument("--json", type=Path, help="also write all reports to this file")
    parser.add_argument("--keep", type=Path, help="keep the folders of runs that break a promise here")
    parser.add_argument("--again", nargs="+", default=[], help="only these runs, by their names")
    options = parser.parse_args()
    counts = {part: getattr(options, part) for part in PARTS}
    if not options.again and not any(counts.values()):
        counts = dict.fromkeys(PARTS, 1) | {"kills": 24, "freezes": 6, "cancels": 2}
    names = options.again or names_of(counts, options.seed)
    with tempfile.TemporaryDirectory(prefix="aos-chaos-") as folder:
        compile_bundles(Path(folder))
    reports = list(run_all(names, options.jobs, options.keep))
    print(table(reports))
    if options.json is not None:
        options.json.write_bytes(msgspec.json.format(msgspec.json.encode(reports)))
    return int(any(report.faults for report in reports))


if __name__ == "__main__":
    sys.exit(main())
