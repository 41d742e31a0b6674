"""The services of a system, as aos-up starts them: in which order, with which settings, within what time."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec

from aos_deploy.deployment.adapter_kinds import MODEL
from aos_deploy.deployment.adapters import SPANS, AdapterPlan
from aos_deploy.deployment.own_programs import ProgramPart, ReadyPart
from aos_deploy.deployment.reading import Deployment
from aos_deploy.places import cache_dir
from aos_deploy.processes.passes import Outsider
from aos_protocol.access import ADAPTER, ROLES, SERVER, WATCHER, Party
from aos_runtime.processes.children import Limits, guarded
from aos_runtime.processes.settings import ServiceSettings

_LEFT_BEHIND_S = 2.0
"""Processes that an adapter which ended by itself has left behind have this time to end. It is less than that
after which a silent adapter is taken for frozen."""


class Program(msgspec.Struct, frozen=True, kw_only=True):
    """A service to be supervised.

    `settings` are what it is told beyond robot, endpoint and run directory. It is ready when its liveliness
    token is seen; `start_s` bounds that, `stop_s` the time between SIGTERM and SIGKILL. Where it
    `is_restarted`, it is started again when it ends by itself after it was ready, as `Restarts` says.
    With a `command` it is a program of the user's own: it gets its settings in the environment, is ready
    when it serves one of the `paths` that are bound to it, and may be started again before that, too. The
    word `python` stands for the Python that this runs in. With a `host` it runs there, in a `folder` of
    that host. Others may go on without an adapter.

    A program with an `on_exit` is none of the bus, and `on_exit` says what follows when it ends by itself.
    Where it is the user's own, the adapters start once it is `ready`.
    """

    name: str
    module: str = ""
    settings: dict[str, Any] = {}
    start_s: float = 20.0
    stop_s: float = 3.0
    is_restarted: bool = False
    command: tuple[str, ...] = ()
    folder: str | None = None
    host: str = ""
    paths: tuple[str, ...] = ()
    is_adapter: bool = False
    ready: ReadyPart | None = None
    on_exit: str = ""

    @property
    def is_own(self) -> bool:
        """True if it is one of the deploy file's `programs:`."""
        return bool(self.on_exit and self.command)

    @property
    def party(self) -> Party | None:
        """Its place on the bus; None for a program of the user's, which looks on like others."""
        if self.on_exit:
            return None
        if not self.is_adapter:
            return Party(name=self.name, role=self.name if self.name in ROLES else SERVER)
        return Party(
            name=self.name,
            role=ADAPTER,
            paths=self.paths,
            serves_others=self.settings.get("serves_others", False),
            elsewhere=tuple(self.settings.get("elsewhere", ())),
        )

    @property
    def user(self) -> str:
        """Its name on the bus."""
        return WATCHER if self.on_exit else self.name

    @property
    def ending_s(self) -> float:
        """The time that the process may take to end: a command, then what it leaves behind, are asked
        first."""
        return 2 * self.stop_s + 1.0 if self.is_guarded else self.stop_s

    @property
    def is_guarded(self) -> bool:
        """Says whether it runs behind a guard, which asks it to end when `aos-up` is killed."""
        return bool(self.command) or self.is_adapter

    def argv(self, settings: Path) -> list[str]:
        """The command line."""
        own = [sys.executable, "-m", self.module, str(settings)]
        words = words_of(self.command) if self.command else own
        left_behind_s = _LEFT_BEHIND_S if self.is_adapter else None
        limits = Limits(grace_s=self.stop_s, left_behind_s=left_behind_s)
        return guarded(words, limits) if self.is_guarded else words


def words_of(command: tuple[str, ...]) -> list[str]:
    """A command of the deploy file as it is carried out here: `python` is the Python that this runs in."""
    program, *arguments = command
    return [sys.executable if program == "python" else program, *arguments]


def programs_of_deployment(deployment: Deployment) -> tuple[Program, ...]:
    """The services in the order in which they must become ready, the router not among them."""
    file = deployment.file
    project = {"project": deployment.project}
    activation = {"activation_timeout_s": file.mission.activation_timeout_s}
    registry = {"watch": str(deployment.watch)} if deployment.watch else {}
    adapters = [_adapter(deployment, plan) for plan in deployment.adapters if plan.is_process]
    middleware = project | activation | _played(deployment)
    return (
        Program(name="registry", module="aos_registry", settings=registry, is_restarted=True),
        *_spans(deployment),
        Program(name="middleware", module="aos_middleware", settings=middleware, is_restarted=True),
        *(_own(deployment, name, part) for name, part in file.programs.items()),
        *adapters,
        Program(
            name="solver",
            module="aos_solver",
            settings=_solver_settings(deployment),
            stop_s=5.0,
            is_restarted=True,
        ),
    )


