"""Boards that are read right: `python -m aos_skills.pybullet.worlds.tictactoe.pictures FILE.yaml 200`."""

import argparse
import json
import random
import sys
import time
from pathlib import Path

from PIL import Image

from aos_skills.pybullet.world_file import load_world_file
from aos_skills.pybullet.worlds.tictactoe.file import TicTacToeFile
from aos_skills.pybullet.worlds.tictactoe.reading import board_in
from aos_skills.pybullet.worlds.tictactoe.rules import EMPTY_BOARD
from aos_skills.pybullet.worlds.tictactoe.world import TicTacToe


def random_board(file: TicTacToeFile, seed: int) -> TicTacToe:
    """A world where hands have put a random number of marks on the board."""
    world = TicTacToe(file, seed)
    chance = random.Random(f"board {seed}")
    marks = list(EMPTY_BOARD)
    for cell in chance.sample(range(9), chance.randint(0, 9)):
        marks[cell] = chance.choice("OX")
        (world.board.circle if marks[cell] == "O" else world.board.cross)(cell, chance)
    world.marks = "".join(marks)
    return world


def main() -> None:
    """Takes a picture of each of many random boards, reads it, and prints how many were read right."""
    parser = argparse.ArgumentParser(prog="pictures", description=main.__doc__)
    parser.add_argument("world", type=Path)
    parser.add_argument("pictures", type=int, nargs="?", default=200)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--save", type=Path, help="a folder for the pictures that were read wrong")
    parser.add_argument("--json", action="store_true", help="one JSON object")
    options = parser.parse_args()
    file: TicTacToeFile = load_world_file(options.world).room
    wrong: list[dict[str, object]] = []
    started = time.monotonic()
    for number in range(options.pictures):
        seed = options.first_seed + number
        world = random_board(file, seed)
        picture = world.picture()
        read = board_in(picture)
        if read != world.marks:
            wrong.append({"seed": seed, "board": world.marks, "read": read})
            if options.save:
                options.save.mkdir(parents=True, exist_ok=True)
                Image.fromarray(picture).save(options.save / f"{seed}.png")
        world.scene.close()
        sys.stderr.write(f"\r{number + 1} of {options.pictures} pictures, {len(wrong)} wrong")
    sys.stderr.write("\n")
    right = options.pictures - len(wrong)
    if options.json:
        sys.stdout.write(json.dumps({"pictures": options.pictures, "right": right, "wrong": wrong}) + "\n")
        return
    for mistake in wrong:
        sys.stdout.write(f"seed {mistake['seed']}: {mistake['board']} was read as {mistake['read']}\n")
    sys.stdout.write(f"{right} of {options.pictures} read right, {time.monotonic() - started:.0f} s\n")


if __name__ == "__main__":
    main()
