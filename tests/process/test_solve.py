import asyncio
import re
import subprocess
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from models import engine_of_bundle, engine_of_text
from places import BUNDLES, DATA, PROBLEMS, ROOT
from processes import COMMAND_S

from aos_deploy.places import cache_dir
from aos_lab.formats.graph_writers import c_header, graphviz
from aos_lab.formats.policy_graph import OVER, PolicyGraph, policy_graph
from aos_lab.formats.problem_files import read_problem
from aos_protocol.errors import ModelError, PlanningError
from aos_solver.building.compiler import find_compiler
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission
from aos_solver.offline.alpha_vectors import AlphaVectors
from aos_solver.offline.enumeration import Enumeration, enumerate_model
from aos_solver.offline.explicit_model import ExplicitModel, Ragged, StartBelief, with_stopping
from aos_solver.offline.policy import Policy, PolicyHeader, PolicySearch
from aos_solver.offline.solving import Bounds, Solution, SolvingLimits, solve

QUICK = SolvingLimits(precision=1e-3, cpu_s=1)


@pytest.fixture
def published() -> Path:
    folder = ROOT.parent / "shared" / "problems"
    if not folder.is_dir():
        pytest.skip("needs the published problem files in ../shared/problems, not part of this project")
    return folder


async def solved(model: ExplicitModel, limits: SolvingLimits = QUICK, **options: Any) -> Solution:
    return await solve(model, limits, cache_dir=cache_dir(), **options)


async def enumerated(bundle: Path) -> Enumeration:
    async with engine_of_bundle(bundle) as engine:
        return await enumerate_model(engine)


def saved(found: Enumeration, digest: str, solution: Solution) -> Policy:
    header = PolicyHeader(
        model=found.model.name,
        model_digest=digest,
        discount=found.model.discount,
        lower=solution.bounds.lower,
        upper=solution.bounds.upper,
        actions=found.model.actions,
        states=found.state_texts,
    )
    return Policy(header, solution.vectors)


async def test_bounds_only_come_nearer():
    bounds: list[Bounds] = []
    model = read_problem(PROBLEMS / "rover.pomdpx")
    solution = await solved(model, on_progress=bounds.append)
    assert tuple(bounds) == solution.history
    assert all(a.lower <= b.lower and a.upper >= b.upper for a, b in pairwise(bounds))


@pytest.mark.parametrize(
    ("name", "cpu_s", "lower"),
    [("Tiger", 0.2, 19.371), ("TagAvoid", 2.0, -6.106), ("RockSample_7_8", 6.0, 20.2)],
)
async def test_lower_bounds_are_no_worse_than_the_reference_program_s(published: Path, name, cpu_s, lower):
    """The time of computing is four times as long, since machines differ. What is reached ends it."""
    model = read_problem(published / f"{name}.pomdpx")
    stop = asyncio.Event()

    def look(bounds: Bounds):
        if bounds.lower >= lower:
            stop.set()

    limits = SolvingLimits(cpu_s=cpu_s)
    solution = await solved(model, limits, on_progress=look, stop=stop)
    assert solution.bounds.lower >= lower


async def test_the_graph_of_tag_gives_what_its_bound_promises(published: Path):
    """The graph is evaluated exactly and by other code, so the bound is true."""
    model = read_problem(published / "TagAvoid.pomdpx")
    solution = await solved(model, SolvingLimits(cpu_s=0.5))
    graph = policy_graph(model, solution.vectors, max_nodes=300)
    assert solution.bounds.lower - 0.05 <= graph.value <= solution.bounds.upper


async def test_variables_that_change_nothing_are_left_out(tmp_path):
    folder = DATA / "bundles" / "tiger"
    files = {path.name: path.read_text() for path in folder.iterdir()}
    files["tiger.ef"] += "\nstate_variable: int listened\n\nstate_variable: bool heard []\n"
    files["tiger.ef"] += "code:\nstate.heard = {false, false};\n"
    files["listen.sd"] += "state__.listened += 1;\nstate__.heard[0] = __moduleResponse == hears_left;\n"
    async with engine_of_text(files) as engine:
        found = await enumerate_model(engine, max_states=50)
        assert found.left_out == ("listened", "heard[0]", "heard[1]")
        assert found.model.size.states == 3
        assert found.state_texts == tuple(dict.fromkeys(found.state_texts))
        assert (found.model.rewards[2] == 0).all()
        solution = await solved(found.model)
        assert solution.bounds.ending == "precision"
        assert solution.bounds.lower == pytest.approx(19.3714, abs=1e-3)
        saved(found, engine.model_digest, solution).save(tmp_path / "tiger.policy")
        search = PolicySearch(policy=Policy.load(tmp_path / "tiger.policy"), simulations=1, seed=1)
        decided = [(await search.run(engine, 1)).best]
        for _ in range(2):
            await engine.update("listen", "hears_left")
            decided.append((await search.run(engine, 1)).best)
    assert [value.action for value in decided] == ["listen", "listen", "open_right"]
    assert decided[0].q == pytest.approx(solution.bounds.lower, abs=1e-3)


