"""Commands on a running system: which one is meant, and a client of its bus."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from aos_deploy.options import Connect, Robot, Run, Runs
from aos_deploy.runs.living import living_run
from aos_protocol.access import OPERATOR
from aos_protocol.errors import DeployError
from aos_runtime.bus.credentials import credential_of_run

if TYPE_CHECKING:
    from aos_runtime.client import AosClient

T = TypeVar("T")


class System(NamedTuple):
    """The system at an endpoint, or the mission that runs, as the options of a command say."""

    connect: Connect = ""
    robot: Robot = ""
    run: Run = None
    runs: Runs = None

    @property
    def is_at_endpoint(self) -> bool:
        """True if an endpoint was named; AosError where the robot there was not."""
        if self.connect and not self.robot:
            raise DeployError("which robot?", code="AOS901", hint="Name it with --robot")
        return bool(self.connect)

    def do(self, work: Callable[[AosClient], Awaitable[T]], *, user: str = OPERATOR) -> T:
        """Returns what `work` makes of the system; AosError if there is none.

        On the bus it is the `user` of the run, and at an endpoint whoever the environment says.
        """
        connect, robot, credential = self.connect, self.robot, None
        if not self.is_at_endpoint:
            run = living_run(self.run, self.runs)
            record = run.read_record()
            connect, robot = record.endpoint, robot or record.robot
            credential = credential_of_run(run.path, user)

        import asyncio  # Only here, as the client: the commands that need no bus start quicker.

        from aos_runtime.client import AosClient

        async def inside() -> T:
            async with AosClient.connect(connect, robot, credential=credential) as client:
                return await work(client)

        return asyncio.run(inside())
