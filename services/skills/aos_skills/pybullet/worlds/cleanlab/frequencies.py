"""The frequencies of a pick's outcomes: `python -m aos_skills.pybullet.worlds.cleanlab.frequencies
FILE.yaml 60`."""

import sys
from functools import partial

from aos_skills.pybullet.frequencies import counted, pick_options, shares
from aos_skills.pybullet.world_file import load_world_file
from aos_skills.pybullet.worlds.cleanlab.file import CleanLabFile
from aos_skills.pybullet.worlds.cleanlab.navigate import navigate
from aos_skills.pybullet.worlds.cleanlab.pick import pick
from aos_skills.pybullet.worlds.cleanlab.world import CleanLab

OUTCOMES = ("held", "missed", "lost")


def outcome_of_pick(file: CleanLabFile, seed: int) -> str:
    """One pick of the first cup in a fresh laboratory: one of OUTCOMES; a missed cup still stands."""
    world = CleanLab(file, seed)
    place = file.stations[next(iter(world.cups))]
    world.begin()
    navigate(world, {"x": place.x, "y": place.y, "yaw": place.yaw})
    world.begin()
    pick(world, {})
    outcome = "held" if world.held_cup else "missed" if world.cup_in_reach() is not None else "lost"
    world.scene.close()
    return outcome


def main() -> None:
    """Prints the share of each outcome, and says on stderr how far it is."""
    options = pick_options(main.__doc__).parse_args()
    file: CleanLabFile = load_world_file(options.world).room
    counts = counted(partial(outcome_of_pick, file), range(options.picks))
    sys.stdout.write(f"{options.picks} picks: {shares(counts, OUTCOMES)}\n")


if __name__ == "__main__":
    main()
