"""Options of the commands that plan with a bundle's model, and the model's engine."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Annotated, NamedTuple, TypeVar

import typer

from aos_deploy.bundles.engine import engine_of_bundle
from aos_deploy.bundles.files import Planned
from aos_deploy.deployment.mission_values import SetValues, constraint_of_option, values_of_options
from aos_deploy.deployment.parts import MAX_COUNT, MAX_SEED
from aos_deploy.options import seconds
from aos_protocol.documents import MAX_HORIZON
from aos_solver.building.build import BuildKind
from aos_solver.child.engine import Engine, Planner
from aos_solver.child.search import Search
from aos_solver.offline.policy import following

T = TypeVar("T")

Bundle = Annotated[
    Path,
    typer.Argument(
        metavar="BUNDLE",
        help="A directory of documents; or a deploy file, for its bundles, constraints, values and limits",
    ),
]
Seed = Annotated[
    int, typer.Option(min=0, max=MAX_SEED, help="The same seed and simulations give the same result")
]


class SearchOptions(NamedTuple):
    """The search for a decision, or the policy that it follows."""

    simulations: Annotated[
        int, typer.Option(min=1, max=MAX_COUNT, help="Planning budget of a decision, in simulations")
    ] = 100_000
    time_s: Annotated[
        float | None, seconds("--time", least=0.001, help="Planning budget in seconds, instead")
    ] = None
    horizon: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=MAX_HORIZON,
            help="Look-ahead in decisions; else the deploy file's, or the environment document's",
        ),
    ] = None
    seed: Seed = 1
    planner: Annotated[
        Planner, typer.Option("--planner", help="How to search; with auto what fits the model and the budget")
    ] = "auto"
    threads: Annotated[int, typer.Option(min=1, max=32, help="Threads that search; for POMCP")] = 1
    policy: Annotated[
        Path | None,
        typer.Option("--policy", help="Decide by this policy of `aos solve` instead of searching"),
    ] = None

    def search_in(self, planned: Planned) -> Search:
        """The search for decisions: what is not given here is as in the deploy file.

        PlanningError where there is a policy that cannot be read.
        """
        fields = self._asdict()
        policy = fields.pop("policy")
        fields["horizon"] = self.horizon or planned.horizon
        fields["step_limit"] = planned.limits.step_limit if planned.limits else None
        fields["plans_to_step_limit"] = planned.plans_to_step_limit
        return following(Search(**fields), policy)


class GivenOptions(NamedTuple):
    """The constraints and values that a mission has beside the documents."""

    never: Annotated[
        list[str] | None,
        typer.Option(
            "--never", metavar="P:EXPRESSION", help="A constraint: no more probable than P; repeatable"
        ),
    ] = None
    set_values: SetValues = None


def with_engine(
    planned: Planned,
    seed: int,
    given: GivenOptions,
    ask: Callable[[Engine], Awaitable[T]],
    *,
    kind: BuildKind = "quick",
) -> T:
    """Returns what `ask` makes of the documents' engine, for missions that are given this."""
    constraints = [constraint_of_option(text) for text in given.never or ()]
    values = values_of_options(given.set_values)

    async def run() -> T:
        async with engine_of_bundle(
            planned, seed, kind=kind, constraints=constraints, values=values
        ) as engine:
            return await ask(engine)

    return asyncio.run(run())
