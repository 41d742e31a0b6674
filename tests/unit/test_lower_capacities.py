import pytest

from aos_language.cpp.snippets import read_cpp
from aos_solver.emission.lowering.capacities import GROWING_CAPACITY, REPORTED_CAPACITY, Capacities


def capacities_of(*snippets: str) -> Capacities:
    capacities = Capacities()
    capacities.read_code(read_cpp(code) for code in snippets)
    return capacities


@pytest.mark.parametrize(
    ("code", "capacity"),
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
        ("const int n = 9, m = n * n + 1; state.grid.resize(m);", 82),
        ("vector<int> mine(100, 0); state.grid = mine;", 100),
        ("vector<int> mine{1, 2, 3}, copy = mine; state.far = copy; state.grid = state.far;", 3),
        ("state.grid.reserve(300); state.grid = {};", 300),
        ("state.grid = {f(\"a,}\", '\\''), {1, 2}};", 2),
    ],
)
def test_literal_sizes_give_exactly_their_capacity(code, capacity):
    assert capacities_of(code).capacity("grid") == capacity


def test_the_longest_list_counts_over_all_code():
    assert capacities_of("state.grid = {1};", "state__.grid = {1, 2, 3, 4};").capacity("grid") == 4


def test_nested_lists_give_a_room_for_each_level():
    capacities = capacities_of("state.table = {{1, 2, 3}, {4}};")
    assert (capacities.capacity("table", 0), capacities.capacity("table", 1)) == (2, 3)


@pytest.mark.parametrize(
    ("code", "capacity"),
    [
        ("state.table = {{1, {5, 6, 7}}, {2, {}}};", 3),
        ("state.table = std::map<int, vector<int>>{{1, vector<int>(8)}};", 8),
        ("vector<int> row(70); state.table = {{1, row}};", 70),
    ],
)
def test_values_of_a_map_have_the_room_that_its_list_tells(code, capacity):
    capacities = Capacities(variables=[("table", "std::map<int, vector<int>>")])
    capacities.read_code([read_cpp(code)])
    assert capacities.capacity("table", 1) == capacity


def test_fields_have_the_room_that_lists_of_compounds_tell():
    fields = {"Shelf": [("id", "int"), ("marks", "int[]"), ("spots", "vector<pair<int, vector<int>>>")]}
    capacities = Capacities(variables=[("all", "Shelf[]"), ("one", "Shelf")], compounds=fields)
    capacities.read_default("marks", "{1}")
    capacities.read_code([read_cpp("state.all = {{1, {1, 2, 3}}}; state.one = Shelf{2, {}, {{4, {5, 6}}}};")])
    assert (capacities.capacity("marks"), capacities.capacity("all")) == (3, 1)
    assert (capacities.capacity("spots"), capacities.capacity("spots", 2)) == (1, 2)


def test_nested_vectors_have_the_length_of_what_they_are_made_of():
    capacities = capacities_of("vector<int> row(80); state.a.assign(12, row); state.b = vector<V>(3, V(4));")
    assert (capacities.capacity("a"), capacities.capacity("a", 1)) == (12, 80)


def test_numbers_in_code_that_sets_up_tell_how_far_a_vector_grows():
    code = "const int n = 10; fill(state.row, n * n); fill_n(std::back_inserter(state.row), 1e6, 0.125);"
    grown = Capacities(frozenset({"fill"}))
    grown.read_code([read_cpp(code)], sets_up=True)
    assert grown.capacity("row") == 100
    later = Capacities(frozenset({"fill"}))
    later.read_code([read_cpp(code)])
    assert later.capacity("row") == GROWING_CAPACITY


def test_a_map_grows_where_code_indexes_it():
    capacities = Capacities(variables=[("count", "map<int, int>")])
    capacities.read_code([read_cpp("for (int i = 0; i < 300; i++) state.count[i] = 1;")])
    assert capacities.capacity("count") == 300


