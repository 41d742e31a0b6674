import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from models import engine_of_bundle
from places import BUNDLES
from processes import finished

from aos_lab.bench.baseline import PROBLEMS, Baselines
from aos_lab.bench.rows import figure, with_ratios
from aos_solver.building.compiler import find_compiler

AOS = Path(sys.executable).parent / "aos"


def run_bench(*arguments: str) -> subprocess.CompletedProcess[str]:
    return finished(AOS, "bench", *arguments)


@pytest.fixture(scope="module")
def report() -> dict[str, Any]:
    done = run_bench("tiger", "--quick", "--runs", "2", "--time", "0.01", "--planner", "pomcp", "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_report_says_where_and_how_it_was_measured(report: dict[str, Any]):
    machine = report["machine"]
    assert machine["processor"]
    assert machine["date"].endswith("UTC")
    assert machine["versions"]["aos"]
    assert (machine["seed"], machine["budget_s"]) == (1, 0.01)


def test_every_row_has_the_same_keys_and_ours_are_compared(report: dict[str, Any]):
    keys = {"name", "problem", "metric", "value", "stderr", "unit", "against", "ratio"}
    assert all(row.keys() == keys for row in report["rows"])
    ours = {(row["metric"], row["against"]): row for row in report["rows"] if row["name"] == "aos"}
    assert ours["steps", "by hand"]["ratio"] > 0
    assert ours["simulations", "by hand"]["ratio"] > 0
    assert ours["return, pomcp", ""]["unit"] == "2 runs"


def test_a_folder_that_is_no_bundle_is_not_measured_and_that_is_no_success(tmp_path):
    done = run_bench(str(tmp_path), "--quick")
    assert done.returncode == 1
    assert f"not measured: {tmp_path.name}: AOS104" in done.stdout


def test_a_return_of_a_bundle_of_ones_own_is_told_with_and_without_its_rollout_policy(tmp_path):
    folder = shutil.copytree(BUNDLES / "bench" / "tiger", tmp_path / "tiger")
    listen = folder / "listen.sd"
    policy = "rollout_policy:\n__heuristicValue = 2;\n"
    listen.write_text(listen.read_text().replace("dynamic_model:", f"{policy}\ndynamic_model:"))
    one_mission = ("--metric", "return", "--runs", "1", "--time", "0.001", "--planner", "pomcp", "--json")
    done = run_bench(str(folder), *one_mission)
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["rows"]
    assert {row["problem"] for row in rows} == {"tiger"}
    metrics = [row["metric"] for row in rows if row["name"] == "aos"]
    assert metrics == ["return, pomcp", "return, pomcp, no rollout policy"]


@pytest.mark.parametrize("name", ["lion", "no/such/bundle"])
def test_an_unknown_benchmark_is_refused_with_the_known_ones(name):
    done = run_bench(name)
    assert done.returncode == 2
    assert f"{name} is no folder of a bundle, and none of tiger, tag," in " ".join(done.stderr.split())


async def test_the_baselines_earn_the_rewards_of_the_documents(cache_dir: Path):
    """The baselines take random actions, in millions of steps each."""
    baselines = await Baselines.built(await find_compiler(), cache_dir)
    for problem in PROBLEMS:
        steps = (await baselines.measure(problem, 0.05, seed=1))[0]
        async with engine_of_bundle(BUNDLES / "bench" / problem) as engine:
            walked = await engine.rate(0.5, seed=2)
        assert walked.mean_reward == pytest.approx(steps.check, rel=0.02), problem


def test_ratios_are_ours_over_theirs():
    rows = [
        figure("aos", "tiger", "steps", [90.0, 110.0], "1/s"),
        figure("by hand", "tiger", "steps", [200.0], "1/s"),
        figure("pomdp-py", "tiger", "steps", [2.0], "1/s"),
        figure("aos", "tag", "steps", [50.0], "1/s"),
    ]
    compared = [(row.name, row.problem, row.against, row.ratio) for row in with_ratios(rows)]
    assert compared == [
        ("aos", "tiger", "by hand", 0.5),
        ("aos", "tiger", "pomdp-py", 50.0),
        ("by hand", "tiger", "", None),
        ("pomdp-py", "tiger", "", None),
        ("aos", "tag", "", None),
    ]
    assert rows[0].stderr == pytest.approx(10)
