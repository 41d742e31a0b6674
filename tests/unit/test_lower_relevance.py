import re

import pytest
from acting import acting
from places import BUNDLES
from projects import bundle_project

from aos_protocol.documents import Project
from aos_solver.emission.lowering.relevance import (
    certain_rewards,
    irrelevant_variables,
    sensing_draws,
    skills_alike,
)

HOME = """project: test
horizon: 3
discount: 0.9
define_type: Cup
variable: bool full false
variable: int marks 0
state_variable: Cup cup
state_variable: int level
state_variable: int known
state_variable: int count
state_variable: int row []
code:
state.row = {1, 2};
reward_code:
if (state.level > 3) {
    __reward = 10;
    __isGoalState = true;
}
"""


def idle(act: str, extrinsic: str = "", policy: str = "") -> set[str]:
    """Returns those of `known`, `count`, `row` and `cup` that do not matter; `level` always does."""
    rollout = f"rollout_policy:\n{policy}\n" if policy else ""
    irrelevant = irrelevant_variables(acting(HOME, act, extrinsic=extrinsic, before=rollout))
    assert "level" not in irrelevant
    return set(irrelevant)


ALL = {"known", "count", "row", "cup"}


@pytest.mark.parametrize(
    ("act", "matters"),
    [
        ("state__.level = state.level + 1;", set()),
        ("state__.known += 1; state__.count = state.known;", set()),
        ("int sum = state.known + 1; state__.count = std::clamp(sum, 0, 3);", set()),
        ("for (int i = 0; i < 2; i++) state__.row[i] = state.count;", set()),
        ("state__.row.push_back(state.known);", set()),
        ("Cup& cup = state__.cup; cup.marks = state.known;", set()),
        ("if (state.known > 2) { if (state.count) state__.level++; }", {"known", "count"}),
        ("for (int i = 0; i < state.known; i++) state__.level += i;", {"known"}),
        ("while (state__.count-- > 0) state__.level++;", {"count"}),
        ("switch (state.known) { case 1: state__.level = 2; break; default: break; }", {"known"}),
        ("state__.row[state.known] = 1; state__.level = state.row[0];", {"known", "row"}),
        ("for (int n = state.known; int value : state.row) state__.level += n * value;", {"known", "row"}),
        ("for (int& r : state__.row) { r = state.known; } state__.level = state.row[1];", {"known", "row"}),
        ("auto at = state__.row.begin(); *at = state.known; __reward = state__.row[0];", {"known", "row"}),
        ("state__.level = state.cup.full ? 1 : 2;", {"cup"}),
        ("__reward = state.known;", {"known"}),
        ("__moduleResponse = done; if (state.known) return; state__.level = 1;", {"known"}),
        ("bool moves = AOS.Bernoulli(state.known ? 0.5 : 1); if (moves) state__.level++;", {"known"}),
        ("auto grow = [&](int by) { state__.level += by; }; grow(state.known);", {"known"}),
        ("std::swap(state__.level, state__.known);", {"known"}),
        ("AOS.Initialize(state__.known); state__.level = state__.known;", {"known"}),
        ("state__ = state;", ALL),
        ("int sum = std::accumulate(state.row.begin(), state.row.end(), 0); __reward = sum;", {"row"}),
        ("state__.level = state__.known = state.count;", {"known", "count"}),
        ("int was = state.known; { int now = was + 1; if (now > 3) __reward = -1; }", {"known"}),
        ("for (Cup* cup : state__.CupObjects) cup->marks = state.known; __reward = state__.cup.marks;",
         {"known", "cup"}),
        ("vector<Cup*> all; for (auto c : state__.CupObjects) all.push_back(c); for (auto one : all)"
         "one->full = state.known; if (state__.cup.full) __reward = 1;", {"known", "cup"}),
        ("auto pay = [&] { __reward = 5; }; if (state.known) pay();", {"known"}),
        ("vector<std::function<void()>> all{[&] { __reward = 1; }}; if (state.known) all[0]();", {"known"}),
        ("int& level(state__.level); level = state.known;", {"known"}),
        ("int* level(&state__.level); *level = state.known;", {"known"}),
        ("int sum = 0; auto [a, b] = std::tie(sum, state.level); a = state.known; __reward = sum;",
         {"known"}),
        ("int sums[2] = {}; auto sum = sums + 1; *sum = state.known; __reward = sums[1];", {"known"}),
        ("struct Sum { int& n; }; int all = 0; Sum sum{all}; sum.n = state.known; __reward = all;",
         {"known"}),
        ("vector<int>::iterator at; at = state__.row.begin(); *at = state.known; __reward = state__.row[0];",
         {"known", "row"}),
        ("std::stringstream text; text << state.known; int n; text >> n; __reward = n;", {"known"}),
    ],
)  # fmt: skip
def test_a_variable_matters_if_what_is_earned_or_observed_may_depend_on_it(act, matters):
    assert idle(act) == ALL - matters


