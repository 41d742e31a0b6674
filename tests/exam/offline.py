"""Problems as `.pomdp` files through the offline solver, whose bounds are held against the truth."""

import tempfile
from pathlib import Path

from aos_lab.formats.problem_files import read_problem
from aos_protocol.errors import AosError
from aos_solver.offline.solving import SolvingLimits, solve

from .driver import Driver
from .pomdp_file import pomdp_text
from .problem import Problem


async def false_bounds(problem: Problem, truth: Driver, cache_dir: Path, cpu_s: float) -> tuple[str, ...]:
    """Returns the solver's false statements about a problem with a discount below 1, at any time of its
    search.

    `truth` is asked for values without an end.
    """
    with tempfile.TemporaryDirectory(prefix="exam-") as folder:
        path = Path(folder) / "exam.pomdp"
        path.write_text(pomdp_text(problem))
        try:
            solution = await solve(read_problem(path), SolvingLimits(cpu_s=cpu_s), cache_dir=cache_dir)
        except AosError as error:
            return (str(error),)
    report = truth.report(problem)
    if "values" not in report:
        return (f"the truth is not known: {report}",)
    lower = max(value for value, _ in report["values"])
    upper = max(value for _, value in report["values"])
    rounding = 1e-9 * max(abs(lower), abs(upper), 1e-3)
    false = [
        f"between {bounds.lower!r} and {bounds.upper!r} after {bounds.backups} backups, "
        f"but it is between {lower!r} and {upper!r}"
        for bounds in solution.history
        if bounds.lower > bounds.upper or bounds.lower > upper + rounding or bounds.upper < lower - rounding
    ]
    return tuple(false)
