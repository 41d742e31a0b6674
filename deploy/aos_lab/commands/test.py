"""`aos test`: missions of users, with what they claim of them, for their continuous integration."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from aos_deploy.deployment.mission_values import SetValues, values_of_options
from aos_deploy.exit_codes import ExitCode
from aos_deploy.options import AsJson, TrustDocuments, command, writable
from aos_deploy.printing import show
from aos_deploy.terminal import progress
from aos_lab.commands.interrupted import interruption_among_missions

if TYPE_CHECKING:
    from aos_lab.trials.junit import Tested

SHOWN_MISSIONS = 3
"""The number of missions shown where a claim did not hold; all are in the JUnit file and in the JSON."""


class MissionOptions(NamedTuple):
    """The number of missions, and what is kept of them."""

    jobs: Annotated[int, typer.Option(min=1, help="Missions at a time")] = 1
    seeds: Annotated[int | None, typer.Option(min=1, help="Missions of each test, not the file's")] = None
    junit: Annotated[
        Path | None, typer.Option(metavar="XML", help="Write a JUnit file", callback=writable)
    ] = None
    keep: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Keep records and runs here, and use those that are there"),
    ] = None


@command(
    "Example: aos test docs/examples/missions.yaml --junit report.xml. "
    "Exit codes: 0 all claims hold, 4 one does not, 1 the file or documents have errors.",
    "test",
)
def run_tests(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The file of mission tests")],
    missions: MissionOptions,
    set_values: SetValues = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Run missions and check what is claimed of them.

    A test names a deploy file, seeds and claims: the first action, an order of
    actions, what never happens, the probability of the goal. The documents'
    own model plays the skills, or the whole system with its adapters.
    """
    from aos_lab.trials.campaign import Place, play_campaign
    from aos_lab.trials.files import read_test_file
    from aos_lab.trials.junit import Tested, write_junit

    tests = read_test_file(file).tests
    tested: dict[str, Tested] = {}
    with (
        tempfile.TemporaryDirectory() as passing,
        progress() as bar,
        interruption_among_missions(bar, are_kept=missions.keep is not None),
    ):
        out = (missions.keep or Path(passing)).resolve()
        for name, test in tests.items():
            numbers = range(test.first_seed, test.first_seed + (missions.seeds or test.seeds))
            task = bar.add_task(name, total=len(numbers))
            played = play_campaign(
                test,
                numbers,
                folder=file.resolve().parent,
                out=out / name,
                on_trial=partial(bar.advance, task),
                place=Place(
                    jobs=missions.jobs, on_progress=lambda text: typer.echo(f"aos: {text}", err=True)
                ),
                mission_values=values_of_options(set_values),
            )
            tested[name] = Tested.of(test, asyncio.run(played).trials)
    if missions.junit is not None:
        write_junit(missions.junit, tested)
    show(tested, as_json, _print_tested)
    if not all(test.passed for test in tested.values()):
        raise typer.Exit(ExitCode.MISSION_FAILED)


def _print_tested(tested: Mapping[str, Tested]) -> None:
    from aos_lab.trials.junit import failed_missions, verdict_text

    for name, test in tested.items():
        for verdict in test.verdicts:
            word = "ok    " if verdict.is_seen else "FAILED"
            print(f"{word} {name}: {verdict.says}: {verdict_text(verdict)}")
            missions = failed_missions(verdict, test.trials) if not verdict.is_seen else []
            for line in missions[:SHOWN_MISSIONS]:
                print(f"         {line}")
