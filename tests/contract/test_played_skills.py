from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from functools import partial

import msgspec
import pytest
from mapping_documents import skill_of
from middleware_system import System, answering, running_system
from places import BUNDLES

from aos_protocol.keys import Keys
from aos_protocol.messages import Outcome, SkillResult
from aos_runtime.bus.bus import Bus

NO_FIELDS = """\
project: armadillo
response: done
response_rule: True
module_activation: skill
path: /sense
parameter: goal
code:
Point(x=nobody_gives_this)
"""


async def outcome_of(system: System) -> Outcome:
    """Returns the outcome of a skill whose fields cannot be computed, and whose adapter answers with the
    observation."""

    def observed(result: SkillResult) -> SkillResult:
        return msgspec.structs.replace(result, response="done")

    project = system.registry.current.project
    system.registry.announce(msgspec.structs.replace(project, skills=(skill_of(NO_FIELDS, "sense.am"),)))
    await system.state(system.registry.current.revision)
    await system.adapter.serve("/sense", answering({}), observed)
    await system.can_run("sense")
    return await system.activate("sense")


StartSystem = Callable[..., AbstractAsyncContextManager[System]]


@pytest.fixture
def start(bus: Bus, other: Bus, keys: Keys, tmp_path, endpoint: str) -> StartSystem:
    return partial(running_system, bus, other, keys, tmp_path, endpoint, BUNDLES / "armadillo-finer")


@pytest.mark.parametrize(
    ("played", "status", "calls"),
    [((), "failed", 0), (("/sense",), "observed", 1), (("*",), "observed", 1), (("/look",), "failed", 0)],
)
async def test_a_played_skill_needs_no_fields_and_a_real_one_is_not_called_without(
    start: StartSystem, played, status, calls
):
    async with start(played=played) as system:
        outcome = await outcome_of(system)
        assert (outcome.status, len(system.adapter.calls)) == (status, calls)
        assert outcome.response == ("done" if calls else "")
