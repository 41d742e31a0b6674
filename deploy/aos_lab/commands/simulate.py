"""`aos simulate`: whole missions without a robot."""

from __future__ import annotations

import statistics
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import msgspec
import typer
from msgspec.structs import replace

from aos_deploy import planning_options
from aos_deploy.bundles.files import Planned, planned_of
from aos_deploy.exit_codes import ExitCode
from aos_deploy.options import AsJson, TrustDocuments, command, finite
from aos_deploy.printing import count, print_json
from aos_deploy.terminal import progress
from aos_lab.formats import is_problem_file
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import SimulatedRun, simulate_mission

if TYPE_CHECKING:
    from aos_lab.problem_missions import ProblemPlayer


class Campaign(msgspec.Struct):
    """The output of `aos simulate --json`."""

    runs: list[SimulatedRun]
    summary: dict[str, float]


Target = Annotated[
    Path,
    typer.Argument(
        metavar="BUNDLE",
        help="A directory of documents; a deploy file, for its bundles, constraints, values and limits; or, "
        "with --policy, a .pomdp or .pomdpx file",
    ),
]


class MissionOptions(NamedTuple):
    """The number of missions, and the conditions that end each: else those of the deploy file."""

    runs: Annotated[int, typer.Option(min=1, help="How many missions")] = 10
    goal_probability: Annotated[
        float | None,
        typer.Option(
            min=0.001,
            max=1,
            callback=finite,
            help="Ends a mission when reached; else the deploy file's, or 0.9",
        ),
    ] = None
    step_limit: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Ends a mission when reached; else the deploy file's, or 30; problem files have their own",
        ),
    ] = None
    stop_below_value: Annotated[
        float | None,
        typer.Option(
            callback=finite, help="Ends a mission when no action can return so much; else the deploy file's"
        ),
    ] = None

    def limits_in(self, planned: Planned) -> MissionLimits:
        """The limits that are given, and for the rest those of the deploy file."""
        given = {name: value for name, value in self._asdict().items() if value is not None}
        del given["runs"]
        return replace(planned.limits or MissionLimits(), **given)


@command("Example: aos simulate deploy/bundles/armadillo-finer --runs 20")
def simulate(
    bundle: Target,
    deciding: planning_options.SearchOptions,
    given: planning_options.GivenOptions,
    missions: MissionOptions,
    states: Annotated[
        bool, typer.Option("--states", help="Also tell the world's state at each step")
    ] = False,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Run whole missions against the documents' own model.

    Or those of a .pomdp or .pomdpx file, by a policy of `aos solve` for it.

    Run k has seed SEED + k, from 0. Goals and failures are counted by what has
    become of the world; what the belief held for the goal is told beside.
    Ctrl-C ends it early and tells of the missions that have ended.
    """
    first, runs = deciding.seed, missions.runs
    done: list[SimulatedRun] = []
    is_problem = is_problem_file(bundle)
    was_stopped = False
    try:
        if is_problem:
            player = _problem_player(bundle, deciding.policy, missions.step_limit, given)
            _play_problem(player, range(first, first + runs), done, with_states=states)
        else:
            planned = planned_of(bundle)
            search = deciding.search_in(planned)
            limits = missions.limits_in(planned)
            play = partial(_play, search=search, limits=limits, runs=runs, with_states=states, done=done)
            planning_options.with_engine(planned, first, given, play)
    except KeyboardInterrupt:
        was_stopped = True
    if done and as_json:
        print_json(Campaign(done, _summary(done)))
    elif done:
        from aos_deploy.views.tables import print_runs  # It imports rich.

        print_runs(done, _summary(done), has_goals=not is_problem)
    if was_stopped:
        typer.echo(f"aos: stopped after {len(done)} of {count(runs, 'mission')}", err=True)
        raise typer.Exit(ExitCode.INTERRUPTED)


def _problem_player(
    path: Path, policy: Path | None, step_limit: int | None, given: planning_options.GivenOptions
) -> ProblemPlayer:
    """The player of a problem file; BadParameter for options that documents alone have."""
    for name, texts in (("never", given.never), ("set", given.set_values)):
        if texts:
            raise typer.BadParameter("a problem file has none", param_hint=f"--{name}")
    if policy is None:
        hint = f"a problem file is simulated by a policy: aos solve {path} --out FILE.policy makes it"
        raise typer.BadParameter(hint, param_hint="--policy")
    # Numbers take a tenth of a second to import, and missions of documents do without.
    from aos_lab.problem_missions import ProblemPlayer
    from aos_solver.offline.policy import Policy

    return ProblemPlayer(path, Policy.load(policy), step_limit)


def _play_problem(
    player: ProblemPlayer, seeds: Iterable[int], done: list[SimulatedRun], *, with_states: bool
) -> None:
    with progress() as bar:
        shown = bar.track(list(seeds), description="missions", update_period=0.2)
        done.extend(player.play(seed, with_states=with_states) for seed in shown)


async def _play(
    engine: Engine,
    search: Search,
    limits: MissionLimits,
    runs: int,
    done: list[SimulatedRun],
    *,
    with_states: bool,
) -> None:
    """Plays the missions, and puts each that has ended to those that are `done`."""
    with progress() as bar:
        task = bar.add_task("missions", total=runs)
        engine.on_progress = lambda found: bar.update(task, description=f"missions, {found.text}")
        for run_seed in range(search.seed, search.seed + runs):
            of_run = replace(search, seed=run_seed)
            done.append(await simulate_mission(engine, of_run, limits, with_states=with_states))
            bar.update(task, description="missions", completed=len(done))


def _summary(runs: list[SimulatedRun]) -> dict[str, float]:
    returns = [run.discounted_return for run in runs]
    return {
        "runs": len(runs),
        "goal_rate": sum(run.world_ending == "goal" for run in runs) / len(runs),
        "over_rate": sum(run.world_ending == "over" for run in runs) / len(runs),
        "failure_rate": sum(run.world_ending == "failure" for run in runs) / len(runs),
        "believed_goal_rate": sum(run.believed_ending == "goal" for run in runs) / len(runs),
        "mean_discounted_return": statistics.fmean(returns),
        # One mission says nothing of how much missions differ.
        **({"stderr": statistics.stdev(returns) / len(runs) ** 0.5} if len(runs) > 1 else {}),
        "mean_steps": statistics.fmean(run.steps for run in runs),
        **{
            f"violation_rate of {never}": sum(never in run.violated for run in runs) / len(runs)
            for never in runs[0].risked
        },
    }
