"""Questions about a decision: asked of the solver of a living mission, else answered from the run's
directory.
"""

from collections.abc import Awaitable, Callable
from typing import Annotated, TypeVar

import msgspec

from aos_deploy.runs.studied import StudiedRun
from aos_gateway.resources.run_files import number_of_step
from aos_gateway.runs.run import KeptRun
from aos_gateway.shared import Gateway
from aos_protocol.errors import GatewayError
from aos_protocol.keys import Keys
from aos_protocol.messages import DecisionTree, TreeQuery, WhatIf, WhatIfQuery, Why, WhyQuery
from aos_runtime.client import STUDY_TIMEOUT_S
from aos_runtime.disk.mission_folders import number_in
from aos_solver.study.study import Study

A = TypeVar("A", Why, DecisionTree, WhatIf)


class OfWhy(msgspec.Struct, frozen=True):
    """The action that was not chosen; by default the runner-up."""

    instead: str = ""


class OfTree(msgspec.Struct, frozen=True):
    """The depth of the tree, and the most actions and responses at each belief."""

    depth: Annotated[int, msgspec.Meta(ge=1, le=6)] = 2
    branches: Annotated[int, msgspec.Meta(ge=1, le=10)] = 3


class Otherwise(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Other circumstances, as in WhatIfQuery."""

    forbid: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    believe: tuple[str, ...] = ()
    change: tuple[str, ...] = ()


async def why(gateway: Gateway, mission: str, step: str, query: OfWhy) -> Why:
    """The reasons for a decision: margin, what was expected and what it leads to, lines of the documents,
    beliefs."""
    asked = WhyQuery(number_of_step(step), query.instead, mission)
    return await _answer(gateway, asked, Why, lambda keys: keys.study_why, lambda study: study.why(asked))


async def tree(gateway: Gateway, mission: str, step: str, query: OfTree) -> DecisionTree:
    """The tree below a decision: the best actions and likeliest responses, each belief planned anew."""
    asked = TreeQuery(number_of_step(step), query.depth, query.branches, mission)
    return await _answer(
        gateway, asked, DecisionTree, lambda keys: keys.study_tree, lambda study: study.tree(asked)
    )


async def what_if(gateway: Gateway, mission: str, step: str, body: Otherwise) -> WhatIf:
    """The decision of a step under other circumstances. The mission is not touched, but a model may be
    compiled."""
    asked = WhatIfQuery(number_of_step(step), body.forbid, body.without, body.believe, body.change, mission)
    return await _answer(
        gateway, asked, WhatIf, lambda keys: keys.study_whatif, lambda study: study.what_if(asked)
    )


async def _answer(
    gateway: Gateway,
    asked: WhyQuery | TreeQuery | WhatIfQuery,
    kind: type[A],
    key: Callable[[Keys], str],
    study: Callable[[Study], Awaitable[A]],
) -> A:
    """The answer of the mission's solver at a key of the bus; of a mission that is over, that of a study."""
    run = await gateway.shelf.run_of_mission(asked.mission)
    if run.is_running:
        async with run.asking() as client:
            return await client.bus.ask(key(client.keys), asked, kind, timeout_s=STUDY_TIMEOUT_S)
    if not isinstance(run, KeptRun):
        raise GatewayError(f"the mission {asked.mission} is over, and not on this machine")
    async with gateway.studying:
        return await StudiedRun.open(run.directory.path, number_in(run.name, asked.mission)).study(study)
