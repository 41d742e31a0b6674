"""What the skills service is started with."""

from __future__ import annotations

from aos_runtime.service_settings import ServiceSettings

__all__ = ["Settings"]


class Settings(ServiceSettings, frozen=True, kw_only=True):
    """`bind` gives the adapter of each activation path; `world` is the file of the simulated one, or empty."""

    bind: dict[str, str] = {}
    world: str = ""
    seed: int = 1
