"""`aos experiment`: the missions of an experiment, and its report."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer
from rich.progress import Progress

from aos_deploy.options import HELP_NAMES, AsJson, TrustDocuments, grouped
from aos_deploy.places import shipped
from aos_deploy.printing import count, from_here, json_text, print_json
from aos_deploy.terminal import progress
from aos_deploy.timed_lines import LINE_EVERY_S
from aos_lab.commands.interrupted import interruption_among_missions
from aos_protocol.errors import DeployError
from aos_runtime.distribution import pip_install

if TYPE_CHECKING:
    from aos_lab.experiments.results import Results
    from aos_lab.trials.claims import Verdict
    from aos_lab.trials.setting import Player


experiment_app = typer.Typer(
    name="experiment",
    no_args_is_help=True,
    context_settings=HELP_NAMES,
    rich_markup_mode=None,
    help="Run an experiment, and see which of its claims hold.",
    epilog="Example: aos experiment run armadillo --seeds 20",
)

_NAME: Any = typer.Argument(
    metavar="NAME",
    help="A file in deploy/experiments, or any file",
    autocompletion=lambda: list(_experiments()),
)


class MissionOptions(NamedTuple):
    """The missions of an experiment."""

    seeds: Annotated[int, typer.Option(min=0, help="Missions that the model plays, of each part")] = 100
    system_seeds: Annotated[
        int, typer.Option(min=0, help="Missions of the whole system with its adapters, of each part")
    ] = 0
    first_seed: Annotated[int, typer.Option(min=0, help="The seeds begin here")] = 1
    part: Annotated[list[str] | None, typer.Option(help="Only this part; repeatable")] = None

    def command(self, name: str) -> str:
        """Returns the command that runs the same missions again."""
        command = f"aos experiment run {name} --seeds {self.seeds} --system-seeds {self.system_seeds}"
        if self.first_seed != 1:
            command += f" --first-seed {self.first_seed}"
        return command + "".join(f" --part {part}" for part in self.part or ())


@experiment_app.command(epilog="Example: aos experiment run armadillo --seeds 20 --system-seeds 4 --jobs 2")
@grouped
def run(
    name: Annotated[str, _NAME],
    missions: MissionOptions,
    jobs: Annotated[
        int | None, typer.Option(min=1, help="Missions at a time; else 1, or a cluster's processors")
    ] = None,
    on: Annotated[
        str,
        typer.Option(
            metavar="WHERE", help="local, or ray://HOST:10001 for the model's missions on a Ray cluster"
        ),
    ] = "local",
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Records and report; else experiments/NAME")
    ] = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Run missions of all parts and write a report.

    The report has every claim with whether it was seen, and figures with
    intervals. A run that was interrupted goes on where it was: missions that
    are recorded are not run again, unless documents or settings have changed.
    """
    _check_place(on, missions)
    _check_installed()
    from aos_lab.experiments.results import Results, surroundings
    from aos_lab.experiments.running import ExperimentRun
    from aos_lab.trials.campaign import Place
    from aos_lab.trials.files import read_experiment

    path = _experiment_file(name)
    experiment = read_experiment(path)
    parts = missions.part or list(experiment.parts)
    unknown = set(parts) - set(experiment.parts)
    if unknown:
        known = ", ".join(experiment.parts)
        raise typer.BadParameter(f"{sorted(unknown)[0]} is none of {known}", param_hint="--part")
    folder = (out or Path("experiments") / path.stem).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    place = Place(on=on, jobs=jobs, on_progress=lambda text: typer.echo(f"aos: {text}", err=True))
    played = ExperimentRun(path, experiment, folder, missions.first_seed, place)
    names = [key for key in experiment.parts if key in parts]
    with progress() as bar, interruption_among_missions(bar, are_kept=True):
        by: dict[Player, int] = {"model": missions.seeds, "system": missions.system_seeds}
        results = tuple(played.results(names, by, partial(_begin, bar)))
    whole = Results(
        name=path.stem,
        title=experiment.title,
        about=experiment.about,
        command=missions.command(name),
        surroundings=surroundings(),
        parts=results,
    )
    _report(whole, folder, as_json)


def _report(whole: Results, folder: Path, as_json: bool) -> None:
    """Writes the report, and says what is in it."""
    from aos_lab.experiments.plots import draw_plots
    from aos_lab.experiments.report import write_report

    (folder / "report.json").write_text(json_text(whole), encoding="utf-8")
    pages = write_report(whole, draw_plots(whole, folder / "plots"), folder)
    if as_json:
        print_json(whole)
        return
    for result in whole.parts:
        for verdict in result.verdicts:
            print(verdict_line(f"{result.name} ({result.by})", verdict))
    print(f"the report is in {from_here(pages[0])} and {from_here(pages[1])}")