async def test_a_policy_decides_online_and_returns_what_it_promises(tmp_path):
    async with engine_of_bundle(BUNDLES / "armadillo-finer") as engine:
        found = await enumerate_model(engine)
        solution = await solved(found.model)
        saved(found, engine.model_digest, solution).save(tmp_path / "a.policy")
        policy = Policy.load(tmp_path / "a.policy")
        limits = MissionLimits(goal_probability=1.0, step_limit=60, stop_below_value=None)
        first = await PolicySearch(policy=policy, simulations=1, seed=1).run(engine, 1)
        returns = []
        for seed in range(100):
            search = PolicySearch(policy=policy, simulations=1, seed=seed)
            returns.append((await simulate_mission(engine, search, limits)).discounted_return)
    error = float(np.std(returns) / len(returns) ** 0.5)
    assert np.mean(returns) == pytest.approx(solution.bounds.lower, abs=4 * error)
    assert first.simulations == 0
    assert {value.action for value in first.actions} == set(found.model.actions)
    assert sum(response.probability for response in first.predicted) == pytest.approx(1)


async def test_a_policy_for_other_documents_is_refused(tmp_path):
    folder = DATA / "bundles" / "tiger"
    found = await enumerated(folder)
    solution = await solved(found.model)
    policy = saved(found, "of yesterday", solution)
    async with engine_of_bundle(folder) as engine:
        search = PolicySearch(policy=policy, simulations=100, seed=1)
        with pytest.raises(PlanningError, match="solved for other documents of tiger") as caught:
            await search.run(engine, 1)
        # Where they have taken over in mid-mission, they are searched.
        plan = await search.after_takeover().run(engine, 1)
    assert caught.value.code == "AOS322"
    assert plan.planner != "policy"


def test_a_file_that_is_no_policy_is_refused(tmp_path):
    (tmp_path / "x.policy").write_text("{}\n")
    with pytest.raises(PlanningError, match="is no policy of this version") as caught:
        Policy.load(tmp_path / "x.policy")
    assert caught.value.code == "AOS321"


