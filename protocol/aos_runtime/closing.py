"""A base of classes that are open until their `async with` block ends."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Self  # not in Python 3.10


class Closing(ABC):
    """Is closed at the end of an `async with` block, however it ends."""

    @abstractmethod
    async def close(self) -> None:
        """Gives up what it has; closing twice does nothing."""

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()
