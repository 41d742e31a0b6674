"""The run of a deployment's processes, with or without a mission: its directory, its clock, its end."""

from typing import Any

from aos_deploy.deployment.reading import Deployment
from aos_deploy.events import Report, Told
from aos_deploy.printing import from_here
from aos_deploy.processes.supervisor import Supervisor
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import Summary
from aos_protocol.errors import AosError, StorageError
from aos_runtime.clock import Clock
from aos_runtime.sandbox.support import sandbox_support, sandbox_text


class RunOfProcesses:
    """One run of a deployment. `report` is told what happens, as it happens."""

    def __init__(self, deployment: Deployment, report: Report, clock: Clock) -> None:
        self._deployment = deployment
        self._report = report
        self._clock = clock
        self._begun_s = clock.monotonic_s()
        self._supervisor: Supervisor | None = None
        self.error: AosError | None = None

    def kill(self) -> None:
        """Ends every process without waiting for it."""
        if self._supervisor is not None:
            self._supervisor.kill()

    def _run_directory(self) -> RunDirectory:
        return RunDirectory.create(self._deployment.runs, self._deployment.file.robot, self._clock.now_ns())

    def _tell_opened(self, run: RunDirectory) -> None:
        self._report(Told(f"run directory {from_here(run.path)}"))
        if not sandbox_support().is_whole:
            self._report(Told(sandbox_text()))

    def _summary_of(self, **rest: Any) -> Summary:
        return Summary(
            robot=self._deployment.file.robot,
            deploy_file=str(self._deployment.path),
            seed=self._deployment.file.solver.seed,
            duration_s=self._elapsed_s(),
            process_ends=tuple(self._supervisor.ends) if self._supervisor is not None else (),
            **rest,
        )

    def _write_summary(self, run: RunDirectory, summary: Summary) -> None:
        try:
            run.write_summary(summary)
        except StorageError as error:
            self.error = self.error or error

    def _elapsed_s(self) -> float:
        return round(self._clock.monotonic_s() - self._begun_s, 3)
