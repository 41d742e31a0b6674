"""Engines of traced models: they know which statement of the documents gives which part of a reward."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import msgspec

from aos_solver.building.build import BuiltModel, build
from aos_solver.child.answers import RewardTerm
from aos_solver.child.engine import Engine
from aos_solver.emission.trace import traced

__all__ = ["TracedEngine", "TracedEngines"]


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
    """Keeps the engine of the model that was asked for last. With a `niceness` it gives way to others."""

    def __init__(self, cache_dir: Path, niceness: int) -> None:
        self._cache_dir = cache_dir
        self._niceness = niceness
        self._kept: TracedEngine | None = None
        self._digest = ""

    async def of(self, model: BuiltModel) -> TracedEngine:
        """The traced engine of a model, compiled if it is not in the cache; its belief is the initial one."""
        digest = f"{model.digest} {sorted(model.mission_values.items())}"
        if self._kept is None or self._digest != digest:
            await self.close()
            emitted = traced(model.emitted).emitted
            built = await build(emitted, cache_dir=self._cache_dir, niceness=self._niceness)
            built = msgspec.structs.replace(built, mission_values=model.mission_values)
            self._kept = TracedEngine(await Engine.start(built, seed=1, niceness=self._niceness), built)
            self._digest = digest
        return self._kept

    async def close(self) -> None:
        """Ends the engine."""
        kept, self._kept = self._kept, None
        if kept is not None:
            await kept.engine.close()
