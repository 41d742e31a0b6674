"""`aos experiment`: the missions of an experiment, and its report."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from aos_deploy.options import HELP_NAMES, AsJson
from aos_deploy.printing import from_here, print_json
from aos_deploy.shipped import shipped
from aos_deploy.terminal import progress
from aos_protocol.errors import DeployError
from aos_runtime.distribution import pip_install

if TYPE_CHECKING:
    from aos_lab.experiments.optimum import Optimum
    from aos_lab.trials.setting import Setting

__all__ = ["register"]


def register(app: typer.Typer) -> None:
    """Adds the command to `aos`."""
    group = typer.Typer(
        no_args_is_help=True,
        context_settings=HELP_NAMES,
        rich_markup_mode=None,
        help="Run an experiment's missions, and see which of its claims hold.",
    )
    group.callback()(lambda: None)
    group.command(epilog="Example: aos experiment run armadillo --seeds 20 --system-seeds 4 --jobs 2")(run)
    group.command(epilog="Example: aos experiment statistics armadillo --repeat 3")(statistics)
    app.add_typer(group, name="experiment")


def run(
    name: Annotated[str, typer.Argument(metavar="NAME", help="A file in deploy/experiments, or any file")],
    seeds: Annotated[int, typer.Option(min=0, help="Missions that the model plays, of each part")] = 100,
    system_seeds: Annotated[
        int, typer.Option(min=0, help="Missions of the whole system with its adapters, of each part")
    ] = 0,
    first_seed: Annotated[int, typer.Option(min=0, help="The seeds begin here")] = 1,
    part: Annotated[list[str] | None, typer.Option(help="Only this part; repeatable")] = None,
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
) -> None:
    """Run missions of all parts and write a report.

    The report has every claim with whether it was seen, and figures with
    intervals. A run that was interrupted goes on where it was: missions that
    are recorded are not run again, unless documents or settings have changed.
    """
    _check_place(on, system_seeds)
    _check_installed()
    from aos_lab.experiments.optimum import regret_of
    from aos_lab.experiments.physics import keep_picture
    from aos_lab.experiments.plots import draw_plots
    from aos_lab.experiments.report import write_report
    from aos_lab.experiments.results import PartResult, Results, result_of, surroundings
    from aos_lab.trials.campaign import play_campaign
    from aos_lab.trials.files import read_experiment

    path = _experiment_file(name)
    experiment = read_experiment(path)
    unknown = set(part or ()) - set(experiment.parts)
    if unknown:
        known = ", ".join(experiment.parts)
        raise typer.BadParameter(f"{sorted(unknown)[0]} is none of {known}", param_hint="--part")
    folder = (out or Path("experiments") / path.stem).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    parts = {key: value for key, value in experiment.parts.items() if not part or key in part}
    wanted = {"model": seeds, "system": system_seeds}
    results: list[PartResult] = []
    with progress() as bar:
        for by, number in wanted.items():
            for key, setup in parts.items() if number else ():
                task = bar.add_task(f"{key}, {by}", total=number)
                # Faults are the simulated world's; the model's world has none.
                setting = msgspec.structs.replace(setup, by=by, faults={} if by == "model" else setup.faults)
                played = asyncio.run(
                    play_campaign(
                        setting,
                        range(first_seed, first_seed + number),
                        folder=path.parent,
                        out=folder / by / key,
                        jobs=jobs,
                        on_trial=partial(bar.advance, task),
                        on=on,
                        on_progress=lambda text: typer.echo(text, err=True),
                    )
                )
                result = result_of(key, setup, by, played, experiment)
                if by == "model" and experiment.optimum:
                    optimum = _known_optimum(folder / by / key, played.digest, setting, path.parent)
                    result = msgspec.structs.replace(result, regret=regret_of(optimum, played.trials))
                elif by == "system":
                    target = folder / "pictures" / f"{key}.png"
                    if keep_picture(folder / by / key / "runs", result.seeds, target):
                        picture = str(target.relative_to(folder))
                        result = msgspec.structs.replace(result, picture=picture)
                results.append(result)
    whole = Results(
        name=path.stem,
        title=experiment.title,
        about=experiment.about,
        command=_command(name, seeds, system_seeds, first_seed, part or ()),
        surroundings=surroundings(),
        parts=tuple(results),
    )
    (folder / "report.json").write_bytes(msgspec.json.format(msgspec.json.encode(whole), indent=2))
    pages = write_report(whole, draw_plots(whole, folder / "plots"), folder)
    if as_json:
        print_json(whole)
        return
    for result in results:
        for verdict in result.verdicts:
            word = verdict.word if verdict.is_seen else verdict.word.upper()
            print(
                f"{word:8} {result.name} ({result.by}): {verdict.says}: {verdict.held} of {verdict.missions}"
            )
    print(f"the report is in {from_here(pages[0])} and {from_here(pages[1])}")


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
    from aos_lab.calibration.calibrate import Calibration, calibrate
    from aos_lab.calibration.records import RecordedMission, read_missions
    from aos_lab.experiments.markdown import page
    from aos_lab.experiments.results import surroundings
    from aos_lab.experiments.statistics import ScriptedStep, Statistics, markdown_statistics, steps_of
    from aos_lab.trials.campaign import play_campaign
    from aos_lab.trials.files import read_script_file

    path = _experiment_file(name, "deploy/experiments/statistics")
    file = read_script_file(path)
    folder = (out or Path("experiments") / f"{path.stem}-statistics").resolve()
    missions: list[RecordedMission] = []
    steps: list[ScriptedStep] = []
    seeds: dict[str, str] = {}
    broken: dict[str, int] = {}
    with progress() as bar:
        for key, part in file.parts.items():
            number = part.missions * repeat
            task = bar.add_task(key, total=number)
            # No two scripts have the same seeds.
            begin = first_seed + sum(
                setup.missions * repeat for setup in list(file.parts.values())[: len(seeds)]
            )
            played = asyncio.run(
                play_campaign(
                    msgspec.structs.replace(part, by="system"),
                    range(begin, begin + number),
                    folder=path.parent,
                    out=folder / key,
                    jobs=1,
                    on_trial=partial(bar.advance, task),
                )
            )
            seeds[key] = f"{begin} to {begin + number - 1}"
            broken[key] = sum(bool(trial.fault) for trial in played.trials)
            wanted = {trial.seed for trial in played.trials if not trial.fault}
            recorded = [mission for mission in read_missions(folder / key) if mission.seed in wanted]
            missions += recorded
            steps += steps_of(key, recorded)
    calibrations: dict[str, Calibration] = {}
    for key, bundles in file.calibrates.items():
        paths = [(path.parent / bundle).resolve() for bundle in bundles]
        calibrations[key] = asyncio.run(calibrate(missions, paths))
    found = Statistics(
        name=path.stem,
        title=file.title,
        about=file.about,
        command=f"aos experiment statistics {name} --repeat {repeat}",
        surroundings=surroundings(),
        seeds=seeds,
        broken=broken,
        steps=tuple(steps),
        calibrations=calibrations,
    )
    (folder / "report.json").write_bytes(msgspec.json.format(msgspec.json.encode(found), indent=2))
    (folder / "report.md").write_text(markdown_statistics(found))
    (folder / "report.html").write_text(page(found.title, markdown_statistics(found)))
    if as_json:
        print_json(found)
        return
    for step in found.steps:
        shares = ", ".join(f"{response} {share.value:.2f}" for response, share in step.responses.items())
        print(f"{step.part} {step.number} {step.action}: {shares}")
    print(f"the report is in {from_here(folder / 'report.md')}")


def _command(name: str, seeds: int, system_seeds: int, first_seed: int, parts: Sequence[str]) -> str:
    """Returns the command that runs the same missions again."""
    command = f"aos experiment run {name} --seeds {seeds} --system-seeds {system_seeds}"
    if first_seed != 1:
        command += f" --first-seed {first_seed}"
    return command + "".join(f" --part {part}" for part in parts)


def _known_optimum(out: Path, digest: str, setting: Setting, folder: Path) -> Optimum:
    """Reads the optimum that was worked out for the same documents and settings, or works it out now."""
    from aos_lab.experiments.optimum import Optimum, optimum_of
    from aos_lab.trials.setting import deployment_of

    kept = out / f"best-{digest}.json"
    if kept.is_file():
        return msgspec.json.decode(kept.read_bytes(), type=Optimum)
    optimum = asyncio.run(optimum_of(deployment_of(setting, folder, out)))
    kept.write_bytes(msgspec.json.encode(optimum))
    return optimum


def _check_place(on: str, system_seeds: int) -> None:
    """BadParameter where missions cannot be run."""
    if on == "local":
        return
    if on != "ray" and not on.startswith("ray://"):
        hint = "local, ray://HOST:PORT, or ray for a Ray of its own on this machine"
        raise typer.BadParameter(f"{on!r} is none of {hint}", param_hint="--on")
    if system_seeds:
        raise typer.BadParameter(
            "missions of the whole system are run here: leave --on out", param_hint="--on"
        )


def _check_installed() -> None:
    """Raises DeployError AOS805 before anything has run, if the report could not be made in the end."""
    for package in ("matplotlib", "markdown_it"):
        if find_spec(package) is None:
            raise DeployError(
                f"a report needs the package {package}, which is not installed",
                code="AOS805",
                hint=f"Run {pip_install('report')}",
            )


def _experiment_file(name: str, where: str = "deploy/experiments") -> Path:
    """The file of that name, or the shipped experiment."""
    given = Path(name)
    if given.suffix in (".yaml", ".yml"):
        return given.resolve()
    known = {path.stem: path for path in sorted(shipped(where).glob("*.yaml"))}
    if name not in known:
        raise typer.BadParameter(
            f"{name} is none of {', '.join(known)}, and no .yaml file", param_hint="NAME"
        )
    return known[name]
