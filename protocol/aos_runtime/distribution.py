"""AOS as a package: the name that pip knows it by, which is not the name of its commands, and its extras."""

from typing import Literal

DISTRIBUTION = "aos-autonomy"

Extra = Literal["", "sim", "compiler", "gym", "bench", "ros", "dds", "ray", "report", "otel"]


def pip_install(extra: Extra = "") -> str:
    """The command that installs AOS with an extra, as a person types it."""
    return f"pip install '{DISTRIBUTION}[{extra}]'" if extra else f"pip install {DISTRIBUTION}"
