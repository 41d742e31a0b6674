"""The record of a run, by which it can be found: `run.json`."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import msgspec

from aos_protocol import __version__
from aos_runtime.sandbox.support import sandbox_text

if TYPE_CHECKING:
    # Commands that look at runs start quicker without it.
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
