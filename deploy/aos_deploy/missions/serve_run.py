"""A robot for others: adapters up, served to nodes of ROS, until it is stopped. No mission runs."""

import asyncio

import msgspec

from aos_deploy.deployment.reading import Deployment
from aos_deploy.events import Report, Told
from aos_deploy.exit_codes import ExitCode, exit_code_of_error
from aos_deploy.missions.serving import serving_program
from aos_deploy.printing import from_here, time_text
from aos_deploy.processes.endpoint import hold_endpoint
from aos_deploy.processes.program import outsiders_of, programs_of_deployment
from aos_deploy.processes.supervisor import Supervisor, supervised
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.living import noted
from aos_deploy.runs.record import record_of
from aos_deploy.runs.summary import RunEnd, Summary
from aos_protocol.errors import AosError, StorageError
from aos_runtime.clock import Clock
from aos_runtime.processes.lifecycle import root_cause
from aos_runtime.processes.settings import ServiceSettings
from aos_runtime.sandbox.support import sandbox_support, sandbox_text
from aos_skills.ros.connect import DEFAULT_ROUTER


class ServeEnd(msgspec.Struct, frozen=True):
    """The end of a run without a mission."""

    exit_code: int


class ServeRun:
    """Serves a deployment's adapters as `kind`. `report` is told what happens, as it happens."""

    def __init__(self, deployment: Deployment, kind: str, report: Report, clock: Clock) -> None:
        self._deployment = deployment
        self._server = serving_program(deployment, kind)
        self._is_meeting_place = kind == "ros2" and "router" not in self._server.settings["options"]
        self._ros2 = ""
        self._report = report
        self._clock = clock
        self._supervisor: Supervisor | None = None
        self.error: AosError | None = None

    async def run(self) -> ServeEnd:
        """Runs until it is cancelled, which is its normal end, or a process ends by itself."""
        listen = self._deployment.file.bus.listen
        with hold_endpoint(listen or (DEFAULT_ROUTER if self._is_meeting_place else "")) as held:
            run = RunDirectory.create(
                self._deployment.runs, self._deployment.file.robot, self._clock.now_ns()
            )
            endpoint = run.make_endpoint() if self._is_meeting_place or not held else held
            if self._is_meeting_place:
                self._meet_at(held)
            self._report(Told(f"run directory {from_here(run.path)}"))
            if not sandbox_support().is_whole:
                self._report(Told(sandbox_text()))
            begun_ns, begun_s = self._clock.now_ns(), self._clock.monotonic_s()
            end = RunEnd(ending="stopped", remark="no mission ran", exit_code=int(ExitCode.GOAL_REACHED))
            try:
                with noted(run):
                    await self._serve(run, endpoint)
            except asyncio.CancelledError:
                self._report(Told("stopped"))
            except AosError as error:
                self.error = error
                end = RunEnd(ending="fault", remark=str(error), exit_code=int(exit_code_of_error(error)))
            self._keep_end(run, end, begun_ns, self._clock.monotonic_s() - begun_s)
            run.close()
        return ServeEnd(end.exit_code)

    def _keep_end(self, run: RunDirectory, end: RunEnd, begun_ns: int, duration_s: float) -> None:
        summary = Summary(
            robot=self._deployment.file.robot,
            deploy_file=str(self._deployment.path),
            seed=self._deployment.file.solver.seed,
            started=time_text(begun_ns),
            **msgspec.structs.asdict(end),
            steps=0,
            services_ready_s=None,
            first_decision_s=None,
            duration_s=round(duration_s, 3),
            process_ends=tuple(self._supervisor.ends) if self._supervisor is not None else (),
        )
        try:
            run.write_summary(summary)
        except StorageError as error:
            self.error = self.error or error

    def _meet_at(self, endpoint: str) -> None:
        """Nodes of ROS 2 have no credentials: they meet at a router that has nothing of the bus."""
        self._ros2 = endpoint
        settings = self._server.settings
        options = settings["options"] | {"router": endpoint}
        self._server = msgspec.structs.replace(self._server, settings=settings | {"options": options})

    def kill(self) -> None:
        """Ends every process without waiting for it."""
        if self._supervisor is not None:
            self._supervisor.kill()

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
