"""`aos new`: documents to start from, that lint clean and can be planned with at once, and examples."""

import os
import re
import shutil
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Annotated

import typer

from aos_deploy.adapter_templates import KINDS, ROS_KINDS, adapter_files
from aos_deploy.bundles.files import refusal
from aos_deploy.deployment.reading import read_deploy_file
from aos_deploy.places import deploy_files, shipped
from aos_deploy.systemd_unit import unit_name, unit_of
from aos_language.convert import Dialect, convert
from aos_language.cpp.keywords import CPP_KEYWORDS
from aos_language.load import load_bundle, pushed_project, read_bundle_files
from aos_protocol.errors import DocumentError
from aos_protocol.spelling import did_you_mean

_NAME = re.compile(r"[a-z][a-z0-9_]{0,63}")

new_app = typer.Typer(
    name="new",
    no_args_is_help=True,
    help="Write documents, an adapter or a whole example.",
    epilog="Example: aos new project fetch, then aos plan fetch",
)


@new_app.command(epilog="Example: aos new project fetch")
def project(
    name: Annotated[str, typer.Argument(help="The project's name, in small letters")],
    folder: Annotated[Path, typer.Option("--in", help="Where the bundle's directory is made")] = Path(),
    dialect: Annotated[Dialect, typer.Option(help="The language of the documents")] = Dialect.SDL,
) -> None:
    """Write a small project.

    An environment and two skills, one that senses and one that acts.
    """
    _check_name(name, "project")
    bundle = folder / name
    texts = {file: text for file, text in _filled("project", project=name).items() if file != "project.ef"}
    texts[f"{name}.ef"] = _filled("project", project=name)["project.ef"]
    _write(bundle, _in_dialect(texts, dialect))
    typer.echo(f"Look at it:  aos plan {bundle}\nPlay it:     aos simulate {bundle} --runs 20")
    typer.echo(f"Add a skill: aos new skill NAME --in {bundle}")


@new_app.command(epilog="Example: aos new skill wipe --in fetch")
def skill(
    name: Annotated[str, typer.Argument(help="The skill's name, in small letters")],
    bundle: Annotated[Path, typer.Option("--in", help="The bundle's directory")] = Path(),
    with_mapping: Annotated[
        bool,
        typer.Option("--mapping/--no-mapping", help="Whether NAME.am is written; without it AOS derives one"),
    ] = True,
) -> None:
    """Write a skill's two documents into a bundle.

    NAME.sd and NAME.am, in JSON if all the bundle's documents are.
    """
    _check_name(name, "skill")
    documents, _ = read_bundle_files(bundle)
    owner = pushed_project(documents)
    if not owner:
        hint = "Name a bundle with --in, or start one: aos new project NAME"
        raise DocumentError(f"there are no documents in {bundle}", code="AOS120", hint=hint)
    texts = _filled("skill", project=owner, skill=name)
    texts = {
        file.replace("skill.", f"{name}."): text
        for file, text in texts.items()
        if with_mapping or not file.endswith(".am")
    }
    is_json = all(file.endswith(".json") for file in documents)
    _write(bundle, _in_dialect(texts, Dialect.JSON if is_json else Dialect.SDL))
    typer.echo(f"Check it: aos lint {bundle}")


@new_app.command(epilog="Example: aos new adapter python --in fetch")
def adapter(
    kind: Annotated[str, typer.Argument(help=f"Of {', '.join(KINDS)}", autocompletion=lambda: list(KINDS))],
    bundle: Annotated[Path, typer.Option("--in", help="The bundle's directory")],
    folder: Annotated[Path, typer.Option("--to", help="Where the files are made")] = Path(),
) -> None:
    """Write a deploy file and an adapter for a bundle.

    The program has a function for each path, with its fields and its result. It moves nothing yet.
    """
    if kind not in KINDS:
        hint = did_you_mean(kind, KINDS) or f"Known are {', '.join(KINDS)}"
        raise DocumentError(f"there is no template for the adapter {kind}", code="AOS126", hint=hint)
    loaded = load_bundle(bundle)
    if loaded.project is None:
        raise refusal(bundle, loaded.diagnostics, f"See aos lint {bundle}")
    way = os.path.relpath(bundle.resolve(), folder.resolve())
    _write(folder, adapter_files(kind, loaded.project, way))
    deploy = folder / f"{loaded.project.name}.yaml"
    if kind in ROS_KINDS:
        typer.echo(f"Read {folder / 'interfaces' / 'README.md'}, and then")
    if kind == "external":
        typer.echo(f"Start it by hand as {folder / loaded.project.name}_robot.py says, and then")
    typer.echo(f"Run it:      aos-up {deploy}\nWithout it:  aos-up {deploy} --model")