def verdict_line(part: str, verdict: Verdict) -> str:
    """A claim's line below an experiment: of one that was not seen also why."""
    from aos_lab.trials.junit import verdict_text

    if verdict.is_seen:
        return f"seen     {part}: {verdict.says}: {verdict.held} of {verdict.missions}"
    return f"{verdict.word.upper():8} {part}: {verdict.says}: {verdict_text(verdict)}"


@experiment_app.command(epilog="Example: aos experiment statistics armadillo --repeat 3")
def statistics(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="A file in deploy/experiments/statistics, or any file")
    ] = "armadillo",
    repeat: Annotated[int, typer.Option(min=1, help="So many times the missions that the file wants")] = 1,
    first_seed: Annotated[int, typer.Option(min=0, help="The seeds begin here")] = 1,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Records and report; else experiments/NAME-statistics")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Count how often skills succeed in a simulated world.

    The same actions are carried out in every mission. The report says what
    came of each, and what that says about the numbers of documents.
    """
    _check_installed()
    from aos_lab.experiments.markdown import page
    from aos_lab.experiments.running import statistics_of
    from aos_lab.experiments.statistics import markdown_statistics
    from aos_lab.trials.files import read_script_file

    path = _experiment_file(name, "deploy/experiments/statistics")
    folder = (out or Path("experiments") / f"{path.stem}-statistics").resolve()
    with progress() as bar, interruption_among_missions(bar, are_kept=True):
        found = statistics_of(
            path,
            read_script_file(path),
            f"aos experiment statistics {name} --repeat {repeat}",
            folder=folder,
            repeat=repeat,
            first_seed=first_seed,
            begin=partial(_begin, bar),
        )
    (folder / "report.json").write_text(json_text(found), encoding="utf-8")
    (folder / "report.md").write_text(markdown_statistics(found))
    (folder / "report.html").write_text(page(found.title, markdown_statistics(found)))
    if as_json:
        print_json(found)
        return
    for step in found.steps:
        shares = ", ".join(f"{response} {share.value:.2f}" for response, share in step.responses.items())
        print(f"{step.part} {step.number} {step.action}: {shares}")
    print(f"the report is in {from_here(folder / 'report.md')}")


def _begin(bar: Progress, text: str, total: int) -> Callable[[], None]:
    """Shows a new bar, or tells a log how many missions begin; the function moves it on by a mission."""
    if bar.disable:
        begin = f"{count(total, 'mission')} to play from start to end"
        typer.echo(
            f"aos: {text}: {begin}; a line every {LINE_EVERY_S:.0f} s tells how many are done", err=True
        )
    return partial(bar.advance, bar.add_task(text, total=total))


def _check_place(on: str, missions: MissionOptions) -> None:
    """BadParameter where missions cannot be run."""
    if not missions.seeds and not missions.system_seeds:
        raise typer.BadParameter("no missions: give --seeds or --system-seeds", param_hint="--seeds")
    if on == "local":
        return
    if on != "ray" and not on.startswith("ray://"):
        hint = "local, ray://HOST:PORT, or ray for a Ray of its own on this machine"
        raise typer.BadParameter(f"{on!r} is none of {hint}", param_hint="--on")
    if missions.system_seeds:
        raise typer.BadParameter(
            "missions of the whole system are run here: leave --on out", param_hint="--on"
        )


def _check_installed() -> None:
    """Raises DeployError AOS805 before anything has run, if the report could not be made in the end."""
    if find_spec("markdown_it") is None:
        message = "a report needs the package markdown_it, which is not installed"
        raise DeployError(message, code="AOS805", hint=f"Run {pip_install('report')}")


def _experiments(where: str = "deploy/experiments") -> dict[str, Path]:
    return {path.stem: path for path in sorted(shipped(where).glob("*.yaml"))}


def _experiment_file(name: str, where: str = "deploy/experiments") -> Path:
    given = Path(name)
    if given.suffix in (".yaml", ".yml"):
        return given.resolve()
    known = _experiments(where)
    if name not in known:
        raise typer.BadParameter(
            f"{name} is none of {', '.join(known)}, and no .yaml file", param_hint="NAME"
        )
    return known[name]
