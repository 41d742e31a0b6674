"""`aos calibrate`: the probabilities of documents, beside what recorded missions say of them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.table import Table

from aos_deploy.options import AsJson, TrustDocuments, command, writable
from aos_deploy.printing import count, print_json
from aos_deploy.terminal import interruption_told, print_table, progress
from aos_deploy.views.values import Digits

if TYPE_CHECKING:
    from aos_lab.calibration.calibrate import Calibration
    from aos_lab.calibration.estimation import DrawEstimate

SHOWN_REMARKS = 5


@command(
    "Example: aos calibrate runs deploy/bundles/armadillo-finer "
    "--also deploy/bundles/armadillo-retract --write changes.patch"
)
def calibrate(
    runs: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN...",
            exists=True,
            help="Run directories, folders of recorded missions, files of `aos export`",
        ),
    ],
    bundle: Annotated[
        Path,
        typer.Argument(
            metavar="BUNDLE",
            exists=True,
            help="The documents; or a deploy file, for its bundles without what it leaves out",
        ),
    ],
    also: Annotated[
        list[Path] | None, typer.Option(metavar="BUNDLE", exists=True, help="More documents; repeatable")
    ] = None,
    write: Annotated[
        Path | None, typer.Option(metavar="PATCH", help="Write the proposed changes here", callback=writable)
    ] = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Estimate the documents' probabilities from missions.

    Prints each with a 95 % interval beside the document's number. Numbers
    that the records do not allow make a patch, which is never applied here.
    """
    # Numbers take a tenth of a second to import.
    from aos_lab.calibration.calibrate import calibrate as calibrate_bundles
    from aos_lab.calibration.records import read_missions

    missions = [mission for path in runs for mission in read_missions(path)]
    with progress() as bar, interruption_told(lambda: "stopped; nothing was estimated"):
        reading = bar.add_task("missions", total=len(missions))
        drawing = bar.add_task("what they leave open", total=None, visible=False)
        result = calibrate_bundles(
            missions,
            [bundle, *(also or ())],
            on_build=lambda text: bar.update(reading, description=text),
            on_mission=lambda: bar.update(reading, description="missions", advance=1),
            on_sweep=lambda done, of: bar.update(drawing, completed=done, total=of, visible=True),
        )
    if write is not None:
        write.write_text(result.patch, encoding="utf-8")
    if as_json:
        print_json(result)
        return
    print_calibration(result)
    if write is not None and result.patch:
        by = f"git apply {write}" if result.patch_folder == "." else f"git -C / apply {write.absolute()}"
        typer.echo(f"the patch is in {write}; apply it with `{by}`")


def print_calibration(result: Calibration) -> None:
    """The table, what was left out, and the patch."""
    typer.echo(f"{count(result.missions, 'mission')}, {count(result.steps, 'step')}")
    table = Table(box=box.SIMPLE, pad_edge=False)
    for name in ("place", "outcome", "count", "records", "document", ""):
        is_text = name in ("place", "outcome", "")
        table.add_column(name, justify="left" if is_text else "right", overflow="fold", no_wrap=not is_text)
    for estimate in result.estimates:
        rarest = min((each.document for each in estimate.outcomes if each.document), default=1.0)
        digits = Digits.of([0.1 if rarest >= 0.01 else rarest], 2)
        for number, outcome in enumerate(estimate.outcomes):
            span = estimate.draw.span
            place = f"{span.file}:{span.line}" if number == 0 else ""
            interval = outcome.probability
            table.add_row(
                place,
                outcome.outcome,
                f"{outcome.count:.{0 if estimate.is_counted else 1}f} of {estimate.count:.0f}",
                "{} [{}, {}]".format(*map(digits.plain, (interval.value, interval.low, interval.high)))
                if estimate.count
                else "",
                digits.plain(outcome.document),
                _verdict(estimate, number, result.missions),
            )
        table.add_section()
    print_table(table)
    for skipped in result.skipped:
        typer.echo(f"{skipped.span}: not estimated: {skipped.why}")
    for remark in result.remarks[:SHOWN_REMARKS]:
        typer.echo(f"not used to its end: {remark}")
    if len(result.remarks) > SHOWN_REMARKS:
        typer.echo(f"and {len(result.remarks) - SHOWN_REMARKS} more; --json tells them all")
    for line in result.by_hand:
        typer.echo(line)
    typer.echo(result.patch.rstrip() or "the records contradict no number")


def _verdict(estimate: DrawEstimate, number: int, missions: int) -> str:
    if not estimate.count:
        return "no record" if number == 0 else ""
    if not estimate.outcomes[number].is_inside:
        return "outside, and may be chance" if estimate.may_be_chance else "OUTSIDE"
    return "inside" if number or not estimate.is_inside else f"inside; {_to_tell(estimate, missions)}"


def _to_tell(estimate: DrawEstimate, missions: int) -> str:
    """Says how many more missions the records need, if those come to this draw as often as these."""
    missing = estimate.records_to_tell - estimate.count
    if missing <= 0:
        return "enough records"
    return f"to tell otherwise: about {count(math.ceil(missing * missions / estimate.count), 'more mission')}"
