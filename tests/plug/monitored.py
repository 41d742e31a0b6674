"""The steps of a mission in which what a monitor heard is in the belief before the next decision.

A real system runs: `aos-up` with a robot whose skills publish the battery's level at random moments, some
just before they end. The journal is held against what the robot sent, and beliefs against Bayes' rule.
"""

import argparse
import asyncio
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import msgspec

from aos_deploy.places import cache_dir
from aos_language.load import load_bundle
from aos_protocol.messages import BeliefSummary, DecisionRecord
from aos_runtime.disk.journal import Journal
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine
from aos_solver.mission.memory import MissionMemory, folded
from aos_solver.mission.past import Evidence, Past, replayed

BUNDLE = Path(__file__).parents[1] / "data" / "bundles" / "battery"

ROBOT = """
import asyncio, json, random

numbers = random.Random(5)

async def _move(call):
    levels = []
    for _ in range(numbers.randrange(4)):
        await asyncio.sleep(numbers.choice((0.0, 0.001, 0.01)))
        levels.append(numbers.choice((0.15, 0.5, 0.9)))
        call.publish("/battery", level=levels[-1])
    with open("sent.jsonl", "a") as file:
        file.write(json.dumps([call.id.step, levels]) + "\\n")

async def go(call):
    await _move(call)
    return {"there": False}

async def charge(call):
    await _move(call)
"""
DEPLOY = """\
aos: 1
robot: rover
project: battery
bundles: [battery]
bus: {{listen: tcp/127.0.0.1:0}}
mission: {{step_limit: {steps}, stop_below_value: -1000}}
solver: {{simulations: 50, seed: 1}}
bind:
  /go: {{python: robot.py:go}}
  /charge: {{python: robot.py:charge}}
runs: runs
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--steps", type=int, default=1000, metavar="N")


def measure(options: argparse.Namespace) -> int:
    """Prints the figures; 1 where one observation was late or one belief is another."""
    with tempfile.TemporaryDirectory(prefix="aos-plug-") as name:
        folder = Path(name)
        shutil.copytree(BUNDLE, folder / "battery")
        (folder / "robot.py").write_text(ROBOT)
        (folder / "rover.yaml").write_text(DEPLOY.format(steps=options.steps))
        up = Path(sys.executable).with_name("aos-up")
        with (folder / "up.log").open("w") as log:
            subprocess.run([up, "rover.yaml", "--json"], cwd=folder, stdout=log, stderr=log, check=False)
        try:
            return asyncio.run(_judge(folder, options.steps))
        except OSError:
            print((folder / "up.log").read_text()[-2000:])
            raise


async def _judge(folder: Path, steps: int) -> int:
    sent = dict(json.loads(line) for line in (folder / "sent.jsonl").read_text().splitlines())
    with Journal.read(folder / "runs" / "latest" / "journal.db") as journal:
        rows = list(journal.rows())
    memory = folded(rows)
    records = [
        msgspec.json.decode(row.payload, type=DecisionRecord) for row in rows if row.kind == "decision"
    ]
    observed = [record for record in records if record.outcome is not None]
    decided = {record.step: record for record in records if record.outcome is None}
    beliefs = await _beliefs(memory)
    in_time = by_bayes = heard = 0
    for record, belief in zip(observed, beliefs, strict=True):
        levels = sent[record.step]
        heard += bool(levels)
        due = {"battery": "low" if levels[-1] < 0.2 else "fine"} if levels else {}
        assert record.outcome is not None
        in_time += record.outcome.monitors == due
        following = decided.get(record.step + 1)
        by_bayes += record.belief == belief and (following is None or following.belief == belief)
    print(f"{len(observed)} steps, the monitor heard something in {heard} of them")
    print(f"its newest response, or none, came with the outcome in {in_time} of {len(observed)}")
    print(f"the next decision was for the posterior given all of it in {by_bayes} of {len(observed)}")
    return int(len(observed) < steps or min(in_time, by_bayes) < len(observed))


async def _beliefs(memory: MissionMemory) -> list[BeliefSummary]:
    """The posterior after each step, by another engine."""
    project = load_bundle(BUNDLE).project
    assert project is not None
    built = await build_project(project, cache_dir())
    engine = await Engine.start(built, seed=1)
    past = Past()
    past.steps += [
        Evidence(
            step.decision.action,
            step.decision.skill,
            step.outcome.response,
            step.outcome.local_variables,
            monitors=step.outcome.monitors,
        )
        for step in memory.steps
    ]
    try:
        return [update.summary async for update in replayed(engine, past)]
    finally:
        await engine.close()
