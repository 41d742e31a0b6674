"""`aos export`: the records of runs to take home."""

import json
from pathlib import Path
from typing import Annotated, Literal

import typer

from aos_deploy.options import AsJson, ChosenRuns, Runs, command
from aos_deploy.printing import count, from_here, print_json
from aos_deploy.runs.living import chosen_runs
from aos_protocol.errors import DeployError

Format = Literal["mcap", "csv", "parquet", "bundle"]


@command("Example: aos export runs/latest --format mcap")
def export(
    run: ChosenRuns = None,
    format: Annotated[Format, typer.Option("--format", help="What is written")] = "mcap",
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="PATH", help="Instead of a name here after the run's"),
    ] = None,
    otlp: Annotated[
        str | None,
        typer.Option(
            "--otlp", metavar="URL", help="Write nothing: send OpenTelemetry's spans to this collector"
        ),
    ] = None,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Write the records of runs to files to take home.

    mcap: a file for Foxglove, Lichtblick and PlotJuggler for each run, with a layout for each of them. csv,
    parquet: a folder of tables of all runs together. bundle: one file with whole runs, which `aos decisions`,
    `aos check` and `aos serve` open. With --otlp spans go to a collector, such as http://127.0.0.1:4318. A
    run that goes on is exported as far as it is.
    """
    chosen = chosen_runs(run, runs)
    if otlp is not None:
        _send_spans(chosen, otlp, as_json=as_json)
        return
    written = _WRITERS[format](chosen, output)
    if as_json:
        print_json({"files": {str(from_here(path)): said for path, said in written.items()}})
        return
    for path, said in written.items():
        typer.echo(f"{from_here(path)}: {said}")


def _send_spans(runs: list[Path], address: str, *, as_json: bool) -> None:
    from aos_deploy.deployment.hosts import is_collector_address
    from aos_deploy.runs.directory import RunDirectory
    from aos_deploy.spans.otlp import Collector
    from aos_deploy.spans.sending import Sender

    if not is_collector_address(address):
        raise typer.BadParameter("write it as http://127.0.0.1:4318", param_hint="--otlp")
    sent: dict[str, int] = {}
    for run in runs:
        collector = Collector(address, RunDirectory(run).read_record().robot)
        collector.check_reachable()
        number, is_whole = Sender(run, collector, keeps_place=False).send()
        if not is_whole:
            hint = "Start a collector that takes OTLP over HTTP, or name another address"
            raise DeployError(f"{collector.address} does not take spans", code="AOS805", hint=hint)
        sent[str(from_here(run))] = number
    if as_json:
        print_json({"spans": sent})
        return
    for path, number in sent.items():
        typer.echo(f"{path}: {count(number, 'span')} sent")


def _mcap(runs: list[Path], output: Path | None) -> dict[Path, str]:
    from aos_deploy.export.kept_missions import kept_missions
    from aos_deploy.export.layouts import curves_of, foxglove_layout, plotjuggler_layout
    from aos_deploy.export.mcap_file import write_mcap

    if output is not None and len(runs) > 1 and output.suffix:
        raise DeployError("one MCAP file holds one run", code="AOS901", hint="Name a folder with --output")
    written: dict[Path, str] = {}
    for run in runs:
        name = run.resolve().name
        target = Path(f"{name}.mcap") if output is None else output
        if target.is_dir() or not target.suffix:
            target.mkdir(parents=True, exist_ok=True)
            target = target / f"{name}.mcap"
        target.parent.mkdir(parents=True, exist_ok=True)
        written[target] = count(write_mcap(run, target), "message")
        curves = curves_of(record for mission in kept_missions(run) for record in mission.decisions())
        has_pictures = any((run / "pictures").glob("step-*.png"))
        foxglove = target.with_suffix(".foxglove.json")
        foxglove.write_text(json.dumps(foxglove_layout(curves, has_pictures=has_pictures), indent=2) + "\n")
        plotjuggler = target.with_suffix(".plotjuggler.xml")
        plotjuggler.write_text(plotjuggler_layout(curves))
        written[foxglove] = "a layout for Foxglove and Lichtblick"
        written[plotjuggler] = "a layout for PlotJuggler"
    return written


def _tables(runs: list[Path], output: Path | None, kind: str) -> dict[Path, str]:
    from aos_deploy.export.table_files import write_csv, write_parquet
    from aos_deploy.export.tables import rows_of_runs

    folder = output or Path(f"{runs[0].resolve().name}-{kind}")
    folder.mkdir(parents=True, exist_ok=True)
    counts = (write_csv if kind == "csv" else write_parquet)(rows_of_runs(runs), folder)
    return {folder / f"{table}.{kind}": count(number, "row") for table, number in counts.items()}


def _bundle(runs: list[Path], output: Path | None) -> dict[Path, str]:
    from aos_deploy.export.run_bundle import SUFFIX, write_bundle

    target = output or Path(f"{runs[0].resolve().name}{SUFFIX}")
    target.parent.mkdir(parents=True, exist_ok=True)
    files = write_bundle(runs, target)
    return {target: f"{count(len(runs), 'run')}, {count(files, 'file')}"}


_WRITERS = {
    "mcap": _mcap,
    "csv": lambda runs, output: _tables(runs, output, "csv"),
    "parquet": lambda runs, output: _tables(runs, output, "parquet"),
    "bundle": _bundle,
}
