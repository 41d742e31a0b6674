import json
from pathlib import Path
from typing import Any

from bounds_truth import truth_program
from processes import finished


def checked(cache_dir: Path, first_seed: int, models: int, work: int) -> tuple[list[Any], Any]:
    command = [truth_program(cache_dir), str(first_seed), str(models), str(work)]
    done = finished(*command)
    *false, counted = map(json.loads, done.stdout.splitlines())
    return false, counted


def test_no_bound_excludes_the_exact_value(cache_dir: Path):
    false, counted = checked(cache_dir, first_seed=1, models=120, work=300_000)
    assert not false
    assert counted["claims"] > 5000


def test_plans_for_small_models_come_near_the_best(cache_dir: Path):
    false, counted = checked(cache_dir, first_seed=70_000, models=40, work=5_000_000)
    assert not false
    assert counted["judged"] >= 20
    assert counted["mean_regret"] < 0.005
