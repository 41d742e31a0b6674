"""The belief with which a mission begins: the initial or the last one, later on, given what is known."""

from collections.abc import Awaitable, Callable

from aos_protocol.errors import PlanningError
from aos_protocol.messages import StartMission
from aos_solver.child.answers.beliefs import ExportedBeliefs
from aos_solver.child.engine import Engine


async def begin_with(
    engine: Engine,
    start: StartMission,
    kept: ExportedBeliefs | None,
    conditioned: Callable[[], Awaitable[Engine]],
    refuted_below: float,
) -> None:
    """Brings an engine that is on its initial belief to the belief with which a mission begins.

    `kept` is the last belief of the mission before, None where the mission begins with the initial one.
    `conditioned` starts an engine of the same seed whose constraints are what is given. PlanningError AOS516
    where that has probability 0; what is believed is then of no use.
    """
    if not start.given:
        await _begin(engine, start, kept)
        return
    async with await conditioned() as aside:
        await _begin(aside, start, kept)
        answer = await aside.condition(refuted_below)
        if answer.probability <= 0:
            given = " and ".join(f"`{text}`" for text in start.given)
            raise PlanningError(
                f"{given} has probability 0 in the {'last' if kept else 'initial'} belief",
                code="AOS516",
                hint="See `aos decisions` for what is believed, or begin with `--belief initial`"
                if kept
                else "See the initial belief in the environment document",
            )
        await engine.import_beliefs(await aside.export_beliefs())


async def _begin(engine: Engine, start: StartMission, kept: ExportedBeliefs | None) -> None:
    if kept is not None:
        await engine.import_beliefs(kept)
    if kept is not None or start.idle:
        await engine.begin_mission(start.idle)
