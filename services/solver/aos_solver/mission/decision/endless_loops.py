"""Loops of document code that no draw can end, as a mission tells them."""

from aos_solver.child.engine import Engine


class EndlessLoops:
    """Tells of each loop of each model once."""

    def __init__(self) -> None:
        self._told: set[tuple[str, int]] = set()

    async def newly_found(self, engine: Engine) -> list[str]:
        """Returns a text for each loop without an end that steps have come to since the last call."""
        texts: list[str] = []
        for loop, place in await engine.endless_loops():
            key = engine.model_digest, loop.loop
            if key not in self._told:
                self._told.add(key)
                texts.append(f"{place}: {loop.text}, which counts as a failure")
        return texts
