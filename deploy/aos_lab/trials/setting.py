"""The setting of a mission: a deploy file, and what is different from it."""

from pathlib import Path
from typing import Any, Literal

import msgspec
from msgspec.structs import replace
from ruamel.yaml import YAML

from aos_deploy.bundles.files import project_of
from aos_deploy.deployment.mission_values import values_of_mapping
from aos_deploy.deployment.parts import BusPart
from aos_deploy.deployment.reading import Deployment, read_deploy_file, without_a_robot
from aos_deploy.played.faults import PlayedFaults
from aos_deploy.processes.needed_here import check_sandbox
from aos_protocol.diagnostics import Span
from aos_protocol.errors import DeployError

Player = Literal["model", "system", "system-model"]
"""The player of the skills: the documents' model in this process, or a whole system, by the deploy file's
adapters or by the model."""


class Setting(msgspec.Struct, frozen=True, kw_only=True):
    """`bundles` stand in place of the deploy file's; `simulations` and `step_limit` too.

    `world_bundles` are documents that play the world in missions of the model, in place of the ones that the
    robot plans with, which may be wrong about the world. They have the same actions.

    `unconstrained` leaves out the deploy file's constraints. `faults` are values for the world file's
    `faults` in a simulated world, and those of `PlayedFaults` where the model plays in a whole system. With a
    `script` its actions are carried out in the simulated world, one after the other, and nothing is planned.
    `set` gives values to mission parameters, where the deploy file gives none or others.
    """

    deploy: str
    by: Player = "model"
    bundles: tuple[str, ...] = ()
    world_bundles: tuple[str, ...] = ()
    simulations: int | None = None
    step_limit: int | None = None
    unconstrained: bool = False
    faults: dict[str, float] = {}
    script: tuple[str, ...] = ()
    set: dict[str, Any] = {}


def deployment_of(setting: Setting, folder: Path, out: Path) -> Deployment:
    """The deployment of a setting, on a free port; `folder` is where its paths begin.

    `out` takes a copy of the world file where faults are other ones. DeployError where they do not fit.
    """
    deployment = read_deploy_file(folder / setting.deploy)
    check_sandbox(deployment)
    file = replace(deployment.file, bus=BusPart(listen="tcp/127.0.0.1:0"))
    if setting.simulations is not None:
        solver = replace(file.solver, simulations=setting.simulations, time_s=None)
        file = replace(file, solver=solver)
    if setting.step_limit is not None:
        mission = replace(file.mission, step_limit=setting.step_limit)
        file = replace(file, mission=mission)
    if setting.unconstrained:
        file = replace(file, mission=replace(file.mission, constraints=()))
        deployment = replace(deployment, constraints=())
    values = values_of_mapping(setting.set, Span("set"))
    deployment = replace(deployment, mission_values=(*deployment.mission_values, *values))
    if setting.bundles:
        deployment = replace(deployment, bundles=_named(setting.bundles, folder))
    deployment = replace(deployment, file=file)
    if setting.by == "system-model":
        if setting.faults:
            PlayedFaults(setting.faults).check(skill.name for skill in project_of(deployment).skills)
        return without_a_robot(deployment, setting.faults)
    if setting.faults:
        return _with_faults(deployment, setting, out)
    return deployment


def world_deployment_of(setting: Setting, deployment: Deployment, folder: Path) -> Deployment | None:
    """The deployment whose documents play the world in missions of the model, where it is another one."""
    if not setting.world_bundles:
        return None
    return replace(deployment, bundles=_named(setting.world_bundles, folder))


def _named(names: tuple[str, ...], folder: Path) -> tuple[Path, ...]:
    bundles = tuple((folder / bundle).resolve() for bundle in names)
    for bundle in bundles:
        if not bundle.exists():
            raise DeployError(f"there is no bundle {bundle}", hint="Look at `bundles:`")
    return bundles


def _with_faults(deployment: Deployment, setting: Setting, out: Path) -> Deployment:
    """The deployment with a world file whose faults are other ones."""
    if deployment.world is None or setting.by != "system":
        hint = (
            "Faults are those of the deploy file's `world:` in missions `by: system`, or those of skills in "
            "missions `by: system-model`"
        )
        raise DeployError(f"{setting.deploy}: there is no simulated world to have faults", hint=hint)
    yaml = YAML(typ="safe", pure=True)
    world: dict[str, Any] = yaml.load(deployment.world.read_text(encoding="utf-8"))
    world["faults"] = {**world.get("faults", {}), **setting.faults}
    out.mkdir(parents=True, exist_ok=True)
    changed = out / f"world-{deployment.path.stem}.yaml"
    with changed.open("w", encoding="utf-8") as file:
        yaml.dump(world, file)
    adapters = tuple(
        replace(plan, options=plan.options | {"world": str(changed)})
        if plan.options.get("world") == str(deployment.world)
        else plan
        for plan in deployment.adapters
    )
    return replace(deployment, world=changed, adapters=adapters)
