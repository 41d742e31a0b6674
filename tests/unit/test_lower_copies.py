import pytest
from acting import acting

from aos_solver.emission.lowering.copies import Copies, copies_of

HOME = """project: test
horizon: 3
discount: 0.9
define_type: Cup
variable: bool full false
state_variable: Cup cup
state_variable: int level
state_variable: int other
state_variable: int row []
code:
state.row = {1, 2};
"""


def copies(act: str, extrinsic: str = "") -> Copies:
    project = acting(HOME, act, extrinsic=extrinsic)
    return copies_of(project.skills[0].model, project.environment)


@pytest.mark.parametrize(
    "act",
    [
        "state__.level = state.level + 1;",
        "state__.level += state_.level; state__.other = state.other;",
        "int before = state.level; state__.level = 2; __reward = before;",
        "if (state.level > 1) state__.level = 0; else state__.other = 1;",
        "state__.row[state.row[0]] = state.row[1];",
        "state__.level = 1; __reward = state.other + state__.level;",
        "state__.level = state__.other = state.level + state.other;",
        "for (int i = 0; i < 2; i++) state__.row[i] = state.level;",
        "__reward = state.level;",
        "int n = std::abs(state.level); const bool is_full = state.cup.full; state__.level = is_full + n;",
    ],
)
def test_one_object_does_where_all_is_read_before_it_is_written(act):
    assert copies(act) == Copies(keeps_state=False, keeps_state_=False)


@pytest.mark.parametrize(
    "act",
    [
        "state__.level = 1; __reward = state.level;",
        "state__.level++; __reward = state_.level;",
        "state__.other = (state__.level = 1) + state.level;",
        "for (int i = 0; i < 2; i++) state__.row[i] = state.row[1 - i];",
        "const auto& row = state.row; state__.row[0] = 5; __reward = row[0];",
        "const int* level = &state.level; state__.level = 5; __reward = *level;",
        "auto it = state.row.begin(); state__.row[0] = 5; __reward = *it;",
        "auto level = [&] { return state.level; }; state__.level = 5; __reward = level();",
        "auto& next = state__; next.level = 1; __reward = state.level;",
        "auto raise = [](auto& all) { all.level = 1; }; raise(state__); __reward = state.level;",
        "std::swap(state__.level, state__.other); __reward = state.other;",
        "for (Cup* cup : state__.CupObjects) cup->full = true;\n__reward = state.cup.full;",
        "state__.row.clear(); __reward = state.row.size();",
        "state__ = state; state__.level = state.level;",
        "auto cup = state.CupObjects[0]; state__.cup.full = true; __reward = cup->full;",
        "vector<Cup*> cups = state.CupObjects; state__.cup.full = true; __reward = cups[0]->full;",
        "const int& level(state.level); state__.level = 5; __reward = level;",
        "int& level(state__.level); level = 5; __reward = state.level;",
        "auto [low, high] = std::minmax(state.level, state.other); state__.level = 5; __reward = low;",
        "auto at = std::ranges::find(state.row, 2); state__.row[1] = 5; __reward = *at;",
        "auto turned = state.row | std::views::reverse; state__.row[1] = 5; __reward = *turned.begin();",
        "struct Now { const int& level; }; Now now{state.level}; state__.level = 5; __reward = now.level;",
        "state__.row.flip(); __reward = state.row[0];",
        'std::istringstream("4") >> state__.level; __reward = state.level;',
        "std::span<int> row(state__.row); row[0] = 5; __reward = state.row[0];",
    ],
)
def test_the_old_state_is_kept_where_it_may_be_read_afterwards(act):
    assert copies(act).keeps_state


@pytest.mark.parametrize(
    ("act", "extrinsic", "kept"),
    [
        ("state__.level = state_.level;", "state_.level = state.level;", (False, False)),
        ("__reward = state.level;", "state_.level = 1;", (True, False)),
        ("state__.level = 1; __reward = state_.level;", "state_.other = 1;", (False, True)),
        ("state__.level = 1; __reward = state.level;", "state_.other = 1;", (True, False)),
        ("", "state_.level = 1; __reward = state.level;", (True, False)),
    ],
)
def test_extrinsic_changes_come_between_two_copies(act, extrinsic, kept):
    assert copies(act or "__reward = 1;", extrinsic) == Copies(*kept)
