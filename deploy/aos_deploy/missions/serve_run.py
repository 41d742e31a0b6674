"""A robot for others: adapters up, served to nodes of ROS, until it is stopped. No mission runs."""

import asyncio
from typing import Any

import msgspec
from msgspec.structs import replace

from aos_deploy.deployment.reading import Deployment
from aos_deploy.events import Report, Told
from aos_deploy.exit_codes import ExitCode, exit_code_of_error
from aos_deploy.missions.run_of_processes import RunOfProcesses
from aos_deploy.printing import time_text
from aos_deploy.processes.endpoint import hold_endpoint
from aos_deploy.processes.program import Program, outsiders_of, programs_of_deployment
from aos_deploy.processes.supervisor import supervised
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.living import noted
from aos_deploy.runs.record import RunEnd, record_of
from aos_language.load import load_bundle
from aos_protocol.errors import AosError, DeployError
from aos_runtime.clock import Clock
from aos_runtime.processes.lifecycle import root_cause
from aos_runtime.processes.settings import ServiceSettings
from aos_skills.ros.connect import DEFAULT_ROUTER, KINDS
from aos_skills.ros.definitions import interface_name
from aos_skills.ros.documented import documented


class ServeRun(RunOfProcesses):
    """Serves a deployment's adapters as `kind`. `report` is told what happens, as it happens."""

    def __init__(self, deployment: Deployment, kind: str, report: Report, clock: Clock) -> None:
        super().__init__(deployment, report, clock)
        self._server = serving_program(deployment, kind)
        self._is_meeting_place = kind == "ros2" and "router" not in self._server.settings["options"]
        self._ros2 = ""

    async def run(self) -> RunEnd:
        """Runs until it is cancelled, which is its normal end, or a process ends by itself."""
        listen = self._deployment.file.bus.listen
        with hold_endpoint(listen or (DEFAULT_ROUTER if self._is_meeting_place else "")) as held:
            run = self._run_directory()
            endpoint = run.make_endpoint() if self._is_meeting_place or not held else held
            if self._is_meeting_place:
                self._meet_at(held)
            self._tell_opened(run)
            started = time_text(self._clock.now_ns())
            end = RunEnd(ending="stopped", remark="no mission ran", exit_code=int(ExitCode.GOAL_REACHED))
            try:
                with noted(run):
                    await self._serve(run, endpoint)
            except asyncio.CancelledError:
                self._report(Told("stopped"))
            except AosError as error:
                self.error = error
                end = RunEnd(ending="fault", remark=str(error), exit_code=int(exit_code_of_error(error)))
            nothing = {"steps": 0, "services_ready_s": None, "first_decision_s": None}
            summary = self._summary_of(started=started, **msgspec.structs.asdict(end), **nothing)
            self._write_summary(run, summary)
            run.close()
        return end

    def _meet_at(self, endpoint: str) -> None:
        """Nodes of ROS 2 have no credentials: they meet at a router that has nothing of the bus."""
        self._ros2 = endpoint
        settings = self._server.settings
        options = settings["options"] | {"router": endpoint}
        self._server = replace(self._server, settings=settings | {"options": options})

    async def _serve(self, run: RunDirectory, endpoint: str) -> None:
        deployment = self._deployment
        robot = deployment.file.robot
        base = ServiceSettings(robot=robot, service="", endpoint=endpoint, run_dir=str(run.path))
        programs = [one for one in programs_of_deployment(deployment) if one.is_adapter or one.is_own]
        try:
            async with supervised(
                (*programs, self._server),
                base,
                run,
                self._report,
                self._clock,
                outsiders=outsiders_of(deployment),
                ros2=self._ros2,
            ) as all_of:
                self._supervisor = all_of
                await all_of.start()
                started = time_text(self._clock.now_ns())
                run.write_record(record_of(deployment, endpoint, started, all_of.pids, ros2=self._ros2))
                await all_of.until_ready()
                types = self._server.settings["types"]
                for name, type_name in types.items():
                    self._report(Told(f"{name} is {type_name}"))
                self._report(Told(f"{robot} serves; Ctrl-C stops it"))
                await asyncio.Event().wait()
        except BaseExceptionGroup as group:
            raise root_cause(group) from group


_COMMON = ("interfaces", "types")
_OPTIONS = {
    "ros2": ("router", "domain", "distribution"),
    "dds": ("interface", "peers", "domain", "distribution"),
    "ros1": ("master", "python"),
}


def serving_program(deployment: Deployment, kind: str) -> Program:
    """The program that serves the adapters' paths and topics to nodes of a kind.

    Types are those that `serve:` gives, and for others those that the documents name. DeployError AOS801 if
    the kind or its options are wrong, or nothing has a type.
    """
    if kind not in KINDS:
        raise DeployError(f"nothing can be served as {kind!r}", hint=f"Known are {', '.join(KINDS)}")
    part = deployment.file.serve
    options = part.get(kind) or {}
    _check_keys("serve", part, (*_COMMON, *KINDS), deployment)
    _check_keys(f"serve.{kind}", options, _OPTIONS[kind], deployment)
    types = _types(deployment, part.get("types") or {})
    if not types:
        hint = "Name them, as in serve: {types: {/pick: std_srvs/srv/Trigger}}"
        raise DeployError(f"nothing in {deployment.path.name} has a ROS type to be served with", hint=hint)
    settings = {
        "kind": kind,
        "folder": str(deployment.path.parent),
        "options": {"interfaces": part.get("interfaces", [])} | options,
        "types": types,
    }
    return Program(name=f"serve-{kind}", module="aos_skills.ros.server", settings=settings)


def _check_keys(where: str, given: Any, known: tuple[str, ...], deployment: Deployment) -> None:
    if not isinstance(given, dict):
        raise DeployError(f"{where} in {deployment.path.name} is not a mapping")
    for name in given:
        if name not in known:
            hint = f"Its keys are {', '.join(known)}"
            raise DeployError(f"{where} in {deployment.path.name} has an unknown key {name}", hint=hint)


def _types(deployment: Deployment, given: dict[str, Any]) -> dict[str, str]:
    types: dict[str, str] = {}
    for bundle in deployment.bundles:
        project = load_bundle(bundle).project
        if project is not None:
            known = documented(project)
            types |= {name: text for name, text in (known.paths | known.topics).items() if text}
    for name, text in given.items():
        kind = next((word for word in ("msg", "action") if f"/{word}/" in str(text)), "srv")
        types["/" + name.strip("/")] = str(interface_name(str(text), kind))
    return types
