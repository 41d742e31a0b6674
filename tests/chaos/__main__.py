"""Kills, freezes and fills the disks of missions, holds each against its journal, and prints a table."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import msgspec
from tests.chaos.campaign import names_of, run_all, table
from tests.chaos.up import compile_bundles


def main() -> int:
    """Exit code 0 where every run kept what is promised."""
    parser = argparse.ArgumentParser(prog="python -m tests.chaos", description=__doc__)
    parser.add_argument("--kills", type=int, default=0, help="SIGKILLs, 12 in a mission, of all processes")
    parser.add_argument("--freezes", type=int, default=0, help="freezes of 1 s or 6 s, 3 in a mission")
    parser.add_argument("--failpoints", type=int, default=0, help="runs at each failpoint")
    parser.add_argument("--full", type=int, default=0, help="times that the disk is full at each write")
    parser.add_argument("--readonly", type=int, default=0, help="times that it is read-only at each write")
    parser.add_argument("--cancels", type=int, default=0, help="aos-up killed in mid-motion")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="runs at the same time")
    parser.add_argument("--json", type=Path, help="also write all reports to this file")
    parser.add_argument("--keep", type=Path, help="keep the folders of runs that break a promise here")
    parser.add_argument("--again", nargs="+", default=[], help="only these runs, by their names")
    options = parser.parse_args()
    kinds = ("kills", "freezes", "failpoints", "full", "readonly", "cancels")
    counts = {name: getattr(options, name) for name in kinds}
    if not options.again and not any(counts.values()):
        counts = {"kills": 24, "freezes": 6, "failpoints": 1, "full": 1, "readonly": 1, "cancels": 2}
    names = options.again or names_of(**counts, seed=options.seed)
    with tempfile.TemporaryDirectory(prefix="aos-chaos-") as folder:
        compile_bundles(Path(folder))
    reports = list(run_all(names, options.jobs, options.keep))
    print(table(reports))
    if options.json is not None:
        options.json.write_bytes(msgspec.json.format(msgspec.json.encode(reports)))
    return int(any(report.faults for report in reports))


if __name__ == "__main__":
    sys.exit(main())
