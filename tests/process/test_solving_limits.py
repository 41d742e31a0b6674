from pathlib import Path

import numpy as np

from aos_lab.formats.problem_files import read_problem
from aos_solver.offline.solving import SolvingLimits, solve

_STATES = 4000


def large_file(path: Path) -> Path:
    """A robot that is soon anywhere, and sees little of where it is."""
    draw = np.random.default_rng(1)
    lines = [f"discount: 0.95\nstates: {_STATES}\nactions: 4\nobservations: 10\nstart include: 0 1 2 3"]
    for state in range(_STATES):
        lines += [f"O: * : {state} : * 0.02", f"O: * : {state} : {state % 10} 0.82"]
        for action in range(4):
            first, second = draw.choice(_STATES, 2, replace=False)
            lines += [f"T: {action} : {state} : {first} 0.5", f"T: {action} : {state} : {second} 0.5"]
    lines.append("R: * : * : * : * -1\nR: * : * : 77 : * 100\n")
    path.write_text("\n".join(lines))
    return path


async def test_time_ends_solving_and_more_of_it_does_more(tmp_path, cache_dir: Path):
    """The short one is over before the first trial."""
    model = read_problem(large_file(tmp_path / "large.pomdp"))
    solved = [await solve(model, SolvingLimits(cpu_s=time), cache_dir=cache_dir) for time in (0.02, 1)]
    short, long = (solution.bounds for solution in solved)
    assert short.ending == long.ending == "time"
    assert short.backups < long.backups
    assert short.lower < long.lower
