"""Packages: AOS as pip knows it, by another name than its commands have, its extras, and which are there."""

from typing import Literal

DISTRIBUTION = "aos-autonomy"

Extra = Literal["", "sim", "compiler", "gym", "bench", "ros", "dds", "ray", "report", "otel"]


def pip_install(extra: Extra = "") -> str:
    """The command that installs AOS with an extra, as a person types it."""
    return f"pip install '{DISTRIBUTION}[{extra}]'" if extra else f"pip install {DISTRIBUTION}"


def version_of(package: str) -> str:
    """The version of a package; empty where it is not installed."""
    from importlib.metadata import PackageNotFoundError, version  # Commands that ask nothing start sooner.

    try:
        return version(package)
    except PackageNotFoundError:
        return ""
