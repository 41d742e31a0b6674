"""What the solver service is started with."""

from __future__ import annotations

from typing import Literal

from aos_runtime.lifecycle import ServiceSettings

__all__ = ["Settings"]


class Settings(ServiceSettings, frozen=True, kw_only=True):
    """The deploy file's `solver:` and `mission:` parts.

    The planning budget is `time_s` if given, else `simulations`. `horizon` None takes the environment
    document's. With a `policy` file decisions come from it, without a search. `project` names the documents
    to ask the registry for.
    """

    project: str
    cache_dir: str
    simulations: int = 100_000
    time_s: float | None = None
    horizon: int | None = None
    seed: int = 1
    policy: str = ""
    goal_probability: float = 0.9
    step_limit: int = 30
    stop_below_value: float | None = None
    activation_timeout_s: float = 120.0
    planner: Literal["pomcp", "despot", "sarsop", "auto"] = "auto"
    threads: int = 1
    ponder_while_acting: bool = True
    impossible_observation: Literal["hold", "widen", "reset"] = "widen"
