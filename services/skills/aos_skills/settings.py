"""What the skills service is started with."""

from __future__ import annotations

import msgspec

from aos_runtime.service_settings import ServiceSettings

__all__ = ["Settings"]


class Settings(ServiceSettings, frozen=True, kw_only=True):
    """`bind` gives each activation path its adapter; `world` is the simulated one's file, or empty."""

    bind: dict[str, str] = msgspec.field(default_factory=dict)
    world: str = ""
    seed: int = 1