def test_what_the_rollout_policy_reads_does_not_matter():
    assert idle("state__.known = state.level;", policy="__heuristicValue = state.known;") == ALL


def test_extrinsic_changes_count():
    assert idle("", extrinsic="if (state.known) state_.level = state.count;") == {"row", "cup"}


def test_code_that_cannot_be_read_makes_everything_matter():
    assert idle("state__.count = = 1;") == set()


def test_what_a_rover_has_learnt_for_its_rollouts_matters_to_nobody():
    project = bundle_project(BUNDLES / "bench" / "rocksample-7-8")
    assert {"worth", "unsampled", "promising", "looking_good"} <= irrelevant_variables(project)
    assert not {"x", "y", "is_good", "has_left"} & irrelevant_variables(project)


def shaping(act: str) -> list[bool]:
    """Returns for each draw of a dynamic model, in order, whether it is known to shape only what is
    observed."""
    project = acting(HOME, act)
    (snippet,) = [part.code for part in project.skills[0].model.dynamic_model if part.code is not None]
    starts = sensing_draws(project)[snippet]
    return [at.start() in starts for at in re.finditer(r"AOS(Utils::|\.)", snippet.code)]


NOISE = "state__.level = state.level; if (AOS.Bernoulli(0.2)) __moduleResponse = done;"


@pytest.mark.parametrize(
    ("act", "expected"),
    [
        (NOISE, [True]),
        ("__moduleResponseStr = to_string(int(AOS.SampleNormal(state.level, 2)));", [True]),
        (
            "double noise = AOS.SampleNormal(0, 1); int heard = int(noise); __moduleResponseStr += heard;",
            [True],
        ),
        ("if (AOS.Bernoulli(0.5)) __moduleResponse = AOSUtils::SampleDiscrete({0.5, 0.5});", [True, True]),
        ("int known = AOS.SampleDiscrete({0.5, 0.5}); state__.known = known;", [True]),
        ("if (AOS.Bernoulli(0.5)) state__.level++; __moduleResponse = AOS.Bernoulli(0.1);", [False, True]),
        ("__moduleResponse = AOS.Bernoulli(0.5); state__.level += __moduleResponse;", [False]),
        ("bool seen = AOS.Bernoulli(0.5); while (seen) __moduleResponse = done;", [False]),
        ("double x; do { x = AOS.SampleNormal(0, 1); } while (x < 0); __moduleResponse = int(x);", [False]),
        ("int n = AOS.SampleDiscrete({0.5, 0.5}); for (int i = 0; i < n; i++) state__.known = 1;", [False]),
        ("if (AOS.Bernoulli(0.5)) return; __moduleResponse = done;", [False]),
        ("std::vector<int> v{1}; v.push_back(AOS.Bernoulli(0.5)); state__.level = v.back();", [False]),
        ("auto f = [&] { return AOS.Bernoulli(0.5); }; state__.level = f();", [False]),
        ("auto round = [&](int n) { state__.level += n; return n; };"
         "if (AOS.Bernoulli(0.5)) { int n = round(1); }", [False]),
        ("using Place = int&; Place level = state__.level; level = AOS.Bernoulli(0.5);", [False]),
        ("decltype(auto) most = (state__.level); most = AOS.Bernoulli(0.5);", [False]),
        ("std::pair<int&, int&> both{state__.level, state__.known}; auto [level, known] = both;"
         "level = AOS.Bernoulli(0.5);", [False]),
    ],
)  # fmt: skip
def test_a_draw_shapes_only_observations_where_nothing_else_can_depend_on_it(act, expected):
    assert shaping(act) == expected