@new_app.command(epilog="Example: aos new example armadillo")
def example(
    name: Annotated[
        str,
        typer.Argument(help=f"Of {', '.join(deploy_files())}", autocompletion=lambda: list(deploy_files())),
    ],
    folder: Annotated[Path | None, typer.Option("--in", help="A new directory; without it NAME here")] = None,
) -> None:
    """Write a system that runs.

    The deploy file, its bundles and its world are copies, to be run and to be changed.
    """
    if name not in deploy_files():
        hint = did_you_mean(name, deploy_files()) or f"There are {', '.join(deploy_files())}"
        raise DocumentError(f"there is no example {name}", code="AOS101", hint=hint)
    target = folder or Path(name)
    _copy(deploy_files()[name], target)
    deploy = target / f"{name}.yaml"
    typer.echo(f"Run it:      aos-up {deploy}\nLook at it:  aos plan {deploy} --exact")


@new_app.command(epilog="Example: aos new unit deploy/armadillo.yaml --user robot")
def unit(
    deploy: Annotated[Path, typer.Argument(help="The deploy file")],
    folder: Annotated[Path, typer.Option("--to", help="Where the file is made")] = Path(),
    user: Annotated[str, typer.Option(help="Who runs it; else who you are")] = "",
) -> None:
    """Write a systemd unit that starts a mission at boot.

    It confines the mission to what it needs. The file says how it is taken into use.
    """
    deployment = read_deploy_file(deploy)
    name = unit_name(deployment)
    deployment.runs.mkdir(parents=True, exist_ok=True)  # systemd takes no folder that is not there.
    _write(folder, {name: unit_of(deployment, user)})
    typer.echo(f"Check it:    systemd-analyze verify {folder / name}")
    typer.echo(
        f"Use it:      sudo cp {folder / name} /etc/systemd/system/ && sudo systemctl enable --now {name}"
    )


def _copy(deploy: Path, target: Path) -> None:
    """A deploy file and what it names, at the same places beside it, into a directory that is new."""
    named = read_deploy_file(deploy)
    found = [deploy, *named.bundles, *(path for path in (named.world, named.policy) if path is not None)]
    given = [named.file.serve, *(plan.options for plan in named.adapters)]
    found += [deploy.parent / place for part in given for place in part.get("interfaces", [])]
    try:
        target.mkdir(parents=True, exist_ok=True)
        if any(target.iterdir()):
            hint = "Nothing was written; name another directory with --in"
            raise DocumentError(f"{target} is not empty", code="AOS111", hint=hint)
        for source in found:
            copy = target / source.resolve().relative_to(shipped("deploy"))
            copy.parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, copy)
            else:
                shutil.copy(source, copy)
            typer.echo(f"wrote {copy}")
    except OSError as error:
        raise DocumentError(f"{target} cannot be written: {error.strerror}", code="AOS101") from error


def _check_name(name: str, kind: str) -> None:
    if not _NAME.fullmatch(name):
        hint = "It starts with a small letter; small letters, digits and _ follow, 64 in all at most"
        raise DocumentError(f"{name!r} is no name for a {kind}", code="AOS126", hint=hint)
    if kind == "skill" and name in CPP_KEYWORDS:
        raise DocumentError(f"{name} means something else in C++", code="AOS126", hint="Choose another name")


def _filled(kind: str, **names: str) -> dict[str, str]:
    """The templates of a kind by file name, with the names put in."""
    folder = files("aos_deploy") / "templates" / kind
    return {
        template.name: Template(template.read_text("utf-8")).substitute(names)
        for template in folder.iterdir()
    }


def _in_dialect(texts: dict[str, str], dialect: Dialect) -> dict[str, str]:
    """The templates are in SDL."""
    if dialect is Dialect.SDL:
        return texts
    return convert({file: text.encode() for file, text in texts.items()}, dialect)[0]


def _write(folder: Path, texts: dict[str, str]) -> None:
    """All files, or none if one of them is there already."""
    there = [file for file in sorted(texts) if (folder / file).exists()]
    if there:
        hint = "Nothing was written; take another name"
        raise DocumentError(f"{folder} has {', '.join(there)} already", code="AOS111", hint=hint)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for file, text in sorted(texts.items()):
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_text(text, encoding="utf-8")
    except OSError as error:
        raise DocumentError(f"{folder} cannot be written: {error.strerror}", code="AOS101") from error
    # Last: whoever reads this may have gone.
    for file in sorted(texts):
        typer.echo(f"wrote {folder / file}")
