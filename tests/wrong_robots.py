"""Robots that do otherwise than an experiment claims: `python -m tests.wrong_robots turtlebot` in physics.

`wrong_robots.yaml` has one for each claim of each shipped experiment. The claim has to be about its missions,
and may not be seen in them. Those of the model are among the unit tests; those in physics take ten minutes.
"""

from __future__ import annotations

import argparse
import asyncio
import sys
import tempfile
from functools import cache
from itertools import chain
from pathlib import Path

import msgspec
from ruamel.yaml import YAML

from aos_deploy.places import shipped
from aos_lab.trials.claims import Claim, Verdict, asking_the_world, judge
from aos_lab.trials.files import Experiment, Part, read_experiment
from aos_lab.trials.players import ModelMissions, ModelPlayer, ScriptPlayer
from aos_lab.trials.setting import deployment_of, world_deployment_of
from aos_lab.trials.trial import Trial
from aos_solver.child.engine import Engine

_FOLDER = shipped("deploy/experiments")
EXPERIMENTS = sorted(path.stem for path in _FOLDER.glob("*.yaml"))


class WrongRobot(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A robot of `wrong_robots.yaml`; see its head."""

    does: tuple[str, ...] = ()
    believes: str = "scripted"
    plans: tuple[str, ...] = ()
    first_seed: int = 1
    seeds: int = 20
    faults: dict[str, float] = {}
    system_seed: int = 1
    system: WrongRobot | None = None

    @property
    def missions(self) -> range:
        return range(self.first_seed, self.first_seed + self.seeds)


class Wrong(msgspec.Struct, frozen=True):
    """A claim of a part of an experiment, and the robot that does otherwise."""

    experiment: Experiment
    folder: Path
    name: str
    part: Part
    claim: Claim
    robot: WrongRobot | None

    def verdict(self, trials: list[Trial], by: str) -> Verdict:
        truth = self.part.truth or self.experiment.truth
        return judge(asking_the_world(self.claim, by, truth), trials, by)


@cache
def _robots() -> dict[str, dict[str, dict[str, WrongRobot]]]:
    yaml = YAML(typ="safe", pure=True)
    entries = yaml.load((Path(__file__).parent / "wrong_robots.yaml").read_text(encoding="utf-8"))
    return msgspec.convert(entries, dict[str, dict[str, dict[str, WrongRobot]]])


@cache
def wrong_robots(experiment: str) -> tuple[Wrong, ...]:
    path = _FOLDER / f"{experiment}.yaml"
    read = read_experiment(path)
    known = _robots().get(experiment, {})
    return tuple(
        Wrong(read, _FOLDER, f"{experiment}/{name}", part, claim, known.get(name, {}).get(claim.says))
        for name, part in read.parts.items()
        for claim in part.claims
    )


@cache
def _missions(name: str, plans: tuple[str, ...]) -> ModelMissions:
    wrong = next(wrong for wrong in wrong_robots(name.partition("/")[0]) if wrong.name == name)
    with tempfile.TemporaryDirectory() as out:
        own = deployment_of(msgspec.structs.replace(wrong.part, by="model"), wrong.folder, Path(out))
    world = world_deployment_of(wrong.part, own, wrong.folder) or own
    if not plans:
        return ModelMissions.of(world)
    bundles = tuple((wrong.folder / bundle).resolve() for bundle in plans)
    return ModelMissions.of(msgspec.structs.replace(own, bundles=bundles), world)


async def tried_by_model(wrong: Wrong) -> Verdict:
    robot = wrong.robot
    assert robot is not None
    player = await ModelPlayer.prepared(_missions(wrong.name, robot.plans))
    if robot.plans:
        return wrong.verdict([await player.play(seed) for seed in robot.missions], "model")
    async with await Engine.start(player.model, seed=1, keeps_belief=False) as engine:
        trials = [await _scripted(engine, robot, seed) for seed in robot.missions]
    return wrong.verdict(trials, "model")


async def _scripted(engine: Engine, robot: WrongRobot, seed: int) -> Trial:
    indices = {action.name: index for index, action in enumerate(engine.description.actions)}
    ending = (await engine.reset_world(seed)).ending
    responses: list[str] = []
    states: list[str] = []
    for action in robot.does:
        if ending:
            break
        step = await engine.step_world(indices[action])
        ending = step.ending
        responses.append(step.response)
        states.append(await engine.world_state())
    return Trial(
        seed=seed,
        ending=ending or robot.believes,
        goal=ending == "goal",
        actions=robot.does[: len(responses)],
        responses=tuple(responses),
        states=tuple(states),
        world_ending=ending,
    )


async def tried_in_physics(wrong: Wrong, out: Path) -> Verdict:
    assert wrong.robot is not None
    robot = wrong.robot.system or wrong.robot
    setting = msgspec.structs.replace(wrong.part, by="system", faults=robot.faults)
    player = await ScriptPlayer.prepared(deployment_of(setting, wrong.folder, out), robot.does, out)
    try:
        trial = await player.play(robot.system_seed)
    finally:
        await player.close()
    # It says that it has come to its goal, whatever has become of the world.
    says = msgspec.structs.replace(trial, ending=robot.believes, goal=robot.believes == "goal")
    return wrong.verdict([says], "system")


def main() -> None:
    """Tries the robots in physics; the exit code says whether a claim was seen all the same."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("experiments", nargs="*", help="all if none is named")
    options = parser.parse_args()
    are_wrong = True
    with tempfile.TemporaryDirectory() as folder:
        for wrong in chain.from_iterable(map(wrong_robots, options.experiments or EXPERIMENTS)):
            has_world = deployment_of(wrong.part, wrong.folder, Path(folder)).world is not None
            if wrong.claim.only == "model" or not has_world:
                continue
            verdict = asyncio.run(tried_in_physics(wrong, Path(folder)))
            fails = verdict.missions > 0 and verdict.held == 0
            are_wrong = are_wrong and fails
            word = "fails   " if fails else "HOLDS   " if verdict.missions else "NO CASE "
            print(f"{word} {wrong.name}: {wrong.claim.says}", flush=True)
    sys.exit(0 if are_wrong else 1)


if __name__ == "__main__":
    main()
