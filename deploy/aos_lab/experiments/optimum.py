"""The best that can be had of a mission, with proven bounds, beside what its missions brought."""

from collections.abc import Sequence

import msgspec

from aos_deploy.deployment.reading import Deployment
from aos_deploy.places import cache_dir
from aos_lab.trials.intervals import Interval, interval_of_mean
from aos_lab.trials.players import ModelMissions, ModelPlayer
from aos_lab.trials.trial import Trial
from aos_solver.child.engine import Engine
from aos_solver.mission.rules.endings import Ending
from aos_solver.offline.enumeration import enumerate_model
from aos_solver.offline.explicit_model import with_stopping
from aos_solver.offline.solving import SolvingLimits, solve

CPU_S = 15.0


class Optimum(msgspec.Struct, frozen=True, kw_only=True):
    """The value of the initial belief lies between `lower` and `upper`, discounted.

    Where the deploy file has a `stop_below_value`, the robot may end its mission at any time, and that is
    what ending it is worth (`stop_value`).
    """

    lower: float
    upper: float
    discount: float
    stop_value: float | None

    def value_of(self, trial: Trial) -> float | None:
        """A mission's return, together with what stopping is worth where it stopped."""
        if trial.value is None or self.stop_value is None or trial.ending != Ending.NOTHING_WORTHWHILE:
            return trial.value
        return trial.value + self.discount ** len(trial.actions) * self.stop_value


class Regret(msgspec.Struct, frozen=True, kw_only=True):
    """The difference from the optimum to the missions' mean, which is `value`.

    `scale` is the difference of the largest and the smallest value of these missions. `share` is what is
    missing as a share of it; below 0 the missions were lucky, or ended where the documents would not.
    """

    optimum: Optimum
    value: Interval
    scale: float
    share: Interval


async def optimum_of(deployment: Deployment) -> Optimum:
    """Solves a deployment's mission by SARSOP; IntractableError where the model cannot be listed."""
    player = await ModelPlayer.prepared(ModelMissions.of(deployment))
    async with await Engine.start(player.model, seed=1, keeps_belief=False) as engine:
        model = (await enumerate_model(engine)).model
    stop_value = deployment.file.mission.stop_below_value
    if stop_value is not None:
        model = with_stopping(model, stop_value)
    bounds = (await solve(model, SolvingLimits(cpu_s=CPU_S), cache_dir=cache_dir())).bounds
    return Optimum(lower=bounds.lower, upper=bounds.upper, discount=model.discount, stop_value=stop_value)


def regret_of(optimum: Optimum, trials: Sequence[Trial]) -> Regret | None:
    """Returns the regret; None where the missions' values are all the same, or unknown."""
    values = [value for trial in trials if not trial.fault and (value := optimum.value_of(trial)) is not None]
    mean = interval_of_mean(values)
    if mean is None or max(values) == min(values):
        return None
    scale = max(values) - min(values)
    middle = (optimum.lower + optimum.upper) / 2
    share = Interval(*((middle - value) / scale for value in (mean.value, mean.high, mean.low)))
    return Regret(optimum=optimum, value=mean, scale=scale, share=share)
