import os
import pty
import random
import socket
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any

import msgspec
import numpy as np
import pytest
from places import DEPLOY
from processes import HANG_S

from aos_skills.pybullet.world_file import load_world_file
from aos_skills.pybullet.worlds.tictactoe import KIND, rules
from aos_skills.pybullet.worlds.tictactoe.file import FaultModel, TicTacToeFile
from aos_skills.pybullet.worlds.tictactoe.person import PersonAtTerminal
from aos_skills.pybullet.worlds.tictactoe.reading import board_in
from aos_skills.pybullet.worlds.tictactoe.world import TicTacToe

pytestmark = pytest.mark.physics

Make = Callable[..., TicTacToe]


@pytest.fixture
def file() -> TicTacToeFile:
    room: TicTacToeFile = load_world_file(DEPLOY / "worlds/tictactoe.yaml").room
    return room


@pytest.fixture
def make(file: TicTacToeFile) -> Make:
    def build(**changes: Any) -> TicTacToe:
        return TicTacToe(msgspec.structs.replace(file, **changes), seed=1)

    return build


def call(world: TicTacToe, path: str, fields: dict[str, Any] | None = None) -> dict[str, Any]:
    world.begin()
    answer = KIND.skills[path](world, fields or {})
    world.stop()
    return answer


def test_what_the_pen_drew_and_the_other_one_marked_is_read_from_the_picture(make: Make):
    world = make()
    assert call(world, "/draw", {"cell": 0}) == {"success": True}
    assert call(world, "/draw", {"cell": 5})["success"]
    board = call(world, "/look")["board"]
    assert board == world.marks
    assert board.count("X") == 1
    assert [cell for cell in range(9) if board[cell] == "O"] == [0, 5]


def test_a_pen_that_does_not_write_leaves_the_middle_empty(make: Make):
    world = make(faults=FaultModel(dry_centre=1.0))
    assert not call(world, "/draw", {"cell": 4})["success"]
    assert board_in(world.picture()) == rules.EMPTY_BOARD
    assert not world.is_robots_turn


def test_whether_a_circle_is_there_is_told_by_a_picture_and_not_by_the_ink(make: Make):
    world = make()
    picture, hidden = world.picture, []

    def behind_a_hand() -> Any:
        hidden.append(picture())
        return np.full_like(hidden[-1], 90)

    world.picture = behind_a_hand
    assert call(world, "/draw", {"cell": 0}) == {"success": False}
    assert world.marks[0] == "O"
    assert board_in(hidden[0]) == world.marks


def test_the_other_one_may_begin(make: Make):
    world = make(begins="person")
    board = call(world, "/look")["board"]
    assert board.count("X") == 1
    assert board.count("O") == 0


def test_boards_are_read_right_in_any_light_from_about_anywhere(file: TicTacToeFile):
    for seed in range(6):
        world = TicTacToe(file, seed)
        chance = random.Random(seed)
        marks = list(rules.EMPTY_BOARD)
        for cell in chance.sample(range(9), chance.randint(0, 9)):
            marks[cell] = chance.choice("OX")
            (world.board.circle if marks[cell] == "O" else world.board.cross)(cell, chance)
        world.marks = "".join(marks)
        assert board_in(world.picture()) == world.marks
        world.scene.close()


def test_a_picture_without_a_board_has_none():
    assert board_in(np.full((360, 480, 3), 90, np.uint8)) is None


def test_marks_may_be_there_before_the_game(make: Make):
    world = make(moves_made={3: 1.0})
    assert sorted(world.marks.replace("?", "")) == ["O", "X", "X"]
    before = world.marks
    assert call(world, "/look")["board"] == before


def test_a_cell_that_is_none_is_refused(make: Make):
    with pytest.raises(ValueError, match="there is no cell 9"):
        call(make(), "/draw", {"cell": 9})


def test_a_perfect_player_never_loses():
    chance = random.Random(1)
    for _ in range(50):
        board, mark = rules.EMPTY_BOARD, "O"
        while not rules.is_over(board):
            cells = rules.empty_cells(board) if mark == "O" else rules.best_moves(board, "X")
            board, mark = rules.marked(board, chance.choice(cells), mark), "X" if mark == "O" else "O"
        assert rules.winner(board) != "O"


