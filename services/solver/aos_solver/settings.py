"""The settings that the solver service is started with."""

from typing import Literal

import msgspec

from aos_protocol.documents import Constraint, MissionValue
from aos_runtime.processes.settings import ServiceSettings
from aos_solver.child.questions.missions import DEFAULT_PLANNER, Planner
from aos_solver.mission.rules.failures import SkillRule


class Settings(ServiceSettings, frozen=True, kw_only=True):
    """The deploy file's `solver:`, `mission:` and `skills:` parts.

    The planning budget is `time_s` if given, else `simulations`. Where `horizon` is None the environment
    document's counts. With a `policy` file decisions come from that, without a search. `project` names the
    documents to ask the registry for. A solver with `stay` runs one mission after the other, `seed` is that
    of the first.
    """

    project: str
    cache_dir: str
    simulations: int = 100_000
    time_s: float | None = None
    horizon: int | None = None
    plans_to_step_limit: bool = False
    seed: int = 1
    policy: str = ""
    stay: bool = False
    goal_probability: float = 0.9
    step_limit: int = 30
    stop_below_value: float | None = None
    constraints: tuple[Constraint, ...] = ()
    mission_values: tuple[MissionValue, ...] = ()
    activation_timeout_s: float = 120.0
    failure_limit: int = 30
    set_aside_after: int = 3
    set_aside_s: float = 300.0
    hold_s: float = 600.0
    skills: dict[str, SkillRule] = msgspec.field(default_factory=dict)
    planner: Planner = DEFAULT_PLANNER
    threads: int = 1
    ponder_while_acting: bool = True
    impossible_observation: Literal["hold", "widen", "reset"] = "widen"
