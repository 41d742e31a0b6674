import msgspec
import pytest
from models import built_text, engine_of
from processes import kill_engine

from aos_protocol.messages import WeightedStates
from aos_solver.building.build import BuiltModel
from aos_solver.child.engine import Engine

STEPS = 12

DRAWN_START = "state.at = AOS.SampleNormal(0, 2);"
"""A start that cannot be enumerated."""
LISTED_START = "state.at = AOS.SampleDiscrete(vector<double>{0.25, 0.25, 0.25, 0.25}) - 1.5;"


async def drifting(start: str) -> BuiltModel:
    """A place that drifts, and a skill that says on which side it is, more or less."""
    files = {
        "drift.ef": f"project: drift\nhorizon: 5\nstate_variable: double at\ninitial_belief:\n{start}\n",
        "look.sd": (
            "project: drift\ndynamic_model:\nif (AOS.Bernoulli(0.3)) state__.at = state.at + 0.5;\n"
            "const double odds = 1 / (1 + exp(-2 * state__.at));\n"
            "__moduleResponse = AOS.Bernoulli(odds) ? right : left;\n"
        ),
    }
    return await built_text(files)


async def take_step(engine: Engine, step: int) -> str:
    """The digest after a step whose outcome depends on its number alone; every fifth one nobody observed."""
    if step % 5 == 0:
        update = await engine.update_without_observation("look", ran_probability=0.5, step=step)
    else:
        update = await engine.update("look", "left" if step % 3 else "right", step=step)
    return update.summary.digest


async def kill(engine: Engine):
    await kill_engine(engine.pid)


@pytest.mark.parametrize("start", [DRAWN_START, LISTED_START], ids=["drawn", "exact"])
async def test_a_belief_has_the_digest_of_its_twin_whose_engine_was_killed_and_asked_other_things(start):
    built = await drifting(start)
    async with engine_of(built, seed=3) as engine, engine_of(built, seed=3) as disturbed:
        assert (await engine.summary()).is_exact == (start == LISTED_START)
        digests = set()
        for step in range(1, STEPS + 1):
            await disturbed.predict(0)
            await disturbed.plan(seed=step, simulations=20)
            if step % 4 == 0:
                await kill(disturbed)
            digest = await take_step(engine, step)
            assert digest == await take_step(disturbed, step), step
            digests.add(digest)
        assert len(digests) == STEPS


async def test_particles_are_those_of_the_missions_seed():
    built = await drifting(DRAWN_START)
    async with engine_of(built, seed=3) as engine, engine_of(built, seed=4) as other:
        at_start = await engine.summary()
        after = await take_step(engine, 1)
        assert (await other.summary()).digest != at_start.digest
        assert (await other.reset_belief(3)).digest == at_start.digest
        assert await take_step(other, 1) == after
        assert (await other.reset_belief()).digest != (await other.reset_belief()).digest


async def test_the_digest_does_not_depend_on_the_order_of_the_states():
    built = await drifting(LISTED_START)
    async with engine_of(built) as engine, engine_of(built) as other:
        digest = await take_step(engine, 1)
        belief = await engine.export_belief()
        (least, *rest) = belief.particles
        turned = [*rest, least]
        changed = [*rest, (least[0] * 1.001, least[1])]
        assert (await other.import_belief(replaced(belief, turned))).digest == digest
        assert (await other.import_belief(replaced(belief, changed))).digest != digest


def replaced(belief: WeightedStates, particles: list[tuple[float, str]]) -> WeightedStates:
    return msgspec.structs.replace(belief, particles=tuple(particles))
