"""`aos drift`: whether skills do what their documents say, over the missions of several runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from aos_deploy.exit_codes import ExitCode
from aos_deploy.options import AsJson, ChosenRuns, Runs, command
from aos_deploy.printing import count, print_json
from aos_deploy.runs.living import chosen_runs

if TYPE_CHECKING:
    from aos_deploy.runs.drift import ModelTests


@command("Example: aos drift runs")
def drift(run: ChosenRuns = None, runs: Runs = None, as_json: AsJson = False) -> None:
    """Test whether skills do what their documents say.

    The sequential tests of a mission go on from one run to the next here, for each model of its own. Where
    a model is right, the probability that any alarm of it ever comes is 1 % at most. Exit code 1: there is an
    alarm of the newest model.
    """
    from aos_deploy.runs.drift import drift_of_runs  # It imports the solver.

    chosen = chosen_runs(run, runs)
    models = drift_of_runs(chosen)
    if as_json:
        print_json({"models": [_plain(model) for model in models]})
    else:
        _print(models)
    if models and models[-1].begun_at:
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


def _plain(model: ModelTests) -> dict[str, Any]:
    return {
        "model_digest": model.tests.model_digest,
        "revision": model.revision,
        "missions": model.missions,
        "responses": [
            {
                "skill": test.skill,
                "response": test.response,
                "uses": test.uses,
                "modelled": test.expected / test.uses,
                "seen": test.seen / test.uses,
                "is_alarm": test.is_alarm,
                "begun_at": model.begun_at.get((test.skill, test.response), ""),
            }
            for test in model.tests.tests
            if test.uses
        ],
    }


def _print(models: list[ModelTests]) -> None:
    from rich.table import Table

    from aos_deploy.terminal import print_table

    if not models:
        typer.echo("no mission here has tests of its skills")
    for model in models:
        digest = model.tests.model_digest[:12]
        typer.echo(f"model {digest}, revision {model.revision}: {count(model.missions, 'mission')}")
        used = [test for test in model.tests.tests if test.uses]
        if not used:
            typer.echo("  no skill with several responses was used")
            continue
        table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
        for column in ("skill", "response", "uses", "modelled", "seen", ""):
            is_text = column in ("skill", "response", "")
            table.add_column(column, justify="left" if is_text else "right", overflow="fold")
        for test in used:
            place = model.begun_at.get((test.skill, test.response), "")
            numbers = (str(test.uses), f"{test.expected / test.uses:.2f}", f"{test.seen / test.uses:.2f}")
            said = f"does not hold since {place}" if place else ""
            table.add_row(test.skill, test.response, *numbers, said, style="bold" if place else "")
        print_table(table)
