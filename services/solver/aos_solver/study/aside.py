"""A belief that is put aside while others are supposed."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from aos_protocol.errors import SkillError
from aos_solver.child.engine import Engine


@asynccontextmanager
async def put_aside(engine: Engine) -> AsyncIterator[None]:
    """Gives an engine its belief back at the end, also where a question was refused.

    After any other error, or where nobody waits for the end, the engine is of no use any more.
    """
    await engine.put_aside()
    try:
        yield
    except SkillError:
        await engine.take_back()
        raise
    await engine.take_back()
