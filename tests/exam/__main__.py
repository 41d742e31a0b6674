"""The exam of planners and bounds: random problems, and what the engine says of them against what is true.

  python -m tests.exam bounds --models 1000 --jobs 2
  python -m tests.exam regret --models 60 --seconds 0.1 --planner auto --planner look-ahead
  python -m tests.exam regret --needles --models 20
  python -m tests.exam values --models 66 --planner auto --planner despot
  python -m tests.exam values --bundle deploy/bundles/bench/tiger --seconds 0.1
  python -m tests.exam intervals --models 50
  python -m tests.exam solve --models 200
  python -m tests.exam documents --models 40 --texts 2000
  python -m tests.exam show corridor/17

A problem is named by its family and its seed, FAMILY/SEED, or FAMILY+/SEED where it is large, and is always
the same under its name. `bounds` counts false claims; each is printed with its problem, and with `--dump DIR`
the problem is written there. `regret` tells per family what planners lose against the optimum, in percent of
the range between random actions and the optimum. `values` holds what first decisions tell against the mean
of missions: it is right within two standard errors, or 5 % of that range. `documents` compiles bundles in
which a value goes from one variable to the next by idioms of C++; in `--texts` more it only looks for
variables that are wrongly left out. `intervals` has POMCP decide, and holds the value of its choice and the
margin over the runner-up, each with two standard errors, against the exact ones, and the interval in which
the choice changes with a moved belief against the exact change. Exit code 1: a claim was false, or a target
was missed.
"""

import argparse
import asyncio
import sys
from pathlib import Path

from .commands import examine_bundles, examine_documents, examine_engine, examine_solver
from .families import FAMILIES
from .generation import named_problem
from .pomdp_file import pomdp_text


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.exam", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="command", required=True)
    _add_models(commands)
    _add_others(commands)
    arguments = parser.parse_args()
    if arguments.command == "show":
        print(pomdp_text(named_problem(arguments.problem, 1_000_000)))
        return 0
    if arguments.command == "documents":
        return asyncio.run(examine_documents(arguments))
    if arguments.command == "solve":
        return asyncio.run(examine_solver(arguments))
    if arguments.command == "values" and arguments.bundle:
        return asyncio.run(examine_bundles(arguments))
    return examine_engine(arguments)


def _add_models(commands: "argparse._SubParsersAction[argparse.ArgumentParser]"):
    for name, text in (
        ("bounds", "hold claims against the truth"),
        ("regret", "play missions"),
        ("values", "hold the first decision's value against what missions return"),
        ("intervals", "hold values and margins by POMCP, with their errors, against the truth"),
        ("solve", "hold bounds of the offline solver against the truth"),
    ):
        command = commands.add_parser(name, help=text)
        command.add_argument("problem", nargs="*", help="FAMILY/SEED; without any, --models random ones")
        command.add_argument("--models", type=int, default=60, metavar="N")
        command.add_argument("--seed", type=int, default=1, help="of the first model, and of the missions")
        command.add_argument("--family", action="append", choices=sorted(FAMILIES), help="may be repeated")
        command.add_argument(
            "--needles", action="store_true", help="large ones of the families that hide a goal"
        )
        command.add_argument("--max-states", type=int, default=200, metavar="N")
        command.add_argument("--jobs", type=int, default=1, metavar="N", help="drivers at a time")
        command.add_argument("--truth", type=float, metavar="SECONDS", help="for a bracket of the truth")
        command.add_argument("--simulations", type=int, metavar="N", help="of a search")
        command.add_argument("--steps", type=int, metavar="N")
        command.add_argument("--dump", type=Path, metavar="DIR", help="where false problems are written")
        command.add_argument(
            "--json", action="store_true", help="a line for each model, and then the summary"
        )
        if name == "solve":
            command.add_argument("--time", type=float, default=0.5, metavar="SECONDS", help="of solving")
        if name in ("regret", "values"):
            command.add_argument(
                "--planner", action="append", help="auto, pomcp, despot, sarsop, options, look-ahead"
            )
            command.add_argument("--seconds", type=float, help="of processor time for a decision; 0.1")
            missions = 4 if name == "regret" else 30
            command.add_argument("--missions", type=int, default=missions, metavar="N", help="of each model")
        if name == "values":
            command.add_argument(
                "--bundle",
                action="append",
                type=Path,
                metavar="DIR",
                help="a bundle instead; may be repeated",
            )


def _add_others(commands: "argparse._SubParsersAction[argparse.ArgumentParser]"):
    command = commands.add_parser("documents", help="bundles of documents, compiled")
    command.add_argument("--models", type=int, default=40, metavar="N")
    command.add_argument("--seed", type=int, default=1, help="of the first bundle")
    command.add_argument("--planner", default="auto")
    command.add_argument("--simulations", type=int, default=2000, metavar="N")
    command.add_argument("--dump", type=Path, metavar="DIR", help="where false bundles are written")
    command.add_argument("--texts", type=int, default=0, metavar="N", help="so many more, not compiled")
    show = commands.add_parser("show", help="print a problem as .pomdp")
    show.add_argument("problem")


if __name__ == "__main__":
    sys.exit(main())
