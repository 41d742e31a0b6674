"""The best that can be had of a model, with proven bounds, beside what its missions brought."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from aos_deploy.deploy_file import Deployment
from aos_deploy.program import cache_dir
from aos_deploy.trials.intervals import Interval, interval_of_mean
from aos_deploy.trials.model_player import ModelMissions, ModelPlayer
from aos_deploy.trials.trial import Trial
from aos_solver.child.engine import Engine
from aos_solver.offline.enumeration import enumerate_model
from aos_solver.offline.solving import Bounds, SolvingLimits, solve

__all__ = ["Regret", "bounds_of", "regret_of"]

CPU_S = 15.0


class Regret(msgspec.Struct, frozen=True, kw_only=True):
    """What is missing from the optimum, between `lower` and `upper`, to the missions' mean return.

    `scale` is the difference of the largest and the smallest return of these missions. `share` is what is
    missing as a share of it; below 0 the missions were lucky, or ended where the documents would not.
    """

    lower: float
    upper: float
    scale: float
    share: Interval


async def bounds_of(deployment: Deployment) -> Bounds:
    """Of the value of the initial belief, by SARSOP; IntractableError where the model cannot be listed."""
    player = await ModelPlayer.prepared(ModelMissions.of(deployment))
    engine = await Engine.start(player.model, seed=1, keeps_belief=False)
    try:
        model = (await enumerate_model(engine)).model
    finally:
        await engine.close()
    return (await solve(model, SolvingLimits(cpu_s=CPU_S), cache_dir=cache_dir())).bounds


def regret_of(bounds: Bounds, trials: Sequence[Trial]) -> Regret | None:
    """None where the missions' returns are all the same, or unknown."""
    returns = [trial.value for trial in trials if trial.value is not None and not trial.fault]
    mean = interval_of_mean(returns)
    if mean is None or max(returns) == min(returns):
        return None
    scale = max(returns) - min(returns)
    middle = (bounds.lower + bounds.upper) / 2
    share = Interval(*((middle - each) / scale for each in (mean.value, mean.high, mean.low)))
    return Regret(lower=bounds.lower, upper=bounds.upper, scale=scale, share=share)