@pytest.mark.parametrize(
    ("board", "ended", "won"),
    [
        ("OOO?XX??X", False, None),
        ("OOOXXOOXX", True, "O"),
        ("XXOOXOXOX", True, None),
        ("XXOXOOXOX", True, "X"),
    ],
)
def test_by_the_rules_for_corners_the_board_is_filled_and_pairs_count(board, ended, won):
    assert (rules.is_over(board, "corners"), rules.winner(board, "corners")) == (ended, won)


def test_a_perfect_player_of_corners_takes_the_last_pair():
    assert rules.best_moves("XO?XOOOXX", "X", "corners") == [2]
    assert rules.best_moves("?O?XOXOXO", "X", "corners") == [0, 2]


def test_by_the_rules_for_corners_somebody_draws_after_three_in_a_row(make: Make):
    world = make(rules="corners")
    world.marks, world.is_robots_turn = "OOO?X???X", False
    call(world, "/look")
    assert world.marks.count("X") == 3
    world = make()
    world.marks, world.is_robots_turn = "OOO?X???X", False
    call(world, "/look")
    assert world.marks.count("X") == 2


def test_a_person_is_asked_until_they_name_an_empty_cell(make: Make):
    world = make()
    person = PersonAtTerminal(0, world.scene)
    said: list[str] = []

    def sit_at_the_terminal():
        with socket.create_connection(("127.0.0.1", person.port), timeout=HANG_S) as terminal:
            for answer in ("10", "1", "2"):
                said.append(terminal.recv(1000).decode())
                terminal.sendall(answer.encode() + b"\n")

    thread = threading.Thread(target=sit_at_the_terminal)
    thread.start()
    cell = person("O????????")
    thread.join(30)
    person.close()
    assert cell == 1
    board, asked = "\nO 2 3\n4 5 6\n7 8 9\n", "Your cell (2, 3, 4, 5, 6, 7, 8, 9): "
    assert said == [
        board + asked,
        f"{board}'10' is no cell that is free.\n{asked}",
        f"{board}'1' is no cell that is free.\n{asked}",
    ]


@pytest.mark.parametrize(
    ("marks", "skill", "last"),
    [
        ("OO?XX?XOX", "/draw", "O O O\nX X 6\nX O X\nThe robot has won."),
        ("OO?XX??OX", "/look", "O O 3\nX X X\n7 O X\nYou have won."),
    ],
)
def test_play_shows_a_person_the_last_board_and_who_has_won(make: Make, marks, skill, last):
    world = make(opponent="person", port=0)
    person = world._opponent
    assert isinstance(person, PersonAtTerminal)
    world.marks, world.is_robots_turn = marks, skill == "/draw"
    command = [sys.executable, "-m", "aos_skills.pybullet.worlds.tictactoe.play", "--port", str(person.port)]
    playing = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert playing.stdout is not None
    assert any(line.startswith("Connected.") for line in playing.stdout)
    playing.stdin.write("6\n")
    playing.stdin.flush()
    call(world, skill, {"cell": 2} if skill == "/draw" else {})
    world.close()
    try:
        said, _ = playing.communicate("9\n", timeout=HANG_S)
    finally:
        playing.kill()
    assert last in said
    assert said.rstrip().endswith("The game has ended.")
    assert "Traceback" not in said
    assert playing.returncode == 0


def test_a_person_who_ends_the_terminals_input_leaves():
    ours, theirs = pty.openpty()
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(HANG_S)
        port = str(listener.getsockname()[1])
        command = [sys.executable, "-m", "aos_skills.pybullet.worlds.tictactoe.play", "--port", port]
        playing = subprocess.Popen(command, stdin=theirs, stdout=subprocess.PIPE, text=True)
        try:
            world, _ = listener.accept()
            with world:
                os.write(ours, b"\x04")
                said, _ = playing.communicate(timeout=HANG_S)
        finally:
            playing.kill()
            os.close(ours)
            os.close(theirs)
    assert (playing.returncode, said.splitlines()[-1]) == (0, "You have left; somebody else may connect.")
