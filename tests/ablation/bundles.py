import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import fmean
from typing import Any

from tests.wide.kept import KEPT

from .losses import error_of_mean
from .mechanisms import BUNDLES, BundleRoute

_HERE = Path(__file__).parents[2] / "deploy" / "bundles" / "bench"


def bundle_rows(arguments: argparse.Namespace, tell: Callable[[str], None]) -> Iterator[dict[str, Any]]:
    with tempfile.TemporaryDirectory() as scratch:
        for route in BUNDLES:
            names = [name for name in route.mechanisms if name in (arguments.mechanism or route.mechanisms)]
            bundle = _found(route.bundle, arguments.folder, Path(scratch))
            if bundle is None or not names or route.bundle not in (arguments.bundle or [route.bundle]):
                continue
            tell(f"{route.name}, with all")
            with_it = _returns(route, bundle, (), arguments)
            for name in names:
                tell(f"{route.name}, without {name}")
                yield _bundle_row(route, name, with_it, _returns(route, bundle, (name,), arguments))


def _bundle_row(route: BundleRoute, name: str, with_it: list[float], without: list[float]) -> dict[str, Any]:
    lost = [one - other for one, other in zip(with_it, without, strict=True)]
    return {
        "bundle": route.name,
        "without": name,
        "missions": len(lost),
        "return with": f"{fmean(with_it):.1f} ± {error_of_mean(with_it):.1f}",
        "return without": f"{fmean(without):.1f} ± {error_of_mean(without):.1f}",
        "loss": f"{fmean(lost):.1f} ± {error_of_mean(lost):.1f}",
    }


def _found(name: str, folder: Path | None, scratch: Path) -> Path | None:
    """The bundle's folder; a problem of `tests.wide` is written into the scratch folder."""
    for place in (*([folder] if folder else []), _HERE):
        if (place / name).is_dir():
            return place / name
    return KEPT[name].write(scratch / name, KEPT[name].size) if name in KEPT else None


def _returns(
    route: BundleRoute, bundle: Path, more: tuple[str, ...], arguments: argparse.Namespace
) -> list[float]:
    command = [str(Path(sys.executable).with_name("aos")), "simulate", str(bundle), "--json"]
    command += [
        "--goal-probability",
        "1",
        "--step-limit",
        str(route.steps),
        "--simulations",
        str(route.simulations),
    ]
    command += ["--runs", str(arguments.runs), "--seed", str(arguments.seed)]
    environment = {**os.environ, "AOS_WITHOUT": "+".join((*route.without, *more))}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode != 0:
        raise SystemExit(done.stderr or done.stdout)
    return [run["discounted_return"] for run in json.loads(done.stdout)["runs"]]
