"""Measures what planners lose where one of their mechanisms is switched off.

  python -m tests.ablation models --models 44 --simulations 1500
  python -m tests.ablation models --mechanism learned_values --mechanism prior --family late
  python -m tests.ablation bundles --from my/bundles --runs 8
  python -m tests.ablation list

`models` plays the exam's random models: regret in percent of the range between random actions and the
optimum, with and without each mechanism, in the same worlds. `bundles` plays missions of bundles: discounted
returns with and without. Budgets are simulations, so that the load of a machine does not matter. The builds
are for tests: they have the switches of `aos/base/switches.hpp`, which are constants elsewhere. The first run
compiles the engine anew.
"""

import argparse
import asyncio
import json
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from tests.exam.driver import Driver, built_driver
from tests.exam.families import FAMILIES, NEEDLES
from tests.exam.generation import problems

from aos_solver.building.compiler import find_compiler

from .bundles import bundle_rows
from .losses import Losses
from .mechanisms import BUNDLES, ROUTES, Route

_CACHE = Path.home() / ".cache" / "aos-exam"
_DEFINITION = "-DAOS_ABLATION"


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.ablation",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    models = commands.add_parser("models", help="regret on random models")
    models.add_argument("--models", type=int, default=44, metavar="N")
    models.add_argument("--family", action="append", choices=sorted(FAMILIES), help="may be repeated")
    models.add_argument("--needles", action="store_true", help="large ones of the families that hide a goal")
    models.add_argument("--missions", type=int, default=4, metavar="N", help="of each model")
    models.add_argument("--simulations", type=int, default=1500, metavar="N", help="of a decision")
    bundles = commands.add_parser("bundles", help="returns of missions")
    bundles.add_argument("--from", dest="folder", type=Path, metavar="DIR", help="more bundles")
    names = sorted({route.bundle for route in BUNDLES})
    bundles.add_argument("--bundle", action="append", choices=names, metavar="NAME", help="may be repeated")
    bundles.add_argument("--runs", type=int, default=8, metavar="N")
    for command in (models, bundles):
        command.add_argument(
            "--mechanism",
            action="append",
            choices=sorted({name for route in (*ROUTES, *BUNDLES) for name in route.mechanisms}),
            metavar="NAME",
            help="may be repeated; without any, all",
        )
        command.add_argument("--seed", type=int, default=1)
        command.add_argument("--json", action="store_true", help="a line for each row of the table")
    commands.add_parser("list", help="print where each mechanism is switched off")
    arguments = parser.parse_args()
    if arguments.command == "list":
        for route in ROUTES:
            print(f"{route.name}: {', '.join(route.mechanisms)}")
        for bundle in BUNDLES:
            print(f"{bundle.name}: {', '.join(bundle.mechanisms)}")
        return 0
    os.environ["CXX"] = f"{' '.join(asyncio.run(find_compiler()).command)} {_DEFINITION}"
    return _models(arguments) if arguments.command == "models" else _bundles(arguments)


def _models(arguments: argparse.Namespace) -> int:
    routes = [route for route in (_asked(route, arguments.mechanism) for route in ROUTES) if route.mechanisms]
    variants = [
        route.variant(*more) for route in routes for more in ((), *((name,) for name in route.mechanisms))
    ]
    options = {
        "seed": arguments.seed,
        "seconds": 0,
        "simulations": arguments.simulations,
        "missions": arguments.missions,
        "truth": 2,
        "judged": 0,
        "planners": ",".join(dict.fromkeys(variants)),
    }
    driver = Driver(asyncio.run(built_driver(_CACHE)), "regret", options, patience_s=1800)
    losses = Losses(routes)
    families = arguments.family or list(NEEDLES if arguments.needles else FAMILIES)
    asked = problems(families, arguments.models, arguments.seed, arguments.needles, 200)
    try:
        for done, problem in enumerate(asked, start=1):
            losses.add(problem.name, driver.report(problem))
            _tell_progress(f"{done}/{len(asked)} {problem.name}, {losses.models} count")
    finally:
        _tell_progress("")
        driver.close()
    _print_rows(losses.rows(), arguments.json)
    return 0


def _asked(route: Route, names: list[str] | None) -> Route:
    return route._replace(mechanisms=tuple(name for name in route.mechanisms if not names or name in names))


def _bundles(arguments: argparse.Namespace) -> int:
    _print_rows(bundle_rows(arguments, _tell_progress), arguments.json)
    return 0


def _print_rows(rows: Iterable[dict[str, Any]], as_json: bool):
    is_first = True
    for row in rows:
        _tell_progress("")
        if is_first and not as_json:
            print("| " + " | ".join(row) + " |")
            print("|" + " --- |" * len(row))
        is_first = False
        print(json.dumps(row) if as_json else "| " + " | ".join(map(str, row.values())) + " |", flush=True)
    if is_first:
        print("nothing was measured", file=sys.stderr)


def _tell_progress(text: str):
    if sys.stderr.isatty():
        print(f"\r{text}\033[K", end="", file=sys.stderr, flush=True)
    elif text:
        print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
