"""Engines of traced models: they know which statement of the documents gives which part of a reward."""

import asyncio
import math
from pathlib import Path
from typing import NamedTuple

from msgspec.structs import replace

from aos_protocol.errors import StudyError
from aos_solver.building.build import BuiltModel, build
from aos_solver.child.answers.models import RewardTerm
from aos_solver.child.engine import Engine
from aos_solver.emission.trace import traced


class TracedEngine(NamedTuple):
    """An engine and the places of its statements."""

    engine: Engine
    built: BuiltModel

    def place(self, term: RewardTerm) -> str:
        """The file and line that give a part of a reward, or the precondition that was violated for it."""
        if term.skill:
            return f"{term.skill} without its precondition"
        spans = self.built.emitted.snippets
        if not 0 < term.place <= len(spans):
            return "elsewhere"
        span = spans[term.place - 1]
        return f"{span.file}:{span.line}"


class TracedEngines:
    """Keeps the engine of the model that was asked for last.

    With a `niceness` engine and compiler give way to others. An engine that takes longer than `patience_s` is
    got ready beside other questions.
    """

    def __init__(self, cache_dir: Path, niceness: int, patience_s: float) -> None:
        self._cache_dir = cache_dir
        self._niceness = niceness
        self._patience_s = patience_s
        self._starting: asyncio.Task[TracedEngine] | None = None
        self._digest = ""

    async def of(self, model: BuiltModel) -> TracedEngine:
        """The traced engine of a model, whatever it believes; StudyError AOS530 while it is not ready.

        ModelError where it cannot be compiled or started; then the next question tries again.
        """
        digest = f"{model.digest} {sorted(model.mission_values.items())}"
        if self._starting is None or self._digest != digest:
            await self.close()
            self._starting = asyncio.create_task(self._start(model))
            self._digest = digest
        starting = self._starting
        wait_s = None if self._patience_s == math.inf else self._patience_s
        if not (await asyncio.wait({starting}, timeout=wait_s))[0]:
            raise StudyError(
                "the model is still compiled with marks at its statements", hint="Ask again in some seconds"
            )
        if starting.exception() is not None:
            self._starting = None
        return starting.result()

    async def _start(self, model: BuiltModel) -> TracedEngine:
        emitted = traced(model.emitted).emitted
        built = await build(emitted, cache_dir=self._cache_dir, niceness=self._niceness)
        built = replace(built, mission_values=model.mission_values)
        return TracedEngine(await Engine.start(built, seed=1, niceness=self._niceness), built)

    async def close(self) -> None:
        """Ends the engine, or what gets it ready."""
        starting, self._starting = self._starting, None
        if starting is None:
            return
        starting.cancel()
        await asyncio.wait({starting})
        if not starting.cancelled() and starting.exception() is None:
            await starting.result().engine.close()
