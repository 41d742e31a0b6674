"""Missions of a whole system, as `aos-up` runs them, each with a run directory of its own."""

import asyncio
import shutil
from pathlib import Path

from msgspec.structs import replace

from aos_deploy.deployment.reading import Deployment
from aos_deploy.missions.mission_run import MissionRun
from aos_deploy.processes.needed_here import check_needed_here
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.summary import Summary
from aos_lab.trials.trial import Trial, truth_lines
from aos_protocol.errors import AosError
from aos_runtime.clock import SystemClock

MISSION_S = 1800.0
"""A mission that takes longer is ended, and counts as broken."""


class SystemPlayer:
    """Plays missions of a deployment by its adapters; their run directories go below `runs`."""

    def __init__(self, deployment: Deployment, runs: Path) -> None:
        check_needed_here(deployment)
        self.deployment = deployment
        self._runs = runs

    async def close(self) -> None:
        """Nothing is left of a mission."""

    async def play(self, seed: int) -> Trial:
        """One mission; one that broke is a trial with its fault."""
        runs = self._runs / f"seed-{seed}"
        shutil.rmtree(runs, ignore_errors=True)
        file = self.deployment.file
        file = replace(file, solver=replace(file.solver, seed=seed))
        deployment = replace(self.deployment, file=file, runs=runs)
        mission = MissionRun(deployment, lambda event: None, SystemClock())
        try:
            summary = await asyncio.wait_for(mission.run(), MISSION_S)
            run = RunDirectory.latest(runs)
        except (AosError, TimeoutError) as error:
            fault = str(mission.error or error) or f"it did not end within {MISSION_S:g} s"
            return Trial(seed=seed, ending="fault", goal=False, fault=fault)
        return _trial(seed, summary, run.path)


def _trial(seed: int, summary: Summary, run: Path) -> Trial:
    return Trial(
        seed=seed,
        ending=summary.ending,
        goal=summary.ending == "goal",
        actions=summary.actions,
        responses=summary.responses,
        states=tuple(truth_lines(run)),
        seconds=summary.duration_s,
        fault=summary.remark if summary.ending in ("fault", "not_started", "cancelled") else "",
        mission_parameters=summary.mission_parameters,
    )
