"""The frequencies of a pick's outcomes: `python -m aos_skills.pybullet.worlds.armadillo.frequencies
WORLD.yaml 60`."""

import json
import sys
from functools import partial
from pathlib import Path

from aos_skills.pybullet.frequencies import counted, pick_options, shares
from aos_skills.pybullet.world_file import load_world_file
from aos_skills.pybullet.worlds.armadillo.navigate import navigate
from aos_skills.pybullet.worlds.armadillo.pick import can_in_reach, pick
from aos_skills.pybullet.worlds.armadillo.world import Armadillo

PLACES = {"easy": (0.0, 2.0, 1.5708), "hard": (0.0, -2.0, -1.5708)}
OUTCOMES = ("held", "held, arm out", "missed", "lost")
SETTLING_S = 1.0


def outcome_of_pick(world_file: Path, table: str, seed: int) -> str:
    """One pick in a fresh room: one of OUTCOMES; a missed can still stands in reach, a lost one does not."""
    world = Armadillo(load_world_file(world_file).room, seed)
    x, y, yaw = PLACES[table]
    world.begin()
    navigate(world, {"x": x, "y": y, "yaw": yaw})
    world.begin()
    answer = pick(world, {})
    world.scene.wait(SETTLING_S)
    if world.is_holding:
        outcome = "held" if answer["success"] else "held, arm out"
    else:
        outcome = "missed" if can_in_reach(world) is not None else "lost"
    world.scene.close()
    return outcome


def main() -> None:
    """Prints the share of each outcome for each table, and says on stderr how far it is."""
    parser = pick_options(main.__doc__)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--json", action="store_true", help="one JSON object with the counts")
    options = parser.parse_args()
    seeds = range(options.first_seed, options.first_seed + options.picks)
    counts = {
        table: counted(partial(outcome_of_pick, options.world, table), seeds, f"{table} table: ")
        for table in PLACES
    }
    if options.json:
        sys.stdout.write(json.dumps({"picks": options.picks, **counts}) + "\n")
        return
    for table, counter in counts.items():
        sys.stdout.write(f"{table} table, {options.picks} picks: {shares(counter, OUTCOMES)}\n")


if __name__ == "__main__":
    main()
