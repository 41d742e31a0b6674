"""The parts that pyproject.toml cannot say: a wheel also holds deploy files, bundles, worlds and benchmarks
by hand.

They keep their places, below `aos_deploy/share`, and `aos_deploy.places` finds them there as in a checkout.
"""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

SHARED = (
    "deploy/*.yaml",
    "deploy/bundles",
    "deploy/experiments",
    "deploy/interfaces",
    "deploy/worlds",
    "tests/bench",
)


class BuildWithShared(build_py):
    """Copies the shared files beside the modules; an editable installation finds them in the checkout."""

    def run(self) -> None:
        super().run()
        if self.editable_mode:
            return
        share = Path(self.build_lib) / "aos_deploy" / "share"
        shutil.rmtree(share, ignore_errors=True)
        for pattern in SHARED:
            for found in Path().glob(pattern):
                target = share / found
                target.parent.mkdir(parents=True, exist_ok=True)
                if found.is_dir():
                    shutil.copytree(found, target, ignore=shutil.ignore_patterns("__pycache__"))
                else:
                    shutil.copy(found, target)


setup(cmdclass={"build_py": BuildWithShared})
