"""`aos why` and `aos whatif`: questions about a decision that was made."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Annotated, NamedTuple, TypeVar

import typer

from aos_deploy.options import AsJson, Mission, TrustDocuments, command
from aos_deploy.printing import show
from aos_deploy.running_system import System
from aos_deploy.runs.living import chosen_run
from aos_deploy.runs.studied import StudiedRun
from aos_deploy.terminal import waiting
from aos_deploy.views.reasons import what_if_lines, why_lines
from aos_protocol.access import WATCHER
from aos_protocol.messages import WhatIf, WhatIfQuery, Why, WhyQuery
from aos_runtime.client import AosClient
from aos_solver.study.study import Study

T = TypeVar("T", Why, WhatIf)

Step = Annotated[int, typer.Argument(min=0, metavar="STEP", help="The decision's number; 0 is the newest")]


@command('Example: aos why 3 --instead "navigate(destination=corridor)"')
def why(
    system: System,
    step: Step = 0,
    instead: Annotated[
        str, typer.Option("--instead", metavar="ACTION", help="Not the runner-up but this action")
    ] = "",
    mission: Mission = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Explain a decision.

    Its value and that of another action; what was expected, and what each
    response would lead to; which lines of the documents the margin comes from;
    where along the belief the choice changes. A mission that runs is asked
    through its solver, which has an engine of its own for this; one that is
    over is read from its directory.
    """
    found = _found(
        system,
        mission,
        lambda aos: aos.why(step, instead=instead, mission=mission),
        lambda study: study.why(WhyQuery(step, instead)),
    )
    show(found, as_json, lambda why: typer.echo("\n".join(why_lines(why))))


class Otherwise(NamedTuple):
    """The decision, and the circumstances that are taken to be other ones."""

    step: Step = 0
    forbid: Annotated[
        list[str] | None, typer.Option("--forbid", metavar="ACTION", help="Not this action now; repeatable")
    ] = None
    without: Annotated[
        list[str] | None, typer.Option("--without", metavar="SKILL", help="Never this skill; repeatable")
    ] = None
    believe: Annotated[
        list[str] | None,
        typer.Option("--believe", metavar="VAR=VALUE:P", help="Another probability; repeatable"),
    ] = None
    change: Annotated[
        list[str] | None,
        typer.Option("--change", metavar="FILE:LINE=NUMBER", help="Another number in a document; repeatable"),
    ] = None


@command('Example: aos whatif 3 --believe "holding_can=true:0.5"')
def whatif(
    system: System,
    otherwise: Otherwise,
    mission: Mission = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Decide a step anew under other circumstances.

    The mission is not touched. Suppositions about beliefs keep all ratios
    inside (Jeffrey's rule). With another number in a document the model is
    compiled, and replays what was observed before the step.
    """
    forbid, without, believe, change = (tuple(texts or ()) for texts in otherwise[1:])
    query = WhatIfQuery(otherwise.step, forbid, without, believe, change)
    found = _found(
        system, mission, lambda aos: aos.what_if(query, mission=mission), lambda study: study.what_if(query)
    )
    show(found, as_json, lambda what_if: typer.echo("\n".join(what_if_lines(what_if))))


def _found(
    system: System,
    mission: int | None,
    ask: Callable[[AosClient], Awaitable[T]],
    study: Callable[[Study], Awaitable[T]],
) -> T:
    """The answer of the system that runs, or else from the directory of the run."""
    with waiting("looking into the decision", first_s=5.0):
        if not system.is_at_endpoint:
            directory = chosen_run(system.run, system.runs)
            if not directory.is_running:
                return asyncio.run(StudiedRun.open(directory.path, mission).study(study))
            system = System(run=directory.path)
        return system.do(ask, user=WATCHER)
