"""How often a pick ends how: `python -m aos_skills.pybullet.frequencies deploy/worlds/armadillo.yaml 60`."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

from aos_skills.pybullet.robot import Robot
from aos_skills.pybullet.scene import Scene
from aos_skills.pybullet.skills import ArmadilloSkills
from aos_skills.pybullet.world_file import load_world_file

PLACES = {"easy": (0.0, 2.0, 1.5708), "hard": (0.0, -2.0, -1.5708)}


def outcome_of_pick(world: Path, table: str, seed: int) -> str:
    """One pick in a fresh room: `held`, `held, arm out` or `not held`."""
    scene = Scene(load_world_file(world))
    robot = Robot(scene, lambda: None)
    skills = ArmadilloSkills(scene, robot, seed)
    x, y, yaw = PLACES[table]
    skills.call("/navigate", {"x": x, "y": y, "yaw": yaw})
    answer = skills.call("/pick", {})
    outcome = "held" if skills.is_holding else "not held"
    scene.close()
    return outcome if answer["success"] else f"{outcome}, arm out"


def main() -> None:
    """Prints the table of outcomes."""
    world, picks = Path(sys.argv[1]), int(sys.argv[2])
    for table in PLACES:
        counts = Counter(outcome_of_pick(world, table, seed) for seed in range(picks))
        shares = ", ".join(f"{outcome} {count / picks:.2f}" for outcome, count in counts.most_common())
        sys.stdout.write(f"{table} table, {picks} picks: {shares}\n")


if __name__ == "__main__":
    main()
