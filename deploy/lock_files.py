"""Writes lock files: `python deploy/lock_files.py PYLOCK [--without FILE]` prints requirements with hashes.

PYLOCK is what `uv pip compile --format pylock.toml` writes. The requirements have the hashes of wheels that
AOS can run with: those for Linux with glibc on x86-64 and arm64, and CPython from 3.11 on. Sources have
theirs where no wheel fits every machine. `--without` leaves out what another lock file pins. With all hashes
the files would be four times as large.
"""

import argparse
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

_PLATFORM = re.compile(r"any|manylinux.*_(x86_64|aarch64)")
_PURE = re.compile(r"[.-]py3-none-any\.whl$")
_ABI = re.compile(r"none|abi3|cp31[1-9]")


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pylock", type=Path)
    parser.add_argument("--without", type=Path, help="a lock file that is installed as well")
    options = parser.parse_args()
    elsewhere = set(pins(options.without.read_text())) if options.without else set()
    packages = tomllib.loads(options.pylock.read_text())["packages"]
    texts = (requirement(package) for package in packages)
    sys.stdout.write("".join(text for text in texts if not elsewhere.intersection(pins(text))))
    return 0


def pins(requirements: str) -> list[str]:
    """The packages with their versions and conditions, as the lines of a lock file have them."""
    return [line.partition(" --hash=")[0] for line in requirements.splitlines()]


def requirement(package: dict[str, Any]) -> str:
    """The line of a lock file for a package of a pylock file."""
    condition = f" ; {package['marker']}" if "marker" in package else ""
    hashes = (f" --hash=sha256:{digest}" for digest in sorted(digests(package)))
    return f"{package['name']}=={package['version']}{condition}{''.join(hashes)}\n"


def digests(package: dict[str, Any]) -> Iterator[str]:
    """The SHA-256 of each wheel that we can run with, and of the source where no wheel fits every machine."""
    files = [wheel for wheel in package.get("wheels", ()) if can_run(wheel["url"])]
    if "sdist" in package and not any(_PURE.search(file["url"]) for file in files):
        files.append(package["sdist"])
    for file in files:
        yield file["hashes"]["sha256"]


def can_run(wheel: str) -> bool:
    """Tells by its name whether a wheel is for a machine and a Python that AOS runs on."""
    _, abi, platform = unquote(wheel).removesuffix(".whl").rsplit("-", 2)
    return bool(_PLATFORM.match(platform)) and any(_ABI.fullmatch(each) for each in abi.split("."))


if __name__ == "__main__":
    sys.exit(main())
