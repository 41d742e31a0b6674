"""Questions about a decision: asked of the solver of a living mission, else answered from the run's
directory.
"""

from __future__ import annotations

from typing import Annotated

import msgspec

from aos_deploy.studied_run import StudiedRun
from aos_gateway.reading import number_of_step
from aos_gateway.runs import KeptRun
from aos_gateway.shared import Gateway
from aos_protocol.errors import GatewayError
from aos_protocol.messages import DecisionTree, TreeQuery, WhatIf, WhatIfQuery, Why, WhyQuery
from aos_runtime.client import STUDY_TIMEOUT_S
from aos_runtime.mission_folders import number_of

__all__ = ["tree", "what_if", "why"]


class OfWhy(msgspec.Struct, frozen=True):
    """The action that was not chosen; by default the runner-up."""

    instead: str = ""


class OfTree(msgspec.Struct, frozen=True):
    """The depth of the tree, and the most actions and responses at each belief."""

    depth: Annotated[int, msgspec.Meta(ge=1, le=6)] = 2
    branches: Annotated[int, msgspec.Meta(ge=1, le=10)] = 3


class Otherwise(msgspec.Struct, frozen=True, kw_only=True):
    """Other circumstances, as in WhatIfQuery."""

    forbid: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    believe: tuple[str, ...] = ()
    change: tuple[str, ...] = ()


async def why(gateway: Gateway, mission: str, step: str, query: OfWhy) -> Why:
    """The reasons for a decision: margin, what was expected and what it leads to, lines of the documents,
    beliefs.
    """
    asked = WhyQuery(number_of_step(step), query.instead, mission)
    found = await gateway.shelf.run_of_mission(mission)
    if found.is_running:
        async with found.asking() as client:
            return await client.bus.ask(client.keys.study_why, asked, Why, timeout_s=STUDY_TIMEOUT_S)
    async with gateway.studying:
        return await _studied(found, mission).study(lambda study: study.why(asked))


async def tree(gateway: Gateway, mission: str, step: str, query: OfTree) -> DecisionTree:
    """The tree below a decision: the best actions and likeliest responses, each belief planned anew."""
    asked = TreeQuery(number_of_step(step), query.depth, query.branches, mission)
    found = await gateway.shelf.run_of_mission(mission)
    if found.is_running:
        async with found.asking() as client:
            return await client.bus.ask(
                client.keys.study_tree, asked, DecisionTree, timeout_s=STUDY_TIMEOUT_S
            )
    async with gateway.studying:
        return await _studied(found, mission).study(lambda study: study.tree(asked))


async def what_if(gateway: Gateway, mission: str, step: str, body: Otherwise) -> WhatIf:
    """The decision of a step under other circumstances. The mission is not touched, but a model may be
    compiled.
    """
    asked = WhatIfQuery(number_of_step(step), body.forbid, body.without, body.believe, body.change, mission)
    found = await gateway.shelf.run_of_mission(mission)
    if found.is_running:
        async with found.asking() as client:
            return await client.bus.ask(client.keys.study_whatif, asked, WhatIf, timeout_s=STUDY_TIMEOUT_S)
    async with gateway.studying:
        return await _studied(found, mission).study(lambda study: study.what_if(asked))


def _studied(run: object, mission: str) -> StudiedRun:
    if not isinstance(run, KeptRun):
        raise GatewayError(f"the mission {mission} is over, and not on this machine", code="AOS902")
    place = number_of(mission)
    is_one_of_several = place is not None and place[0] == run.name
    return StudiedRun.open(run.directory.path, place[1] if place and is_one_of_several else None)
