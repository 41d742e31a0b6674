"""Pictures of states, each drawn in a process of its own, and those that were drawn last."""

import asyncio
from collections import OrderedDict
from typing import Any

from aos_middleware.workers.picture import Drawn, draw
from aos_protocol.messages import DecisionRecord

_KEPT = 32
_AT_ONCE = 2


class Drawings:
    """The pictures that were drawn last, and how many are drawn at once: each has a process of its own."""

    def __init__(self) -> None:
        self._kept: OrderedDict[tuple[str, int, int], Drawn] = OrderedDict()
        self._drawing = asyncio.Semaphore(_AT_ONCE)

    async def of(self, record: DecisionRecord, source: str) -> Drawn:
        """The picture of a record's belief; DocumentError AOS148 where the code draws none."""
        key = (record.mission, record.sequence, record.revision)
        async with self._drawing:
            if key not in self._kept:
                self._kept[key] = await draw(source, record.belief, _step_of(record))
                while len(self._kept) > _KEPT:
                    self._kept.popitem(last=False)
            self._kept.move_to_end(key)
            return self._kept[key]


def _step_of(record: DecisionRecord) -> dict[str, Any]:
    outcome = record.outcome
    return {
        "number": record.step,
        "action": record.action,
        "skill": record.skill,
        "parameters": record.parameters,
        "status": outcome.status if outcome is not None else "",
        "response": outcome.response if outcome is not None else "",
    }
