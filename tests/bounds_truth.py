"""The check that the point-based solver's bounds hold, on random models, against another program's exact
values.

    python tests/bounds_truth.py [--models 10000] [--first-seed 1] [--work 10000000]

Each model is decided about three times, with so much work; ten million take some 0.1 s. A line of JSON for
every claim that does not hold, and one at the end: `mean_regret` and `worst_regret` say how much less than
the best the first decision's plan is sure to give, in parts of what is between acting by chance and the best,
where the exact value is known to a thousandth of that.
"""

import argparse
import asyncio
import subprocess
import sys
from pathlib import Path

from exam.programs import built_program

from aos_deploy.places import cache_dir

_SOURCE = Path(__file__).parent / "cpp" / "point_based" / "point_based_truth.cpp"


def main() -> None:
    """Checks what the command line says; exit code 1 if any claim is false."""
    arguments = argparse.ArgumentParser(description="Checks bounds on random models.")
    arguments.add_argument("--models", type=int, default=10_000)
    arguments.add_argument("--first-seed", type=int, default=1)
    arguments.add_argument("--work", type=int, default=10_000_000)
    given = arguments.parse_args()
    program = truth_program(cache_dir())
    command = [str(program), str(given.first_seed), str(given.models), str(given.work)]
    sys.exit(subprocess.run(command, check=False).returncode)


def truth_program(cache: Path) -> Path:
    """The program that generates and checks, from the cache or compiled now."""
    return asyncio.run(built_program(cache, _SOURCE))


if __name__ == "__main__":
    main()
