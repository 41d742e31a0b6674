"""Measures planners on problems whose states cannot be listed, beside rules by hand.

python -m tests.wide                      # all problems, 8 missions each at 0.1 s a decision
python -m tests.wide clutter --size 60 --runs 30
python -m tests.wide write FOLDER         # writes the bundles
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.wide import rules
from tests.wide.problems import PROBLEMS, SIZES

_STEPS = 120  # at most, in a mission


def write(folder: Path, problem: str, size: int) -> Path:
    """Writes the bundle of a problem into a folder of its own and returns that."""
    bundle = folder / f"{problem}{size}"
    bundle.mkdir(parents=True, exist_ok=True)
    for name, text in PROBLEMS[problem](size).items():
        (bundle / name).write_text(text)
    return bundle


def simulated(bundle: Path, arguments: argparse.Namespace) -> dict[str, dict[str, float]]:
    """The report of `aos simulate` on a bundle."""
    command = [
        str(Path(sys.executable).with_name("aos")),
        "simulate",
        str(bundle),
        "--goal-probability",
        "1",
        "--json",
    ]
    command += ["--time", str(arguments.time), "--runs", str(arguments.runs), "--seed", str(arguments.seed)]
    command += ["--step-limit", str(_STEPS), "--planner", arguments.planner]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(done.stderr or done.stdout)
    report: dict[str, dict[str, float]] = json.loads(done.stdout)
    return report


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problem", nargs="*", help="names of problems, or `write FOLDER`")
    parser.add_argument("--size", type=int)
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--time", type=float, default=0.1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--planner", default="auto")
    arguments = parser.parse_args()
    if arguments.problem[:1] == ["write"]:
        for problem, size in SIZES.items():
            write(Path(arguments.problem[1]), problem, arguments.size or size)
        return
    for problem in arguments.problem or PROBLEMS:
        size = arguments.size or SIZES[problem]
        rule, rule_error = rules.returned(problem, size, 200, arguments.seed)
        with tempfile.TemporaryDirectory() as folder:
            report = simulated(write(Path(folder), problem, size), arguments)
        summary = report["summary"]
        ours = f"{summary['mean_discounted_return']:.1f} +- {summary['stderr']:.1f}"
        line = f"{problem} {size}: rule {rule:.1f} +- {rule_error:.1f}, {arguments.planner} {ours}"
        print(line, flush=True)


if __name__ == "__main__":
    main()
