"""Figures about adapters, each measured by a command; they take minutes, and no test runs them.

  python -m tests.adapter_numbers missions --seeds 20      all original bundles as missions with --model
  python -m tests.adapter_numbers latency --calls 300      solver to skill and back, on loopback
  python -m tests.adapter_numbers faults --runs 100        adapters that do everything wrong
  python -m tests.adapter_numbers load --seconds 10        200 skills, 50 topics at 100 Hz
  python -m tests.adapter_numbers presence --runs 20       adapters that leave and come back

Exit code 1: a target was missed.
"""

import argparse
import asyncio
import sys
from pathlib import Path

from .faults import measure_faults
from .latency import measure_latency
from .load import measure_load
from .missions import play_missions
from .presence import measure_presence


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.adapter_numbers",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    missions = commands.add_parser("missions", help="all bundles of a folder, played by their model")
    missions.add_argument("--corpus", type=Path, default=Path("../shared/corpus"), metavar="DIR")
    missions.add_argument("--bundle", action="append", help="only this one; may be repeated")
    missions.add_argument("--seeds", type=int, default=20, metavar="N")
    missions.add_argument("--simulations", type=int, default=1000, metavar="N")
    missions.add_argument("--steps", type=int, default=12, metavar="N")
    latency = commands.add_parser("latency", help="between solver and skill")
    latency.add_argument("--calls", type=int, default=300, metavar="N")
    faults = commands.add_parser("faults", help="adapters that do everything wrong")
    faults.add_argument("--runs", type=int, default=100, metavar="N", help="of each fault")
    faults.add_argument("--fault", action="append", help="only this one; may be repeated")
    load = commands.add_parser("load", help="many skills and topics")
    load.add_argument("--seconds", type=float, default=10.0, metavar="S")
    presence = commands.add_parser("presence", help="adapters that leave and come back")
    presence.add_argument("--runs", type=int, default=20, metavar="N", help="of each way to leave")
    options = parser.parse_args()
    if options.command == "missions":
        return play_missions(
            options.corpus, options.bundle, options.seeds, options.simulations, options.steps
        )
    if options.command == "latency":
        return asyncio.run(measure_latency(options.calls))
    if options.command == "faults":
        return asyncio.run(measure_faults(options.runs, options.fault))
    if options.command == "presence":
        return asyncio.run(measure_presence(options.runs))
    return asyncio.run(measure_load(options.seconds))


if __name__ == "__main__":
    sys.exit(main())
