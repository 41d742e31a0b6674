"""`aos replay` and `aos diff`: a mission computed once more, and two missions beside each other."""

import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from aos_deploy.exit_codes import ExitCode
from aos_deploy.options import AsJson, Mission, OneRun, Runs, TrustDocuments, command
from aos_deploy.printing import count, from_here, show
from aos_deploy.runs.difference import Difference, difference
from aos_deploy.runs.living import chosen_run
from aos_deploy.runs.studied import StudiedRun
from aos_deploy.terminal import waiting
from aos_protocol.messages import ModelAdopted
from aos_solver.study.comparing import Comparison, compared


class Replayed(msgspec.Struct):
    """The output of `aos replay --json`: how much was compared, and the first row that differs.

    `values` are the decisions of which all was compared, `beliefs` the rows of which the belief was;
    `partly` has the steps of the other decisions by the reason.
    """

    run: str
    decisions: int = 0
    values: int = 0
    beliefs: int = 0
    takeovers: int = 0
    partly: dict[str, list[int]] = {}
    first_difference: Comparison | None = None


@command("Example: aos replay runs/latest --until 4")
def replay(
    run: OneRun = None,
    until: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="End with the decision of this step")
    ] = None,
    mission: Mission = None,
    runs: Runs = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Compute a mission once more, and compare each decision.

    Documents, decisions and outcomes of the journal are put through an engine
    of the same model. Compared bit for bit are the action, the values and
    counts of all actions, and the digest of the belief. The first difference
    is named with its cause, and makes the exit code 1. A decision with a budget
    in time is compared by its belief alone. No mission is touched.
    """
    directory = chosen_run(run, runs)
    studied = StudiedRun.open(directory.path, mission)
    made = studied.mission.decisions
    if until is not None and made and until > made[-1].step:
        typer.echo(f"aos: --until {until} is after the last decision, of step {made[-1].step}", err=True)
    with waiting("replaying") as told:
        found = asyncio.run(replayed_run(studied, from_here(directory.named), told, until))
    show(found, as_json, _print)
    if found.first_difference is not None:
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


async def replayed_run(
    studied: StudiedRun, name: Path, told: Callable[[str], None], until: int | None = None
) -> Replayed:
    """Compares a mission with its replay up to the first difference, or to the decision of step `until`."""
    found = Replayed(str(name))
    async with studied.replay(told, decides=True) as remade:
        async for made in remade.rows(until):
            found.takeovers += isinstance(made.said, ModelAdopted)
            row = compared(made, remade.engine.build_digest, studied.settings.time_s)
            if row is None:
                continue
            found.decisions += row.decides
            found.values += row.has_values
            found.beliefs += row.has_belief
            if row.without:
                found.partly.setdefault(row.without, []).append(row.step)
            if row.difference:
                found.first_difference = row
                break
    return found


def _print(found: Replayed) -> None:
    over = f", {count(found.takeovers, 'takeover')}" if found.takeovers else ""
    first = found.first_difference
    if first is not None:
        what = "decision" if first.decides else "outcome"
        typer.echo(f"{found.run}: step {first.step} differs, at its {what}, {first.action}")
        typer.echo(f"  {first.difference}")
        typer.echo(f"  cause: {first.cause}")
    else:
        same = "identical in action, values and counts"
        values = f"{found.values} of {count(found.decisions, 'decision')} {same}"
        if found.values < found.decisions:
            values = f"{found.values} of {count(found.decisions, 'decision')} made once more, {same}"
        if not found.values:
            values = f"none of {count(found.decisions, 'decision')} can be made once more as it was"
        typer.echo(f"{found.run}: {values}; {count(found.beliefs, 'belief')} identical{over}")
    for why, steps in found.partly.items():
        typer.echo(f"  by their beliefs alone, steps {_ranges(steps)}: {why}")


def _ranges(steps: list[int]) -> str:
    parts: list[list[int]] = []
    for step in steps:
        if parts and step == parts[-1][-1] + 1:
            parts[-1].append(step)
        else:
            parts.append([step])
    return ", ".join(f"{part[0]}-{part[-1]}" if len(part) > 1 else str(part[0]) for part in parts)


@command("Example: aos diff $(ls -d runs/2* | tail -2)")
def diff(
    first: Annotated[
        Path | None, typer.Argument(metavar="A", help="A run directory, or a file of `aos export`")
    ] = None,
    second: Annotated[Path | None, typer.Argument(metavar="B", help="Another one")] = None,
    mission: Mission = None,
    as_json: AsJson = False,
) -> None:
    """Compare two missions up to where they part.

    Prints the settings that differ and the first step that does. The exit code is 1 where they differ.
    """
    if first is None or second is None:
        raise typer.BadParameter(
            "two run directories are compared. `aos runs` lists what ran here", param_hint="A B"
        )
    runs = [chosen_run(run, None) for run in (first, second)]
    found = difference(*(StudiedRun.open(run.path, mission) for run in runs))
    show(found, as_json, lambda found: _print_difference(found, *(from_here(run.named) for run in runs)))
    if found.is_any:
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


def _print_difference(found: Difference, first: Path, second: Path) -> None:
    typer.echo(f"A is {first}, B is {second}")
    for name, (then, now) in found.settings.items():
        typer.echo(f"  {name}: {then} in A, {now} in B")
    if found.step:
        typer.echo(f"  step {found.step} is the first that differs: {found.what}")
        if found.before:
            typer.echo(f"  before it the same {count(found.before, 'step')}")
    else:
        typer.echo(f"  all {count(found.before, 'step')} are the same")
