"""`aos check`: the history of a run against the rules that every history holds to."""

import asyncio
from pathlib import Path
from typing import Annotated

import typer

from aos_deploy.exit_codes import ExitCode
from aos_deploy.history_check.check import BY_TIME, RULES
from aos_deploy.history_check.files import check_run
from aos_deploy.history_check.replayed import Replay, replayed
from aos_deploy.options import AsJson, OneRun, Runs, command
from aos_deploy.printing import count, from_here, print_json
from aos_deploy.runs.living import chosen_run, runs_here
from aos_deploy.terminal import waiting
from aos_protocol.errors import DeployError


@command("Example: aos check runs/latest")
def check(
    run: OneRun = None,
    runs: Runs = None,
    replay: Annotated[
        bool, typer.Option("--replay/--no-replay", help="Replay the outcomes through the run's model")
    ] = True,
    as_json: AsJson = False,
) -> None:
    """Check a run's journal and ledgers against each other.

    An id moved at most once, each decision follows its journalled belief, each outcome belongs to its
    intention, and so on. A replay of the outcomes gives the journalled beliefs again; for that the run's
    model is compiled where it is not in the cache. The exit code is 1 where a row breaks a rule.
    """
    directory = chosen_run(run, runs or runs_here())
    if directory.is_running:
        raise DeployError(
            f"{from_here(directory.named)} goes on", code="AOS901", hint="Check it when it has ended"
        )
    checked = check_run(directory.path)
    found = checked.violations
    again = _replayed(directory.path) if replay else Replay(remark="not asked for")
    found += again.violations
    if as_json:
        print_json(
            {
                "run": str(from_here(directory.named)),
                "rules": RULES,
                "violations": found,
                "clock_set_back_s": checked.set_back_ns / 1e9,
                "replayed": {"beliefs": again.compared, "remark": again.remark},
            }
        )
    else:
        for violation in found:
            where = f"{violation.file}:{violation.row}" if violation.row else violation.file
            typer.echo(f"{where}: {violation.rule}: {violation.text}")
        if checked.set_back_ns:
            typer.echo(
                f"the clock was set back by {checked.set_back_ns / 1e9:,.2f} s while it ran: "
                f"{' and '.join(BY_TIME)} are checked of the journal alone"
            )
        broken = ", ".join(sorted({violation.rule for violation in found}))
        verdict = f"{count(len(found), 'violation')} of {broken}" if found else f"all {len(RULES)} rules hold"
        typer.echo(f"{from_here(directory.named)}: {verdict}; {_text(again)}")
    if found:
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


def _replayed(run: Path) -> Replay:
    with waiting("replaying the outcomes") as told:
        return asyncio.run(replayed(run, told))


def _text(replay: Replay) -> str:
    why = f" ({replay.remark})" if replay.remark else ""
    return f"{count(replay.compared, 'belief')} replayed{why}"
