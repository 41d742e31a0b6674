"""Every bundle of a folder as whole missions with `aos-up --model`, beside `aos simulate`."""

import argparse
import json
import math
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from aos_language.load import load_bundle

BIN = Path(sys.executable).parent
MISSION_S = 300.0
UNDEFINED = ("", "fault", "not_started")


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--corpus", type=Path, default=Path("../shared/corpus"), metavar="DIR")
    parser.add_argument("--bundle", action="append", help="only this one; may be repeated")
    parser.add_argument("--seeds", type=int, default=20, metavar="N")
    parser.add_argument("--simulations", type=int, default=1000, metavar="N")
    parser.add_argument("--steps", type=int, default=12, metavar="N")


def measure(options: argparse.Namespace) -> int:
    """Prints a line for each bundle; 1 if a mission has no defined ending, or returns do not agree."""
    corpus, only, seeds = options.corpus, options.bundle, options.seeds
    simulations, steps = options.simulations, options.steps
    missed = 0
    print("bundle | defined endings | equal by seed | with --model | simulated | z")
    for bundle in sorted(corpus.iterdir()):
        project = load_bundle(bundle).project if bundle.is_dir() else None
        if project is None or (only and bundle.name not in only):
            continue
        with tempfile.TemporaryDirectory(prefix="aos-missions-") as folder:
            deploy = Path(folder) / "deploy.yaml"
            deploy.write_text(
                f"aos: 1\nrobot: played\nproject: {project.name}\nbundles: [{bundle.resolve()}]\n"
                f"mission: {{step_limit: {steps}}}\nsolver: {{simulations: {simulations}}}\nruns: runs\n"
            )
            played = [_played(deploy, seed, bundle.name) for seed in range(1, seeds + 1)]
        simulated = _simulated(bundle, seeds, simulations, steps)
        totals = [total for total, _ in played]
        endings = {ending for _, ending in played}
        defined = sum(ending not in UNDEFINED for _, ending in played)
        equal = sum(math.isclose(a, b, abs_tol=1e-6) for a, b in zip(totals, simulated, strict=True))
        z = _difference(totals, simulated)
        missed += defined < seeds or abs(z) > 2
        print(
            f"{bundle.name} | {defined}/{seeds} ({', '.join(sorted(endings))}) | {equal}/{seeds} | "
            f"{_text(totals)} | {_text(simulated)} | {z:.2f}",
            flush=True,
        )
    return int(missed > 0)


def _played(deploy: Path, seed: int, name: str) -> tuple[float, str]:
    """A mission's return, by the truth that the adapter has written, and its ending."""
    command = [
        BIN / "aos-up",
        deploy,
        "--model",
        "--seed",
        str(seed),
        "--listen",
        "tcp/127.0.0.1:0",
        "--json",
    ]
    subprocess.run(command, capture_output=True, check=False, timeout=MISSION_S)
    latest = deploy.parent / "runs" / "latest"
    summary: dict[str, Any] = json.loads((latest / "summary.json").read_text())
    truth = latest / "model.jsonl"
    steps = truth.read_text().splitlines() if truth.exists() else []
    sys.stderr.write(f"\r{name} seed {seed}: {summary['ending']}      ")
    if summary["ending"] in UNDEFINED:
        sys.stderr.write(f"\n{summary['remark']}\n")
    return sum(json.loads(step)["reward"] for step in steps), summary["ending"]


def _simulated(bundle: Path, seeds: int, simulations: int, steps: int) -> list[float]:
    command = [BIN / "aos", "simulate", bundle, "--runs", str(seeds), "--seed", "1", "--json"]
    command += ["--simulations", str(simulations), "--step-limit", str(steps)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return [run["return"] for run in json.loads(done.stdout)["runs"]]


def _difference(one: list[float], other: list[float]) -> float:
    """Returns the difference of two means, in standard errors of the difference."""
    difference = statistics.fmean(one) - statistics.fmean(other)
    variance = sum(statistics.variance(values) / len(values) for values in (one, other) if len(values) > 1)
    if abs(difference) < 1e-9:
        return 0.0
    return difference / math.sqrt(variance) if variance > 0 else math.inf


def _text(values: list[float]) -> str:
    error = statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else 0.0
    return f"{statistics.fmean(values):.2f} ± {error:.2f}"
