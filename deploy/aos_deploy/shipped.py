"""The files that come with AOS beside its code: deploy files, bundles, worlds, benchmarks by hand."""

from pathlib import Path

_INSTALLED = Path(__file__).resolve().parent / "share"
_CHECKOUT = Path(__file__).resolve().parents[2]
_ROOT = _INSTALLED if _INSTALLED.is_dir() else _CHECKOUT


def shipped(path: str) -> Path:
    """A file or folder that comes along, by its path in the checkout."""
    return _ROOT / path


def deploy_files() -> dict[str, Path]:
    """The deploy files that come along, by name."""
    return {path.stem: path for path in sorted(shipped("deploy").glob("*.yaml"))}
