"""The time from an edited document to a decision of its model, on this machine, now.

    python tests/edit_times.py [BUNDLE] [--times N] [--simulations N]

The environment document of a copy of BUNDLE gets another discount and is put back, again and again, in one
process that has everything imported, as the solver service has. Each row has the median milliseconds of what
happens until the decision: `edited` compiles the model, `put back` finds it in the cache, and its C++ in
memory. The engine is compiled before, as set-up leaves it. The last column is the processor time of all that
but for the engine's, which other work on the machine lengthens less.
"""

import argparse
import asyncio
import itertools
import os
import random
import re
import resource
import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path

from aos_deploy.program import cache_dir
from aos_language.load import load_bundle
from aos_solver.building.build import build
from aos_solver.building.compiler import find_compiler
from aos_solver.building.engine_build import build_engine
from aos_solver.building.project_build import emitted_model
from aos_solver.child.engine import Engine

ROOT = Path(__file__).resolve().parents[1]
STAGES = ("read", "emit", "find compiler", "build", "start engine", "decide")
COLUMNS = (*STAGES, "sum", "processor")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bundle", nargs="?", default=str(ROOT / "deploy" / "bundles" / "armadillo-finer"))
    parser.add_argument("--times", type=int, default=5)
    parser.add_argument("--simulations", type=int, default=100_000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bundle = Path(shutil.copytree(options.bundle, Path(folder) / "bundle"))
        document = next(iter(sorted(bundle.glob("*.ef"))))
        measure(document, options.times, options.simulations)


def measure(document: Path, times: int, simulations: int) -> None:
    asyncio.run(build_engine(cache_dir()))
    bundle = document.parent
    original = document.read_text()
    asyncio.run(one_decision(bundle, simulations))  # The model as it is goes into the cache.
    rows: dict[str, list[list[float]]] = {"edited": [], "put back": []}
    for _ in range(times):
        document.write_text(re.sub(r"(?m)^discount:.*", f"discount: {random.uniform(0.95, 0.99)}", original))
        rows["edited"].append(asyncio.run(one_decision(bundle, simulations)))
        document.write_text(original)
        rows["put back"].append(asyncio.run(one_decision(bundle, simulations)))
    sys.stdout.write(f"{'ms':10}{''.join(f'{column:>15}' for column in COLUMNS)}\n")
    for name, decisions in rows.items():
        medians = [statistics.median(column) for column in zip(*decisions, strict=True)]
        sys.stdout.write(f"{name:10}{''.join(f'{1000 * value:15.0f}' for value in medians)}\n")
    sys.stdout.write(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores\n")


async def one_decision(bundle: Path, simulations: int) -> list[float]:
    """Seconds for each stage, their sum, and the processor time."""
    processor_s = processor_time_s()
    marks = [time.monotonic()]
    project = load_bundle(bundle).project
    assert project is not None, bundle
    marks.append(time.monotonic())
    emitted = emitted_model(project)
    marks.append(time.monotonic())
    compiler = await find_compiler()
    marks.append(time.monotonic())
    built = await build(emitted, cache_dir=cache_dir(), compiler=compiler)
    marks.append(time.monotonic())
    engine = await Engine.start(built, seed=1)
    marks.append(time.monotonic())
    await engine.plan(simulations=simulations, seed=1, planner="pomcp")
    marks.append(time.monotonic())
    await engine.close()
    stages = [after - before for before, after in itertools.pairwise(marks)]
    return [*stages, sum(stages), processor_time_s() - processor_s]


def processor_time_s() -> float:
    """Returns the processor time of this process and of those below it that were waited for, as compilers
    are."""
    uses = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(use.ru_utime + use.ru_stime for use in uses)


if __name__ == "__main__":
    main()
