import re

import pytest
from acting import acting

from aos_solver.emission.lowering.averages import averaged_draws

HOME = """project: test
horizon: 3
discount: 0.9
state_variable: int level
initial_belief:
state.level = int(AOS.SampleUniform(0, 3));
"""


def averaged(act: str, extrinsic: str = "", special: str = "") -> list[bool]:
    project = acting(HOME, act, extrinsic=extrinsic, special=special)
    (snippet,) = [part.code for part in project.skills[0].model.dynamic_model if part.code is not None]
    starts = averaged_draws(project).get(snippet, frozenset())
    return [at.start() in starts for at in re.finditer(r"AOS(Utils::|\.)", snippet.code)]


@pytest.mark.parametrize(
    ("act", "expected"),
    [
        ("__reward = -AOS.SampleNormal(10, 2);", [True]),
        ("__reward = 5 + 2 * (AOSUtils::SampleUniform(0, 1) - state.level) / 4;", [True]),
        ("double cost = AOS.SampleNormal(10, 2); __reward -= cost;", [True]),
        ("const double cost = AOS.SampleNormal(10, 2); auto more = cost + 1; __reward = -more;", [True]),
        ("if (state.level) __reward = -AOS.SampleNormal(3, 1); else __reward = -1;", [True]),
        ("__reward = state.level ? AOS.SampleNormal(3, 1) : 2;", [True]),
        ("for (int i = 0; i < 3; i++) __reward += AOS.SampleNormal(i, 1);", [True]),
        ("__reward = AOS.SampleNormal(1, 1) * AOS.SampleNormal(2, 1);", [True, True]),
        ("// the way: ü\n__reward = -AOS.SampleNormal(10, 2)", [True]),
        ("__reward = -1 / AOS.SampleNormal(10, 2);", [False]),
        ("double x = AOS.SampleNormal(0, 1); __reward = x * x;", [False]),
        ("double x = AOS.SampleNormal(0, 1); double y = x + 1; __reward = x * (3 - y);", [False]),
        ("__reward = max(0.0, AOS.SampleNormal(0, 1));", [False]),
        ("int x = AOS.SampleNormal(0, 1); __reward = x;", [False]),
        ("__reward = AOS.SampleNormal(0, 1) > 0 ? 1 : 2;", [False]),
        ("double x = AOS.SampleNormal(0, 1); if (x > 0) __reward = x;", [False]),
        ("double x = AOS.SampleNormal(0, 1); x = x * x; __reward = x;", [False]),
        ("double x = AOS.SampleNormal(0, 1); double& y = x; y = y * y; __reward = x;", [False]),
        ("double x = AOS.SampleNormal(0, 1); __reward = x; state__.level = int(x);", [False]),
        ("double x = AOS.SampleNormal(0, 1); auto f = [&] { return x * x; }; __reward = f();", [False]),
        ("__reward = AOS.SampleNormal(AOS.SampleNormal(0, 1), 1);", [True, False]),
        ("state__.level = int(AOS.SampleNormal(0, 1)); __reward = AOS.SampleNormal(0, 1);", [False, True]),
        ("__reward = AOS.SampleNormal(0, 1); if (__reward < 0) state__.level = 1;", [False]),
        ("__reward = AOS.SampleNormal(0, 1); __reward *= __reward;", [False]),
        ("__reward = AOS.Bernoulli(0.5) + AOS.SampleNormal(0, 1);", [False, True]),
    ],
)
def test_a_draw_counts_by_its_mean_where_the_reward_is_linear_in_it_and_nothing_else_sees_it(act, expected):
    assert averaged(act) == expected


def test_code_elsewhere_that_looks_at_the_reward_is_reckoned_with():
    act = "__reward = AOS.SampleNormal(0, 1);"
    assert averaged(act, extrinsic="__reward -= 1;") == [True]
    assert averaged(act, extrinsic="if (__reward < 0) state_.level = 1;") == [False]
    assert averaged(act, special="if (state.level > 2) __reward = 5;") == [True]
