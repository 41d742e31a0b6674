"""Bundles from the documents to 1,000 simulated steps: does each load, lint, emit, compile and run?

python tests/play_bundles.py FOLDER... [--steps N] [--seed N] [--json]

Each FOLDER holds bundles, or is one. A step is a random action in a world that the documents' own model
makes, with the belief update for what came back: the model cannot hold that impossible. Exit code 1 where a
bundle does not come through.
"""

import argparse
import asyncio
import json
import random
import sys
import time
from pathlib import Path

import msgspec

from aos_deploy.program import cache_dir
from aos_language.load import LoadedBundle, load_bundle
from aos_protocol.diagnostics import has_errors
from aos_protocol.errors import AosError
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine


class Played(msgspec.Struct, kw_only=True):
    """The progress of a bundle through its checks, its build and its missions; `fault` is empty where it
    came through."""

    bundle: str
    findings: int
    lint_s: float
    compile_s: float = 0.0
    actions: int = 0
    steps: int = 0
    episodes: int = 0
    max_states: int = 0
    impossible_observations: int = 0
    fault: str = ""


def bundles_in(folder: Path) -> list[Path]:
    """The folder itself if it is a bundle, else the bundles right below it."""
    if load_bundle(folder).files:
        return [folder]
    below = sorted(path for path in folder.iterdir() if path.is_dir())
    return [path for path in below if load_bundle(path).files]


async def play_bundle(folder: Path, *, steps: int, seed: int) -> Played:
    """One bundle through every stage; what its documents do wrong ends in `fault`."""
    start = time.perf_counter()
    loaded = load_bundle(folder)
    played = Played(bundle=folder.name, findings=len(loaded.diagnostics), lint_s=time.perf_counter() - start)
    try:
        await _play(loaded, played, steps, seed)
    except AosError as error:
        played.fault = str(error)
    return played


async def _play(loaded: LoadedBundle, played: Played, steps: int, seed: int) -> None:
    if loaded.project is None or has_errors(loaded.diagnostics):
        played.fault = next(
            (str(finding.message) for finding in loaded.diagnostics if finding.is_error), "no project"
        )
        return
    start = time.perf_counter()
    built = await build_project(loaded.project, cache_dir())
    played.compile_s = time.perf_counter() - start
    engine = await Engine.start(built, seed=seed)
    try:
        await _walk(engine, played, steps, random.Random(seed))
    finally:
        await engine.close()


async def _walk(engine: Engine, played: Played, steps: int, draws: random.Random) -> None:
    actions = engine.description.actions
    played.actions = len(actions)
    ending = "all over"
    while played.steps < steps:
        if ending:
            await engine.reset_belief()
            ending = (await engine.reset_world(draws.randrange(2**31))).ending
            played.episodes += 1
            if ending and played.episodes > steps:
                played.fault = "every initial state is an end"
                return
            continue
        index = draws.randrange(len(actions))
        step = await engine.step_world(index)
        update = await engine.update(actions[index].name, step.response)
        played.steps += 1
        played.max_states = max(played.max_states, update.summary.states)
        played.impossible_observations += update.is_impossible
        ending = step.ending


def main() -> int:
    """The command; a line for each bundle."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER")
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true", help="one JSON object for each bundle")
    options = parser.parse_args()
    all_played = []
    for bundle in (bundle for folder in options.folders for bundle in bundles_in(folder)):
        played = asyncio.run(play_bundle(bundle, steps=options.steps, seed=options.seed))
        all_played.append(played)
        sys.stdout.write(json.dumps(msgspec.to_builtins(played)) if options.json else _line(played))
        sys.stdout.write("\n")
        sys.stdout.flush()
    is_well = all(not played.fault and not played.impossible_observations for played in all_played)
    return int(not (all_played and is_well))


def _line(played: Played) -> str:
    verdict = played.fault or f"{played.steps} steps in {played.episodes} episodes"
    if played.impossible_observations:
        verdict += f", {played.impossible_observations} impossible observations"
    figures = (
        f"{played.findings:3} findings in {played.lint_s:5.3f} s, built in {played.compile_s:4.1f} s, "
        f"{played.actions:3} actions, at most {played.max_states:5} states believed"
    )
    return f"{played.bundle:24} {figures}: {verdict}"


if __name__ == "__main__":
    sys.exit(main())
