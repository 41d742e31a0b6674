"""Missions against the documents' own model, each in an engine of its own: its seed alone decides it."""

from __future__ import annotations

import time

from aos_deploy.bundle_files import project_of
from aos_deploy.deploy_file import Deployment
from aos_deploy.program import cache_dir
from aos_deploy.trials.trial import Trial
from aos_protocol.documents import Project
from aos_solver.building.build import BuiltModel
from aos_solver.child.engine import Engine
from aos_solver.endings import Ending, MissionLimits
from aos_solver.hot_plug import build_project
from aos_solver.search import Search
from aos_solver.simulation import simulate_mission

__all__ = ["ModelPlayer"]

DEFAULT_SIMULATIONS = 100_000
"""As in the commands, where neither simulations nor a time is given."""


class ModelPlayer:
    """Plays missions of a deployment by the model of its documents; what it needs is built once."""

    def __init__(self, deployment: Deployment, project: Project, model: BuiltModel) -> None:
        self.deployment = deployment
        self.project = project
        self.model = model

    @classmethod
    async def prepared(cls, deployment: Deployment) -> ModelPlayer:
        """Reads the documents and compiles the model; DocumentError with all that is wrong with them."""
        project = project_of(deployment)
        model = await build_project(project, cache_dir(), lambda remark: None)
        return cls(deployment, project, model)

    async def close(self) -> None:
        """Nothing is left of a mission."""

    async def play(self, seed: int) -> Trial:
        """One mission. The same seed gives the same mission wherever the budget is one in simulations."""
        file, start = self.deployment.file, time.perf_counter()
        limits = MissionLimits(
            goal_probability=file.mission.goal_probability,
            step_limit=file.mission.step_limit,
            stop_below_value=file.mission.stop_below_value,
        )
        engine = await Engine.start(self.model, seed=seed)
        try:
            run = await simulate_mission(engine, self._search(seed), limits, with_states=True)
        finally:
            await engine.close()
        return Trial(
            seed=seed,
            ending=str(run.ending),
            goal=run.world_ending == Ending.GOAL,
            actions=run.actions,
            responses=run.observations,
            states=run.states[1:],
            value=run.discounted_return,
            seconds=time.perf_counter() - start,
        )

    def _search(self, seed: int) -> Search:
        solver = self.deployment.file.solver
        search = Search(
            simulations=solver.simulations or DEFAULT_SIMULATIONS,
            seed=seed,
            time_s=solver.time_s,
            horizon=solver.horizon,
            planner=solver.planner,
            threads=solver.threads,
        )
        if self.deployment.policy is None:
            return search
        # Numbers take a tenth of a second to import.
        from aos_solver.offline.policy import Policy, PolicySearch

        return PolicySearch.instead_of(search, Policy.load(self.deployment.policy))
