"""The Panda, its board, and who plays against it."""

import random
from collections.abc import Callable
from typing import Any

import numpy as np
from PIL import Image

from aos_skills.pybullet.parts.arm import TUCKED
from aos_skills.pybullet.parts.scene import SUN, Camera, Pose, Scene, Vector, photograph
from aos_skills.pybullet.parts.world import Faults, World
from aos_skills.pybullet.robots.panda import PandaWithPen
from aos_skills.pybullet.worlds.tictactoe.board import CENTRE_M, Board
from aos_skills.pybullet.worlds.tictactoe.file import TicTacToeFile
from aos_skills.pybullet.worlds.tictactoe.person import PersonAtTerminal
from aos_skills.pybullet.worlds.tictactoe.rules import (
    EMPTY_BOARD,
    best_moves,
    empty_cells,
    is_over,
    marked,
    winner,
)

CAMERA_M = (1.05, 0.0, 0.55)
PICTURE_SIZE = (480, 360)
FIELD_OF_VIEW_DEG = 42
BOARD_SEEN = Pose((0.72, 0.0, 0.38), (*CENTRE_M, 0.0))
"""The eye and the aim of the record's pictures; the robot looks from elsewhere."""
PERSON_DRAWS_S = 2.0
MIN_INK = 20
"""Contacts of the pen in simulation steps, below which there is no circle."""


class TicTacToe(World):
    """Ink lies where the pen touched the board; the board is read from a picture.

    `marks` is the truth, for the opponent and the record; the robot is not told.
    """

    def __init__(self, file: TicTacToeFile, seed: int) -> None:
        self.file = file
        self.scene = scene = Scene()
        self.faults = Faults(seed)
        self.board = Board(scene)
        self.robot = PandaWithPen(scene)
        self.camera = Camera(scene, Pose((1.4, -0.7, 0.8), (0.2, -0.2, 0.3)), lambda: BOARD_SEEN)
        self._person = random.Random(f"person {seed}")
        self._opponent = opponent(file, self._person, scene)
        self.marks = EMPTY_BOARD
        self.circled: list[int] = []
        """The cells that the robot has marked, in this order."""
        self.is_robots_turn = file.begins == "robot"
        self._inked_steps = 0
        self._is_writing = False
        if file.moves_made:
            (count,) = self._person.choices(list(file.moves_made), list(file.moves_made.values()))
            self._make_moves(count)
        scene.watchers.append(self._leave_ink)

    def close(self) -> None:
        super().close()
        if isinstance(self._opponent, PersonAtTerminal):
            self._tell_person()
            self._opponent.close()

    def stop(self) -> None:
        self.robot.stop()

    def sensors(self) -> dict[str, dict[str, Any]]:
        return {"/joints": {"positions": self.robot.arm.angles}}

    def truth(self) -> dict[str, Any]:
        return {
            "board": self.marks,
            "circled": list(self.circled),
            "winner": winner(self.marks, self.file.rules),
            "is_over": self.is_over,
        }

    @property
    def is_over(self) -> bool:
        """True when the game has ended: then nobody draws any more."""
        return is_over(self.marks, self.file.rules)

    def write(self, way: list[Vector]) -> bool:
        """Leads the pen along a way; whether it has left a line: the truth, which the robot has to see."""
        self._inked_steps, self._is_writing = 0, True
        try:
            self.robot.draw(way)
        finally:
            self._is_writing = False
        return self._inked_steps >= MIN_INK

    def tuck(self) -> None:
        """Moves the arm out of the camera's sight."""
        self.robot.arm.move(TUCKED)

    def let_other_draw(self) -> None:
        """The other one draws a cross; a person may take their time."""
        cell = self._opponent(self.marks)
        self.board.cross(cell, self._person)
        self.marks = marked(self.marks, cell, "X")
        self.is_robots_turn = True
        self.tell_end()
        self.scene.wait(PERSON_DRAWS_S)

    def tell_end(self) -> None:
        """Lets a person know once the game is over."""
        if self.is_over:
            self._tell_person()

    def _tell_person(self) -> None:
        if isinstance(self._opponent, PersonAtTerminal):
            won = winner(self.marks, self.file.rules)
            self._opponent.tell_end(self.marks, won, is_over=self.is_over)

    def picture(self) -> np.ndarray[Any, np.dtype[np.uint8]]:
        """The board as the camera sees it now, from about its place and in about its light: RGB."""
        noise, faults = self.faults.noise, self.file.faults

        def shaken(point: Vector, sigma: float) -> Vector:
            x, y, z = (value + noise.gauss(0, sigma) for value in point)
            return x, y, z

        pose = Pose(
            shaken(CAMERA_M, faults.camera_noise_m),
            shaken((*CENTRE_M, 0.02), faults.camera_noise_m / 2),
            shaken((0.0, 0.0, 1.0), 2 * faults.camera_noise_m),
        )
        image: Image.Image = photograph(
            self.scene, pose, PICTURE_SIZE, sun=shaken(SUN, faults.light), field_of_view_deg=FIELD_OF_VIEW_DEG
        )
        pixels = np.asarray(image, dtype=np.float64)
        grain = np.random.default_rng(noise.getrandbits(32)).normal(0, faults.pixel_noise, pixels.shape)
        return np.clip(pixels + grain, 0, 255).astype(np.uint8)

    def _make_moves(self, count: int) -> None:
        for number in range(count):
            cell = self._person.choice(empty_cells(self.marks))
            mark, put = (("X", self.board.cross), ("O", self.board.circle))[number % 2]
            put(cell, self._person)
            self.marks = marked(self.marks, cell, mark)

    def _leave_ink(self) -> None:
        """Leaves ink where the pen touches the board."""
        if not self._is_writing:
            return
        contacts = self.scene.client.getContactPoints(bodyA=self.robot.pen, bodyB=self.board.body)
        if contacts:
            self._inked_steps += 1
            points = [contact[6][:2] for contact in contacts]
            self.board.ink((sum(x for x, _ in points) / len(points), sum(y for _, y in points) / len(points)))
        else:
            self.board.lift()


def opponent(file: TicTacToeFile, chance: random.Random, scene: Scene) -> Callable[[str], int]:
    """Gives the cell of the next cross on a board."""
    match file.opponent:
        case "random":
            return lambda board: chance.choice(empty_cells(board))
        case "perfect":
            return lambda board: chance.choice(best_moves(board, "X", file.rules))
        case "person":
            return PersonAtTerminal(file.port, scene)
