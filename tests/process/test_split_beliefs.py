import random

import numpy as np
from models import engine_of_text
from numpy.typing import NDArray
from processes import kill_engine

from aos_solver.child.engine import Engine

MACHINES, LEVELS = 12, 4
NEW, WEARS, SEES = 0.7, 0.08, 0.7
FILES = {
    "machines.ef": f"""project: machines
horizon: 5
discount: 0.95

state_variable: int wear []
code:
state.wear.assign({MACHINES}, 0);

initial_belief:
for (int i = 0; i < {MACHINES}; i++) state.wear[i] = AOS.Bernoulli({1 - NEW}) ? 1 : 0;

extrinsic_code:
for (int i = 0; i < {MACHINES}; i++)
    if (state.wear[i] < {LEVELS - 1} && AOS.Bernoulli({WEARS})) state_.wear[i] = state.wear[i] + 1;
""",
    "inspect.sd": f"""project: machines
parameter: int number

available_parameters_code:
for (int i = 0; i < {MACHINES}; i++) __possibleParameters.push_back(std::make_tuple(i));

dynamic_model:
int seen = state__.wear[number];
if (!AOS.Bernoulli({SEES})) seen = AOSUtils::SampleDiscrete(vector<double>{{0.25, 0.25, 0.25, 0.25}});
const int responses[] = {{w0, w1, w2, w3}};
__moduleResponse = responses[seen];
""",
}
"""Each of 4^12 states has up to 2^12 outcomes; the machines are independent of one another."""


class Workshop:
    """The exact marginals, and a mission that is drawn from them."""

    def __init__(self, seed: int):
        self.dice = random.Random(seed)
        self.wear: NDArray[np.float64] = np.tile([NEW, 1 - NEW, 0.0, 0.0], (MACHINES, 1))
        self.moves = np.diag([1 - WEARS] * 3 + [1.0]) + np.diag([WEARS] * 3, 1)

    def inspection(self) -> tuple[str, str]:
        """Draws an action and what is seen, and takes it in."""
        machine = self.dice.randrange(MACHINES)
        self.wear = self.wear @ self.moves
        odds = SEES * self.wear[machine] + (1 - SEES) / LEVELS
        seen = self.dice.choices(range(LEVELS), odds.tolist())[0]
        likelihood = np.full(LEVELS, (1 - SEES) / LEVELS)
        likelihood[seen] += SEES
        self.wear[machine] *= likelihood / odds[seen]
        return f"inspect(number={machine})", f"w{seen}"


async def told(engine: Engine) -> NDArray[np.float64]:
    marginals = (await engine.summary()).marginals
    return np.array([[each.values.get(str(level), 0.0) for level in range(LEVELS)] for each in marginals])


async def test_marginals_of_many_machines_stay_close_to_the_exact_ones():
    distances = []
    async with engine_of_text(FILES) as engine:
        workshop = Workshop(1)
        for _ in range(12):
            update = await engine.update(*workshop.inspection())
            assert not update.summary.is_exact
            assert update.summary.error_bound == 1
            distances.append(np.abs(await told(engine) - workshop.wear).sum(axis=1) / 2)
    assert np.max(distances) < 0.06
    assert np.mean(distances) < 0.014


async def test_such_a_belief_is_the_same_after_a_kill():
    digests = []
    for is_killed in (False, True):
        workshop = Workshop(2)
        async with engine_of_text(FILES) as engine:
            for _ in range(3):
                before = (await engine.update(*workshop.inspection())).summary
            if is_killed:
                await kill_engine(engine.pid)
                back = await engine.summary()
                assert (back.digest, back.effective_states) == (before.digest, before.effective_states)
            digests.append((await engine.update(*workshop.inspection())).summary.digest)
    assert digests[0] == digests[1] != ""
