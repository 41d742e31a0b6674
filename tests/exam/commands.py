import argparse
import asyncio
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from .bundles import told_of_bundle
from .compiled import examined, left_out
from .documents import Documents, documents
from .driver import Driver, built_driver
from .families import FAMILIES, NEEDLES
from .generation import named_problem, problems
from .intervals import Intervals
from .offline import false_bounds
from .pomdp_file import pomdp_text
from .problem import Problem
from .summary import WORST_TARGET, Bounds, Regrets
from .told import Values

CACHE = Path.home() / ".cache" / "aos-exam"

PLANNERS = {"regret": ["auto", "look-ahead"], "values": ["auto"]}


async def examine_documents(arguments: argparse.Namespace) -> int:
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


async def examine_solver(arguments: argparse.Namespace) -> int:
    """Problems as `.pomdp` files through the offline solver."""
    options = {"decisions": 0, "truth": arguments.truth or 0.2}
    truth = Driver(await built_driver(CACHE), "values", options, patience_s=600)
    asked = [problem for problem in _problems(arguments) if problem.world.discount < 1]
    wrong = 0
    try:
        for done, problem in enumerate(asked, start=1):
            if found := await false_bounds(problem, truth, CACHE, arguments.time):
                wrong += 1
                _clear_line()
                print(problem.name, *found[:3], sep="\n  ", flush=True)
                if arguments.dump:
                    _dump(arguments.dump, problem, {"false": found})
            _tell_progress(f"{done}/{len(asked)} {wrong} wrong")
    finally:
        _clear_line()
        truth.close()
    print(f"{len(asked)} models with a discount below 1, {wrong} with false bounds")
    return 1 if wrong else 0


def _write_bundle(directory: Path | None, bundle: Documents):
    if directory is None:
        return
    folder = directory / bundle.name.replace("/", "-")
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in bundle.files.items():
        (folder / name).write_text(text)


def _tell_progress(text: str):
    if sys.stderr.isatty():
        print(f"\r{text}\033[K", end="", file=sys.stderr, flush=True)


async def examine_bundles(arguments: argparse.Namespace) -> int:
    is_passed = True
    print("| bundle | planner | told | proven | returned | range | right |\n|---|---|---|---|---|---|---|")
    for bundle in arguments.bundle:
        for planner in arguments.planner or PLANNERS["values"]:
            entry = await told_of_bundle(
                bundle,
                planner,
                missions=arguments.missions,
                seed=arguments.seed,
                seconds=None if arguments.simulations else arguments.seconds or 0.1,
                simulations=arguments.simulations or 0,
            )
            is_passed = is_passed and entry.is_right
            print(entry.row(), flush=True)
    return 0 if is_passed else 1


def examine_engine(arguments: argparse.Namespace) -> int:
    summaries = {"bounds": Bounds, "regret": Regrets, "values": Values, "intervals": Intervals}
    summary: Bounds | Regrets | Values | Intervals = summaries[arguments.command]()
    # Values are held against the missions that regret is measured by.
    report_of = "regret" if arguments.command == "values" else arguments.command
    options = _options(arguments)
    drivers: SimpleQueue[Driver] = SimpleQueue()
    executable = asyncio.run(built_driver(CACHE))
    for _ in range(arguments.jobs):
        drivers.put(Driver(executable, report_of, options, patience_s=1800))
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
                    print(summary.faults_text(problem, answer), flush=True)
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
    if arguments.command in PLANNERS:
        has_budget = arguments.simulations is not None and arguments.seconds is None
        options["seconds"] = 0 if has_budget else arguments.seconds or 0.1
        options["missions"] = arguments.missions
        options["planners"] = ",".join(arguments.planner or PLANNERS[arguments.command])
    return options


def _problems(arguments: argparse.Namespace) -> list[Problem]:
    if arguments.problem:
        return [named_problem(name, 1_000_000) for name in arguments.problem]
    families = arguments.family or (NEEDLES if arguments.needles else list(FAMILIES))
    return problems(families, arguments.models, arguments.seed, arguments.needles, arguments.max_states)


def _dump(directory: Path, problem: Problem, answer: dict[str, Any]):
    directory.mkdir(parents=True, exist_ok=True)
    name = problem.name.replace("/", "-")
    (directory / f"{name}.pomdp").write_text(pomdp_text(problem))
    (directory / f"{name}.problem").write_text(problem.text())
    (directory / f"{name}.json").write_text(json.dumps(answer, indent=2))


def _clear_line():
    if sys.stderr.isatty():
        print("\r\033[K", end="", file=sys.stderr)