def test_a_vector_that_grows_gets_room_to_grow():
    assert capacities_of("state__.path.push_back(x);").capacity("path") == GROWING_CAPACITY
    assert capacities_of("state.path.assign(4 * n, 0);").capacity("path") == GROWING_CAPACITY
    assert capacities_of("state.path = vector<int>(4 + n);").capacity("path") == GROWING_CAPACITY
    assert capacities_of("state.a = {" + "1, " * 39 + "1}; state.a.push_back(2);").capacity("a") == 80


def test_a_vector_grows_through_a_reference_too():
    capacities = capacities_of(
        "state.table = {{1, 2}}; state.path = {1};",
        "vector<int>& path = state__.path; path.push_back(2);",
        "for (auto& row : state__.table) row.push_back(3);",
    )
    assert capacities.capacity("path") == GROWING_CAPACITY
    assert (capacities.capacity("table", 0), capacities.capacity("table", 1)) == (1, GROWING_CAPACITY)


@pytest.mark.parametrize(
    "code",
    [
        "copy(a.begin(), a.end(), std::back_inserter(state__.table[0]));",
        "auto add = [](vector<int>& row) { row.push_back(1); }; add(state__.table[0]);",
        "auto at = state__.table.begin(); at->second.push_back(1);",
        "for (auto& [key, row] : state__.table) row.push_back(key);",
        "for (auto& [key, row] : state__.table) row = {1, 2, 3};",
        "auto* row = &state__.table[0]; row->resize(n);",
        "state__.table.back().push_back(1);",
        "a = std::exchange(state__.table[0], {1, 2, 3});",
    ],
)
def test_a_vector_grows_where_it_is_passed_on_or_pointed_to(code):
    capacities = capacities_of("state.table = {{1, 2}}; state.path = {1};", code)
    assert (capacities.capacity("table", 1), capacities.capacity("path")) == (GROWING_CAPACITY, 1)


@pytest.mark.parametrize(
    "code",
    [
        "vector<int> mine; mine.push_back(state.table[0][0]);",
        "for (auto& row : state__.table) row[0] = 1;",
        "for (auto& [key, value] : state__.table) value = 3;",
    ],
)
def test_a_vector_that_is_only_read_or_set_keeps_its_length(code):
    assert capacities_of("state.table = {{1, 2}};", code).capacity("table", 1) == 2


def test_loop_bounds_tell_how_far_a_vector_grows():
    code = "for (int i = 0; i < 30; i++) for (int j = 0; j < 40; j++) state.cells.push_back(0);"
    assert capacities_of(code).capacity("cells") == 1200


@pytest.mark.parametrize("code", ["", "state.map = {};"])
def test_a_vector_that_the_robots_data_fill_has_room_for_them(code):
    capacities = capacities_of(code)
    capacities.fill_by_report("map")
    assert capacities.capacity("map") == REPORTED_CAPACITY


def test_a_vector_of_data_with_a_length_at_the_start_has_room_for_twice_as_many():
    capacities = capacities_of("state.map = vector<int>(100, -1);")
    capacities.fill_by_report("map")
    assert capacities.capacity("map") == 200


def test_a_vector_that_nothing_fills_still_has_room():
    assert capacities_of("x = 1;").capacity("grid") == GROWING_CAPACITY


@pytest.mark.parametrize(
    "code",
    [
        "vector<vector<int>*> rows{&state__.row, &state__.far}; for (auto row : rows) row->push_back(1);",
        "vector<int>* rows[2]; rows[0] = &state__.row; rows[1] = &state__.far; rows[i]->push_back(1);",
    ],
)
def test_vectors_grow_through_pointers_that_are_kept(code):
    capacities = capacities_of("state.row = {1, 2}; state.far = {3};", code)
    assert [capacities.capacity(name) for name in ("row", "far")] == [GROWING_CAPACITY] * 2


def test_vectors_that_one_pointer_leads_to_are_of_one_type():
    code = "vector<int>* to = &state__.row; if (i > 0) to = &state__.far; to->at(0) = 1;"
    capacities = capacities_of("state.row = {1, 2}; state.far = {3};", code)
    assert [capacities.capacity(name) for name in ("row", "far")] == [2, 2]
