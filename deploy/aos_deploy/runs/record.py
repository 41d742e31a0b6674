"""The record of a run, by which it can be found, and its end as it remains: `run.json`, `summary.json`."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import msgspec

from aos_protocol import __version__
from aos_runtime.sandbox.support import sandbox_text

if TYPE_CHECKING:
    from aos_deploy.deployment.reading import Deployment


class RunRecord(msgspec.Struct, frozen=True, kw_only=True):
    """`run.json`. `pid` is that of aos-up. `is_played` says that skills are played by their documents, and
    `sandbox` what confines the documents' code. `version` is that of AOS. Nodes of ROS 2 meet at `ros2`,
    where a run serves them."""

    robot: str
    endpoint: str
    deploy_file: str
    seed: int
    started: str
    pid: int
    pids: dict[str, int] = {}
    is_played: bool = False
    sandbox: str = ""
    version: str = ""
    ros2: str = ""


def record_of(
    deployment: Deployment,
    endpoint: str,
    started: str,
    pids: dict[str, int],
    *,
    is_played: bool = False,
    ros2: str = "",
) -> RunRecord:
    """The record of a run of this process, whose services have these process ids."""
    return RunRecord(
        robot=deployment.file.robot,
        endpoint=endpoint,
        deploy_file=str(deployment.path),
        seed=deployment.file.solver.seed,
        started=started,
        pid=os.getpid(),
        pids=pids,
        is_played=is_played,
        sandbox=sandbox_text(),
        version=__version__,
        ros2=ros2,
    )


class ProcessEnd(msgspec.Struct, frozen=True):
    """A process that ended though nobody stopped it: when, by which status or signal, and what followed."""

    name: str
    after_s: float
    how: str
    then: str


class RunEnd(msgspec.Struct, frozen=True, kw_only=True):
    """The end of a run; `actions` and `responses` are those of the steps.

    The ending and its probabilities are those of the last belief: nobody tells a robot how its world ended.
    `cautious_goal_probability` is that of the goal if nothing ran that was not observed.
    """

    ending: str
    remark: str
    exit_code: int
    actions: tuple[str, ...] = ()
    responses: tuple[str, ...] = ()
    goal_probability: float = 0.0
    cautious_goal_probability: float = 0.0
    over_probability: float = 0.0
    failure_probability: float = 0.0


class Summary(RunEnd, frozen=True, kw_only=True):
    """`summary.json`: how a run ended. Times in seconds since aos-up had read the deploy file.

    `process_ends` are the processes that ended by themselves, in this order. `mission_parameters` are the
    values of all parts of mission parameters.
    """

    robot: str
    deploy_file: str
    seed: int
    started: str
    steps: int
    services_ready_s: float | None
    first_decision_s: float | None
    duration_s: float
    process_ends: tuple[ProcessEnd, ...] = ()
    mission_parameters: dict[str, str] = {}


class SystemSummary(Summary, frozen=True, kw_only=True):
    """`summary.json` of a system that stays: the steps of all `missions`, each of which has its own summary.

    The ending is `stopped`, or `cancelled` where a mission ran when the system was stopped.
    """

    missions: tuple[str, ...]
