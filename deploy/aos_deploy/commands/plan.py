"""`aos plan` and `aos rate`: a bundle's model without a robot."""

import statistics
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, NamedTuple

import msgspec
import typer
from msgspec.structs import replace

from aos_deploy import planning_options
from aos_deploy.bundles.files import planned_of
from aos_deploy.bundles.reachability import remark_on_start
from aos_deploy.deployment.mission_values import SetValues
from aos_deploy.options import AsJson, TrustDocuments, command, seconds
from aos_deploy.printing import show
from aos_deploy.terminal import waiting
from aos_deploy.views.lines import risk_text
from aos_protocol.errors import IntractableError, PlanningError
from aos_protocol.messages import ActionValue, ConstraintRisk
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.decision.choices import Choice
from aos_solver.mission.decision.choosing import Chooser
from aos_solver.mission.decision.risk import RiskBudget
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.rules.failures import Failures
from aos_solver.mission.rules.terms import Terms
from aos_solver.study.supposing import believe_all

RATE_REPETITIONS = 10


class Decision(msgspec.Struct):
    """The output of `aos plan --json`; the action worth most comes first."""

    action: str
    value: float
    simulations: int
    actions: list[ActionValue]
    planner: str = ""
    why: str = ""
    constraints: list[ConstraintRisk] = []
    forbidden: list[str] = []


class ShownOptions(NamedTuple):
    """Options for what is printed of a decision."""

    shows_all: Annotated[bool, typer.Option("--all", help="Every action, not the best ones alone")] = False
    as_json: AsJson = False


@command("Example: aos plan deploy/bundles/armadillo-finer --exact --horizon 8")
def plan(
    bundle: planning_options.Bundle,
    deciding: planning_options.SearchOptions,
    given: planning_options.GivenOptions,
    shown: ShownOptions,
    belief: Annotated[
        list[str] | None,
        typer.Option(
            "--belief",
            metavar="VAR=VALUE:P|FILE",
            help="Another probability at the start, or a file with one a line; repeatable",
        ),
    ] = None,
    exact: Annotated[bool, typer.Option("--exact", help="By enumeration instead of search")] = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Decide at the initial belief.

    Prints the values of the best actions, found by search or exactly. With --belief
    the probability of a variable's value is another one, and all ratios inside
    are kept: --belief "tiger_behind=Left:0.9" for deploy/bundles/bench/tiger.
    """
    supposed = _suppositions(belief or ())
    if exact and deciding.policy is not None:
        raise typer.BadParameter("it excludes --exact", param_hint="--policy")
    planned = planned_of(bundle)
    search = deciding.search_in(planned)

    async def decide(engine: Engine) -> Decision:
        with waiting("deciding") as tell:
            engine.on_progress = lambda found: tell(found.text)
            for said in await believe_all(engine, supposed):
                typer.echo(f"supposed {said}", err=True)
            if remark := remark_on_start(await engine.summary()):
                typer.echo(f"aos: {remark}", err=True)
            if exact:
                return await _exact_decision(engine, search.horizon_at(1, engine))
            return await _searched_decision(engine, search)

    decision = planning_options.with_engine(planned, deciding.seed, given, decide)
    title = "exact" if exact else "0 simulations" if deciding.policy is None else "by the policy"
    show(decision, shown.as_json, lambda made: _print_decision(made, title, shows_all=shown.shows_all))


def _suppositions(given: Iterable[str]) -> list[str]:
    """The suppositions, in place of files the lines that they have."""
    found: list[str] = []
    for text in given:
        if Path(text).is_file():
            found += [line for line in Path(text).read_text().splitlines() if line.strip()]
        elif "=" in text:
            found.append(text)
        else:
            raise typer.BadParameter(f"{text} is neither VAR=VALUE:P nor a file", param_hint="--belief")
    return found


async def _exact_decision(engine: Engine, horizon: int) -> Decision:
    try:
        return _decision((await engine.exact_values(horizon)).values, 0)
    except IntractableError as error:
        message = f"the values cannot be enumerated: {error.message}"
        raise IntractableError(message, hint="Leave out --exact to search for them") from error


async def _searched_decision(engine: Engine, search: Search) -> Decision:
    """The first decision of a mission; PlanningError AOS303 where every action risks too much."""
    budget = RiskBudget(engine.bounds)
    chooser = Chooser(Terms(name="planned", search=search), Failures(), QuietPorts(), budget)
    choice = await chooser.choose(RunningModel(0, engine), 1, await engine.summary())
    if not isinstance(choice, Choice):
        raise PlanningError(choice.remark, code="AOS303")
    found = choice.plan
    decision = _decision(list(found.actions), found.simulations)
    return replace(
        decision,
        action=found.best.action,
        value=found.best.q,
        planner=found.planner,
        why=found.why,
        constraints=list(budget.spend(choice.risks, found.index)) if choice.risks is not None else [],
        forbidden=[found.actions[number].action for number in sorted(choice.forbidden)],
    )


def _print_decision(decision: Decision, title: str, *, shows_all: bool) -> None:
    from aos_deploy.views.tables import print_values  # Numbers as JSON need no rich.

    print_values(decision.actions, decision.simulations, title, shows_all=shows_all)
    if decision.planner:
        print(f"{decision.planner}: {decision.why}")
    for constraint in decision.constraints:
        print(f"{decision.action}: {risk_text(constraint)}")
    if decision.forbidden:
        print(f"too risky: {', '.join(decision.forbidden)}")


def _decision(values: list[ActionValue], simulations: int) -> Decision:
    values = sorted(values, key=lambda value: -value.q)
    return Decision(values[0].action, values[0].q, simulations, values)


class Rate(msgspec.Struct):
    """The output of `aos rate --json`: samples per second."""

    mean: float
    sd: float
    repetitions: int
    seconds: float


@command("Example: aos rate deploy/bundles/armadillo-finer")
def rate(
    bundle: planning_options.Bundle,
    length_s: Annotated[float, seconds("--seconds", least=0.01, help="Length of one repetition")] = 1.0,
    seed: planning_options.Seed = 1,
    set_values: SetValues = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Measure how many samples a second the model gives.

    A sample is a next state, an observation and a reward, made as planners
    make it: by one call of the model's code for each step.
    """

    async def measure(engine: Engine) -> list[float]:
        counts = [await engine.rate(length_s, seed + turn) for turn in range(RATE_REPETITIONS)]
        return [count.samples / count.seconds for count in counts]

    given = planning_options.GivenOptions(set_values=set_values)
    rates = planning_options.with_engine(planned_of(bundle), seed, given, measure, kind="thorough")
    result = Rate(statistics.fmean(rates), statistics.stdev(rates), RATE_REPETITIONS, length_s)
    told = f"{result.mean:,.0f} samples/s (sd {result.sd:,.0f}, {RATE_REPETITIONS} x {length_s:g} s)"
    show(result, as_json, lambda _: typer.echo(told))