@pytest.mark.parametrize(
    ("act", "are_alike"),
    [
        ("__moduleResponse = state.row[at] > 1 ? done : NULL; __reward = -1;", True),
        ("__moduleResponse = AOS.Bernoulli(at == 1 ? 0.9 : 0.5);", True),
        ("state__.count = at; __reward = -state.level;", True),
        ("__reward = at == 1 ? -2 : -1;", False),
        ("state__.level += at;", False),
        ("state__.row[at] = 7; state__.level = state.row[0];", False),
        ("for (int i = 0; i < at; i++) __reward--;", False),
        ("if (at == 1) return; __reward = -1;", False),
        ("int* place = &at; state__.level += *place;", False),
    ],
)
def test_groundings_are_alike_where_parameters_shape_only_what_is_observed(act, are_alike):
    assert looking(act) == ({"act"} if are_alike else set())


def test_groundings_differ_where_the_precondition_or_the_world_asks_for_them():
    look = "__moduleResponse = state.row[at] > 1 ? done : NULL;"
    assert looking(look, extrinsic="state_.level += 1;") == {"act"}
    assert looking(look, extrinsic="if (act != NULL) state_.level += act.at;") == set()
    assert looking(look, precondition="__meetPrecondition = at < 1;") == set()
    assert looking(look, precondition="__meetPrecondition = state.level < 1;") == {"act"}


@pytest.mark.parametrize(
    ("act", "is_certain"),
    [
        ("__moduleResponse = AOS.Bernoulli(0.9); __reward = -state.level;", True),
        ("state__.count = AOS.Bernoulli(0.9); __reward = -1;", True),
        ("__reward = AOS.Bernoulli(0.9) ? -1 : -2;", False),
        ("__reward = AOS.SampleNormal(-1, 0.5);", False),
        ("auto& dice = AOS; __reward = dice.Bernoulli(0.9);", False),
        ("state__.level = AOS.Bernoulli(0.9);", False),
        ("bool hit = AOS.Bernoulli(0.9); __moduleResponse = hit; if (hit) __reward = -1;", False),
    ],
)
def test_a_reward_is_certain_where_draws_shape_only_what_is_observed(act, is_certain):
    assert certain(grounded(act)) == ({"act"} if is_certain else set())


def test_no_reward_is_certain_where_the_world_draws():
    assert certain(grounded("__reward = -1;", extrinsic="state_.level += 1;")) == {"act"}
    assert certain(grounded("__reward = -1;", extrinsic="state_.level += AOS.Bernoulli(0.5);")) == set()


def certain(project: Project) -> frozenset[str]:
    return certain_rewards(project, sensing_draws(project))


def looking(act: str, extrinsic: str = "", precondition: str = "") -> frozenset[str]:
    return skills_alike(grounded(act, extrinsic, precondition))


def grounded(act: str, extrinsic: str = "", precondition: str = "") -> Project:
    before = (
        "parameter: int at\navailable_parameters_code:\n__possibleParameters.push_back(std::make_tuple(0));\n"
    )
    if precondition:
        before += f"precondition:\n{precondition}\nviolate_penalty: -5\n"
    return acting(HOME, act, extrinsic=extrinsic, before=before)
