"""The settings that an adapter's process is started with."""

from pathlib import Path
from typing import Any

import msgspec

from aos_protocol.access import ADAPTER, Party
from aos_runtime.processes.settings import ServiceSettings


class Binding(msgspec.Struct, frozen=True, kw_only=True):
    """The binding of a path to the adapter's own terms.

    `target` is what the adapter calls it, None for the path itself. With `fields` the call has these fields,
    with `result` the answer has these; each value is an expression over the fields that come in.
    """

    target: Any = None
    fields: dict[str, str] | None = None
    result: dict[str, str] | None = None


class AdapterSettings(ServiceSettings, frozen=True, kw_only=True):
    """`adapter` is `module:Class` or `FILE.py:Class`. `options` are its own, of the deploy file in `folder`.

    With `serves_others` it serves what it can beside `bind`, but none of `elsewhere`, which others serve. A
    call that is cancelled has to end within `cancel_s`.
    """

    adapter: str
    project: str = ""
    folder: str = ""
    options: dict[str, Any] = msgspec.field(default_factory=dict)
    bind: dict[str, Binding] = msgspec.field(default_factory=dict)
    serves_others: bool = False
    elsewhere: tuple[str, ...] = ()
    seed: int = 1
    cancel_s: float = 2.0

    @property
    def class_place(self) -> tuple[str, str]:
        """The folder that the class may stand in, and its name as `module:Class`."""
        module, _, name = self.adapter.rpartition(":")
        if not module.endswith(".py"):
            return self.folder, self.adapter
        path = Path(self.folder) / module
        return str(path.parent), f"{path.stem}:{name}"

    @property
    def party(self) -> Party:
        """The adapter as the bus knows it, with the paths that it may serve."""
        return Party(
            name=self.service,
            role=ADAPTER,
            paths=tuple(self.bind),
            serves_others=self.serves_others,
            elsewhere=self.elsewhere,
        )
