"""The exam of planners and bounds: random problems, and what the engine says of them against what is true.

  python -m tests.exam bounds --models 1000 --jobs 2
  python -m tests.exam regret --models 60 --seconds 0.1 --planner auto --planner look-ahead
  python -m tests.exam regret --needles --models 20
  python -m tests.exam documents --models 40 --texts 2000
  python -m tests.exam show corridor/17

A problem is named by its family and its seed, FAMILY/SEED, or FAMILY+/SEED where it is large, and is always
the same under its name. `bounds` counts false claims; each is printed with its problem, and with `--dump DIR`
the problem is written there. `regret` tells per family what planners lose against the optimum, in percent of
the range between random actions and the optimum. `documents` compiles bundles in which a value goes from one
variable to the next by idioms of C++; in `--texts` more it only looks for variables that are wrongly left
out. Exit code 1: a claim was false, or a target was missed.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from .compiled import examined, left_out
from .documents import Documents, documents
from .driver import Driver, built_driver
from .families import FAMILIES, NEEDLES
from .generation import named_problem, problems
from .pomdp_file import pomdp_text
from .problem import Problem
from .summary import WORST_TARGET, Bounds, Regrets

CACHE = Path.home() / ".cache" / "aos-exam"


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.exam", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="command", required=True)
    for name, text in (("bounds", "hold claims against the truth"), ("regret", "play missions")):
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
        if name == "regret":
            command.add_argument("--planner", action="append", help="auto, pomcp, despot, sarsop, look-ahead")
            command.add_argument("--seconds", type=float, help="of processor time for a decision; 0.1")
            command.add_argument("--missions", type=int, default=4, metavar="N", help="of each model")
    command = commands.add_parser("documents", help="bundles of documents, compiled")
    command.add_argument("--models", type=int, default=40, metavar="N")
    command.add_argument("--seed", type=int, default=1, help="of the first bundle")
    command.add_argument("--planner", default="auto")
    command.add_argument("--simulations", type=int, default=2000, metavar="N")
    command.add_argument("--dump", type=Path, metavar="DIR", help="where false bundles are written")
    command.add_argument("--texts", type=int, default=0, metavar="N", help="so many more, not compiled")
    show = commands.add_parser("show", help="print a problem as .pomdp")
    show.add_argument("problem")
    show.add_argument("--max-states", type=int, default=200)
    arguments = parser.parse_args()
    if arguments.command == "show":
        print(pomdp_text(named_problem(arguments.problem, 1_000_000)))
        return 0
    if arguments.command == "documents":
        return asyncio.run(_documents(arguments))
    return _examine(arguments)


async def _documents(arguments: argparse.Namespace) -> int:
    truth = Driver(await built_driver(CACHE), "values", {}, patience_s=60)
    wrong = 0
    decisions, worst = 0, 0.0
    try:
        for seed in range(arguments.seed, arguments.seed + arguments.models):
            bundle = documents(seed)
            found = await examined(bundle, truth, CACHE, arguments.planner, arguments.simulations)
            decisions += found.decisions
            worst = max(worst, found.worst)
            if found.false:
                wrong += 1
                _clear_line()
                print(f"{found.name} ({', '.join(found.idioms)})", *found.false[:3], sep="\n  ", flush=True)
                _write_bundle(arguments.dump, bundle)
            _tell_progress(f"{seed - arguments.seed + 1}/{arguments.models} {wrong} wrong")
    finally:
        _clear_line()
        truth.close()
    after = arguments.seed + arguments.models
    texts = [documents(seed) for seed in range(after, after + arguments.texts)]
    misread = [bundle for bundle in texts if left_out(bundle)]
    for bundle in misread:
        wrong_names = ", ".join(left_out(bundle))
        print(f"{bundle.name} ({', '.join(bundle.idioms)}): left out, but they matter: {wrong_names}")
        _write_bundle(arguments.dump, bundle)
    print(
        f"{arguments.models} bundles compiled, {wrong} with mistakes; {decisions} decisions, the worst loses "
        f"{worst:.1f} % of what actions differ by; {len(texts)} more read, {len(misread)} with mistakes"
    )
    return 1 if wrong or misread or worst > 100 * WORST_TARGET else 0


def _write_bundle(directory: Path | None, bundle: Documents) -> None:
    if directory is None:
        return
    folder = directory / bundle.name.replace("/", "-")
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in bundle.files.items():
        (folder / name).write_text(text)


def _tell_progress(text: str) -> None:
    if sys.stderr.isatty():
        print(f"\r{text}\033[K", end="", file=sys.stderr, flush=True)


def _examine(arguments: argparse.Namespace) -> int:
    summary: Bounds | Regrets = Bounds() if arguments.command == "bounds" else Regrets()
    options = _options(arguments)
    drivers: SimpleQueue[Driver] = SimpleQueue()
    executable = asyncio.run(built_driver(CACHE))
    for _ in range(arguments.jobs):
        drivers.put(Driver(executable, arguments.command, options, patience_s=600))
    all_problems = _problems(arguments)

    def report(problem: Problem) -> tuple[Problem, dict[str, Any]]:
        driver = drivers.get()
        try:
            return problem, driver.report(problem)
        finally:
            drivers.put(driver)

    try:
        with ThreadPoolExecutor(arguments.jobs) as workers:
            for done, (problem, answer) in enumerate(workers.map(report, all_problems), start=1):
                is_false = summary.add(problem, answer)
                if arguments.json:
                    print(json.dumps(answer), flush=True)
                if is_false and not arguments.json:
                    _clear_line()
                    print(summary.told(problem, answer), flush=True)
                if is_false and arguments.dump:
                    _dump(arguments.dump, problem, answer)
                _tell_progress(f"{done}/{len(all_problems)} {summary.line()}")
    finally:
        _clear_line()
        while not drivers.empty():
            drivers.get().close()
    print(json.dumps(summary.as_json()) if arguments.json else summary.table())
    return 0 if summary.is_passed() else 1


def _options(arguments: argparse.Namespace) -> dict[str, object]:
    options: dict[str, object] = {"seed": arguments.seed}
    for name in ("truth", "simulations", "steps"):
        if (value := getattr(arguments, name)) is not None:
            options[name] = value
    if arguments.command == "regret":
        has_budget = arguments.simulations is not None and arguments.seconds is None
        options["seconds"] = 0 if has_budget else arguments.seconds or 0.1
        options["missions"] = arguments.missions
        options["planners"] = ",".join(arguments.planner or ["auto", "look-ahead"])
    return options


def _problems(arguments: argparse.Namespace) -> list[Problem]:
    if arguments.problem:
        return [named_problem(name, 1_000_000) for name in arguments.problem]
    families = arguments.family or (NEEDLES if arguments.needles else list(FAMILIES))
    return problems(families, arguments.models, arguments.seed, arguments.needles, arguments.max_states)


def _dump(directory: Path, problem: Problem, answer: dict[str, Any]) -> None:
    directory.mkdir(parents=True, exist_ok=True)
    name = problem.name.replace("/", "-")
    (directory / f"{name}.pomdp").write_text(pomdp_text(problem))
    (directory / f"{name}.problem").write_text(problem.text())
    (directory / f"{name}.json").write_text(json.dumps(answer, indent=2))


def _clear_line() -> None:
    if sys.stderr.isatty():
        print("\r\033[K", end="", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
