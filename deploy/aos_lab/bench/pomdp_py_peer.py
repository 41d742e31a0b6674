"""pomdp-py, the most used planner in Python, on its own Tiger and RockSample: the peer that pip can install.

Its models are taken as it ships them, RockSample with the layout of RockSample(7, 8). There walls cost
nothing, and play-outs know nothing.
"""

import importlib.util
import itertools
import random
import time
from collections.abc import Callable
from typing import Any

NAME = "pomdp-py"

DEPTH = 90
DISCOUNT = 0.95
PARTICLES = 1000

ROCKS = ((2, 0), (0, 1), (3, 1), (6, 3), (2, 4), (3, 4), (5, 5), (1, 6))


def is_installed() -> bool:
    return importlib.util.find_spec("pomdp_py") is not None


def sampling_rate(problem: str, seconds: float, seed: int) -> float:
    """Steps with random actions, per second of processor time, with a new start every 90 steps."""
    import pomdp_py

    random.seed(seed)
    agent = PROBLEMS[problem]()
    actions = list(agent.policy_model.get_all_actions())
    start_s = time.process_time()
    for count in itertools.count(1):
        if count % DEPTH == 1:
            state = agent.belief.random()
        state = pomdp_py.sample_generative_model(agent, state, random.choice(actions))[0]
        if count % 1000 == 0 and (spent_s := time.process_time() - start_s) >= seconds:
            return count / spent_s
    raise AssertionError("an endless loop has ended")


def search_rate(problem: str, simulations: int, seed: int) -> float:
    """Simulations of its POMCP from a fresh root, per second of processor time."""
    import pomdp_py

    random.seed(seed)
    agent = PROBLEMS[problem]()
    planner = pomdp_py.POMCP(
        max_depth=DEPTH,
        discount_factor=DISCOUNT,
        num_sims=simulations,
        exploration_const=100,
        rollout_policy=agent.policy_model,
    )
    start_s = time.process_time()
    planner.plan(agent)
    return simulations / (time.process_time() - start_s)


def _tiger() -> Any:
    import pomdp_py
    from pomdp_py.problems.tiger.tiger_problem import make_tiger

    agent = make_tiger().agent
    particles = pomdp_py.Particles.from_histogram(agent.belief, num_particles=PARTICLES)
    agent.set_belief(particles, prior=True)
    return agent


def _rocksample() -> Any:
    import pomdp_py
    from pomdp_py.problems.rocksample.rocksample_problem import RockSampleProblem, RockType, State

    def drawn() -> Any:
        return State((0, 3), tuple(RockType.random() for _ in ROCKS), False)

    locations = {place: number for number, place in enumerate(ROCKS)}
    belief = pomdp_py.Particles([drawn() for _ in range(PARTICLES)])
    return RockSampleProblem(7, len(ROCKS), drawn(), locations, belief).agent


PROBLEMS: dict[str, Callable[[], Any]] = {"tiger": _tiger, "rocksample-7-8": _rocksample}
