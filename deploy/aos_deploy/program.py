"""The services of a system, as aos-up starts them: in which order, with which settings, within what time."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import msgspec

from aos_deploy.deploy_file import Deployment
from aos_runtime.service_settings import ServiceSettings

__all__ = ["Program", "cache_dir", "programs_of_deployment", "settings_of"]


class Program(msgspec.Struct, frozen=True, kw_only=True):
    """A service to be supervised.

    `settings` are what it is told beyond robot, endpoint and run directory. It is ready when its liveliness
    token is seen; `start_s` bounds that, `stop_s` the time between SIGTERM and SIGKILL.
    """

    name: str
    module: str
    settings: dict[str, Any] = {}
    start_s: float = 20.0
    stop_s: float = 3.0

    @property
    def argv(self) -> list[str]:
        """The command line without the settings file."""
        return [sys.executable, "-m", self.module]


def programs_of_deployment(deployment: Deployment) -> tuple[Program, ...]:
    """The services in the order in which they must become ready, the router not among them."""
    file = deployment.file
    project = {"project": deployment.project}
    activation = {"activation_timeout_s": file.mission.activation_timeout_s}
    registry = {"watch": str(deployment.watch)} if deployment.watch else {}
    skills = {"world": str(deployment.world) if deployment.world else "", "bind": file.bind}
    return (
        Program(name="registry", module="aos_registry", settings=registry),
        Program(name="middleware", module="aos_middleware", settings=project | activation),
        Program(
            name="skills",
            module="aos_skills",
            settings=skills | {"seed": file.solver.seed},
            start_s=60.0,
            stop_s=20.0,  # It makes the mission's picture while it stops.
        ),
        Program(name="solver", module="aos_solver", settings=_solver_settings(deployment), stop_s=5.0),
    )


def _solver_settings(deployment: Deployment) -> dict[str, Any]:
    file = deployment.file
    budget = {name: value for name, value in msgspec.structs.asdict(file.solver).items() if value is not None}
    return {
        "project": deployment.project,
        "cache_dir": str(cache_dir()),
        **budget,
        "policy": str(deployment.policy or ""),
        **msgspec.structs.asdict(file.mission),
    }


def cache_dir() -> Path:
    """Where compiled models are kept: $AOS_CACHE_DIR, or `aos` in the user's cache directory."""
    if named := os.environ.get("AOS_CACHE_DIR"):
        return Path(named).absolute()
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "aos"


def settings_of(program: Program, base: ServiceSettings) -> dict[str, Any]:
    """What the service's settings file holds."""
    return {**msgspec.structs.asdict(base), **program.settings}
