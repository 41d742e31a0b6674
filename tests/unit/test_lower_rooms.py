"""How much room the vectors of a state get."""

from __future__ import annotations

import pytest

from aos_runtime.snippets import read_cpp
from aos_solver.emission.lower_rooms import GROWING_ROOM, TOLD_ROOM, Rooms


def rooms_of(*snippets: str) -> Rooms:
    rooms = Rooms()
    rooms.read_code(read_cpp(code) for code in snippets)
    return rooms


@pytest.mark.parametrize(
    ("code", "room"),
    [
        ("state.grid = {1, 2, 3};", 3),
        ("state.grid = {f(1, 2), {3}, g};  // {4, 5, 6, 7}", 3),
        ("state.grid = vector<int>(12, 0);", 12),
        ("state.grid = std::vector<bool>{true, false};", 2),
        ("state.grid.resize(20);", 20),
        ("state.grid.assign(6, 0);", 6),
        ("state.grid.assign(4 * 17 * 19, -1);", 1292),
        ("state.grid = vector<int>(3 * 5);", 15),
        ("state.grid = {1, 2}; state__.grid = state.grid;", 2),
        ("state.box.grid = {1, 2, 3, 4}; state.box.grid[2] = 5;", 4),
    ],
)
def test_literal_sizes_give_exactly_their_room(code: str, room: int) -> None:
    assert rooms_of(code).room("grid") == room


def test_the_longest_list_counts_over_all_code() -> None:
    assert rooms_of("state.grid = {1};", "state__.grid = {1, 2, 3, 4};").room("grid") == 4


def test_nested_lists_give_a_room_for_each_level() -> None:
    rooms = rooms_of("state.table = {{1, 2, 3}, {4}};")
    assert (rooms.room("table", 0), rooms.room("table", 1)) == (2, 3)


def test_a_vector_that_grows_gets_room_to_grow() -> None:
    assert rooms_of("state__.path.push_back(x);").room("path") == GROWING_ROOM
    assert rooms_of("state.path.assign(4 * n, 0);").room("path") == GROWING_ROOM
    assert rooms_of("state.path = vector<int>(4 + n);").room("path") == GROWING_ROOM
    assert rooms_of("state.a = {" + "1, " * 39 + "1}; state.a.push_back(2);").room("a") == 80


def test_a_vector_grows_through_a_reference_too() -> None:
    rooms = rooms_of(
        "state.table = {{1, 2}}; state.path = {1};",
        "vector<int>& path = state__.path; path.push_back(2);",
        "for (auto& row : state__.table) row.push_back(3);",
    )
    assert rooms.room("path") == GROWING_ROOM
    assert (rooms.room("table", 0), rooms.room("table", 1)) == (1, GROWING_ROOM)


def test_loop_bounds_tell_how_far_a_vector_grows() -> None:
    code = "for (int i = 0; i < 30; i++) for (int j = 0; j < 40; j++) state.cells.push_back(0);"
    assert rooms_of(code).room("cells") == 1200


@pytest.mark.parametrize("code", ["", "state.map = {};"])
def test_a_vector_that_the_robots_data_fill_has_room_for_them(code: str) -> None:
    rooms = rooms_of(code)
    rooms.tell("map")
    assert rooms.room("map") == TOLD_ROOM


def test_a_vector_of_data_with_a_length_at_the_start_has_room_for_twice_as_many() -> None:
    rooms = rooms_of("state.map = vector<int>(100, -1);")
    rooms.tell("map")
    assert rooms.room("map") == 200


def test_a_vector_that_nothing_fills_still_has_room() -> None:
    assert rooms_of("x = 1;").room("grid") == GROWING_ROOM