def test_a_policy_with_a_flipped_bit_is_refused(tmp_path):
    path = tmp_path / "x.policy"
    header = PolicyHeader(
        model="m", model_digest="d", discount=0.5, lower=1.0, upper=2.0, actions=("go",), states=("here",)
    )
    saved_one = Policy(header, AlphaVectors.of_bytes(1, (), b""))
    saved_one.save(path)
    whole = path.read_bytes()
    assert Policy.load(path).header == saved_one.header
    for place in range(len(whole)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        with pytest.raises(PlanningError):
            Policy.load(path)


async def test_what_is_a_goal_at_the_start_is_part_of_the_start_belief():
    files = {
        "gauge.ef": "project: gauge\nhorizon: 5\ndiscount: 0.95\n\nstate_variable: bool high\n"
        "initial_belief:\nstate.high = AOS.Bernoulli(0.25);\n"
        "reward_code:\nif (state.high) { __reward = 1; __isGoalState = true; }\n",
        "push.sd": "project: gauge\n\ndynamic_model:\nstate__.high = AOS.Bernoulli(0.5);\n",
    }
    async with engine_of_text(files) as engine:
        model = (await enumerate_model(engine)).model
    assert list(model.start_distribution()) == [0.75, 0.25]


async def test_continuous_draws_and_endless_counters_cannot_be_solved_before():
    skill = "project: gauge\n\ndynamic_model:\n{step}\n__reward = state__.level;\n__moduleResponse = high;\n"
    environment = "project: gauge\nhorizon: 5\ndiscount: 0.95\n\nstate_variable: {kind} level\n"
    for kind, step, reason in (
        ("double", "state__.level += AOS.SampleNormal(0, 1);", "a draw is continuous"),
        ("int", "state__.level += 1;", "too many states to list"),
    ):
        files = {"gauge.ef": environment.format(kind=kind), "read.sd": skill.format(step=step)}
        async with engine_of_text(files) as engine:
            with pytest.raises(ModelError, match=reason) as caught:
                await enumerate_model(engine, max_states=50)
        assert caught.value.code == "AOS220"


async def test_rewards_that_cannot_be_added_up_are_refused():
    model = read_problem(PROBLEMS / "tiger.pomdp")
    large = msgspec.structs.replace(model, rewards=model.rewards * 1e306)
    with pytest.raises(PlanningError, match="too large"):
        await solved(large)


async def test_without_a_precision_small_rewards_have_near_bounds():
    model = read_problem(PROBLEMS / "tiger.pomdp")
    small = msgspec.structs.replace(model, rewards=model.rewards * 1e-6)
    bounds = (await solved(small, SolvingLimits(cpu_s=1))).bounds
    assert bounds.lower == pytest.approx(19.3714e-6, abs=1e-7)


@pytest.mark.parametrize(("value", "actions"), [(19.0, {0, 1, 2}), (19.5, {3})])
async def test_a_mission_is_ended_where_that_is_worth_more_than_going_on(value, actions: set[int]):
    model = with_stopping(read_problem(PROBLEMS / "tiger.pomdp"), value)
    solution = await solved(model)
    graph = policy_graph(model, solution.vectors)
    assert {node.action for node in graph.nodes} == actions
    assert graph.value == pytest.approx(max(value, 19.3714), abs=1e-3)


async def test_whoever_stops_it_keeps_the_best_so_far():
    stop = asyncio.Event()
    endless = SolvingLimits(precision=0, cpu_s=1000)
    model = read_problem(PROBLEMS / "tiger.pomdp")
    solution = await solved(model, endless, stop=stop, on_progress=lambda _: stop.set())
    assert solution.bounds.ending == "stopped"
    assert solution.vectors.count > 0


@pytest.fixture
def tiger_graph() -> PolicyGraph:
    model = read_problem(PROBLEMS / "tiger.pomdp")
    return policy_graph(model, asyncio.run(solved(model)).vectors)


def test_the_graph_of_tiger_is_the_well_known_one(tiger_graph: PolicyGraph):
    """Listen until one side was heard twice more often than the other."""
    assert tiger_graph.is_whole
    assert len(tiger_graph.nodes) == 5
    assert tiger_graph.value == pytest.approx(19.3714, abs=2e-4)
    text = graphviz(tiger_graph)
    assert text.count("->") == 8
    assert 'n0 [label="listen", penwidth=2]' in text


WALK = """
#include <stdio.h>
#include "tiger.h"
int main(void) {
  uint16_t node = tiger_start[0];
  int seen;
  printf("%d\\n", tiger_node_action[node]);
  while (node < TIGER_NODES && scanf("%d", &seen) == 1) {
    node = tiger_after(node, (tiger_observation)seen);
    printf("%d\\n", node < TIGER_NODES ? tiger_node_action[node] : -1);
  }
  return 0;
}
"""


def test_the_c_header_needs_nothing_else_and_acts_as_the_graph_does(tiger_graph: PolicyGraph, tmp_path):
    header = c_header(tiger_graph, "Tiger")
    assert re.findall(r"#include .*", header) == ["#include <stdint.h>"]
    (tmp_path / "tiger.h").write_text(header)
    (tmp_path / "walk.c").write_text(WALK)
    compiler = asyncio.run(find_compiler())
    options = ["-x", "c", "-std=c99", "-pedantic-errors", "-Wall", "-Werror"]
    command = [*compiler.command, *options, "walk.c", "-o", "walk"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=COMMAND_S)
    observations = np.random.default_rng(1).integers(0, 2, 500).tolist()
    expected, node = [tiger_graph.nodes[0].action], 0
    for observation in observations:
        node = tiger_graph.nodes[node].next.get(observation, OVER)
        if node == OVER:
            expected.append(-1)
            break
        expected.append(tiger_graph.nodes[node].action)
    walked = subprocess.run(
        [tmp_path / "walk"],
        input=" ".join(map(str, observations)),
        capture_output=True,
        text=True,
        check=True,
    )
    assert [int(line) for line in walked.stdout.split()] == expected


async def test_bounds_that_contradict_each_other_are_an_error_and_never_a_result():
    always = Ragged(np.array([0, 1], np.int64), np.zeros(1, np.int64), np.ones(1))
    no_number = ExplicitModel(
        name="no number", discount=0.9, states=("here",), actions=("wait",), observations=("none",),
        rewards=np.full((1, 1), np.nan), outcomes=always, sensings=np.zeros(1, np.int64), likelihoods=always,
        starts=(StartBelief(1.0, np.zeros(1, np.int64), np.ones(1)),),
    )  # fmt: skip
    with pytest.raises(ModelError, match="AOS216"):
        await solved(no_number, SolvingLimits(cpu_s=0.1))
