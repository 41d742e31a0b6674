"""The spans that are still to be sent when a run's processes have ended, such as that of the mission."""

import sys
from contextlib import suppress

from aos_deploy.deployment.adapters import SPANS
from aos_deploy.runs.directory import RunDirectory
from aos_protocol.errors import DeployError
from aos_runtime.processes.children import Child

REST = "rest"
"""The word after the settings for a process that sends once what there is, and ends."""

_REST_S = 6.0


async def send_rest(run: RunDirectory, *, is_wanted: bool) -> None:
    """Sends what the run's journals have and no collector has taken, if that is soon done.

    A process of its own does it: whatever goes wrong with it changes nothing about how the run has ended.
    """
    settings = run.path / "settings" / f"{SPANS}.json"
    if not is_wanted or not settings.is_file():
        return
    with suppress(OSError, DeployError), run.open_log(SPANS) as log:
        argv = [sys.executable, "-m", "aos_deploy.spans", str(settings), REST]
        child = await Child.start(argv, stdout=log, stderr=log)
        if not await child.wait_for(_REST_S):
            child.kill()
            await child.wait()