def _spans(deployment: Deployment) -> Iterator[Program]:
    """The process that sends spans, where the deploy file asks for them. A mission goes on without it."""
    if otlp := deployment.file.spans.otlp:
        settings = {"otlp": otlp}
        yield Program(name=SPANS, module="aos_deploy.spans", settings=settings, stop_s=1.0, on_exit="ignore")


def outsiders_of(deployment: Deployment) -> tuple[Outsider, ...]:
    """The adapters that somebody else starts, with the files that the deploy file names for them."""
    folder = deployment.path.parent
    return tuple(
        Outsider(plan.party, folder / plan.options["credential"] if plan.options.get("credential") else None)
        for plan in deployment.adapters
        if not plan.is_process
    )


def _own(deployment: Deployment, name: str, part: ProgramPart) -> Program:
    """A program of the deploy file's `programs:`."""
    return Program(
        name=name,
        start_s=part.start_s,
        stop_s=part.stop_s,
        is_restarted=part.on_exit == "restart",
        command=part.command,
        folder=part.folder if part.host else str(deployment.path.parent),
        host=part.host,
        ready=part.ready,
        on_exit=part.on_exit,
    )


def _played(deployment: Deployment) -> dict[str, Any]:
    """Returns the paths of the skills that are played by their documents, for the middleware."""
    plans = [plan for plan in deployment.adapters if plan.kind_name == MODEL]
    paths = [path for plan in plans for path in (*plan.bind, *(["*"] if plan.serves_others else []))]
    return {"played": paths, "elsewhere": [path for plan in plans for path in plan.elsewhere]}


def _adapter(deployment: Deployment, plan: AdapterPlan) -> Program:
    kind, folder = plan.kind, deployment.path.parent
    options = plan.options
    if plan.kind_name == MODEL:
        options = options | {
            "cache_dir": str(cache_dir()),
            "mission_values": msgspec.to_builtins(deployment.mission_values),
        }
    settings = {
        "adapter": kind.adapter,
        "project": deployment.project,
        "folder": str(folder),
        "options": options,
        "bind": {path: msgspec.structs.asdict(binding) for path, binding in plan.bind.items()},
        "serves_others": plan.serves_others,
        "elsewhere": plan.elsewhere,
        "seed": deployment.file.solver.seed,
    }
    return Program(
        name=plan.name,
        module="aos_runtime.adapters",
        settings=settings,
        start_s=kind.start_s,
        stop_s=kind.stop_s,
        is_restarted=kind.is_restarted,
        command=tuple(plan.options["command"]) if plan.is_command else (),
        folder=_folder(deployment, plan) if plan.is_command else None,
        host=options.get("host", "") if plan.is_command else "",
        paths=tuple(plan.bind),
        is_adapter=True,
    )


def _folder(deployment: Deployment, plan: AdapterPlan) -> str:
    """Returns the folder where a program of the user's own is started; on another host, a folder there."""
    return plan.options.get("folder", "") if "host" in plan.options else str(deployment.path.parent)


def _solver_settings(deployment: Deployment) -> dict[str, Any]:
    file = deployment.file
    budget = {name: value for name, value in msgspec.structs.asdict(file.solver).items() if value is not None}
    return {
        "project": deployment.project,
        "cache_dir": str(cache_dir()),
        **budget,
        "policy": str(deployment.policy or ""),
        **({"stay": True} if file.stay else {}),
        **{name: value for name, value in msgspec.structs.asdict(file.mission).items() if name != "set"},
        "constraints": msgspec.to_builtins(deployment.constraints),
        "mission_values": msgspec.to_builtins(deployment.mission_values),
        "skills": {name: msgspec.structs.asdict(part) for name, part in file.skills.items()},
    }


def settings_of(program: Program, base: ServiceSettings) -> dict[str, Any]:
    """Returns the contents of the service's settings file."""
    return {**msgspec.structs.asdict(base), **program.settings}
