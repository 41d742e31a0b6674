"""The parts that pyproject.toml cannot say: which modules an adapter needs, and how `aos-adapter` stays out
of the way.

It has packages of the same names as `aos-autonomy`. Had they the same files, too, the one that is installed
last would win, and whichever is removed would take the other's files with it. So those of `aos-adapter` stand
below `aos_adapter/`, and `aos-adapter.pth` makes them importable where nothing else provides them.
"""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

NOT_FOR_ROBOTS = ("children", "distribution", "foreign_bus", "guard", "sandbox_trial")
"""The modules of `aos_runtime` that only compilers, generators and aos-up need."""

SEARCH = (
    "import importlib.util, os, sys; "
    "importlib.util.find_spec('aos_protocol') "
    "or sys.path.append(os.path.join(sys._getframe(1).f_locals['sitedir'], 'aos_adapter'))\n"
)
"""Python carries out the lines of .pth files that begin with `import`, when it starts."""


class BuildForRobots(build_py):
    """The modules that adapters need, and the file that leads to them."""

    def find_package_modules(self, package: str, package_dir: str) -> list[tuple[str, str, str]]:
        found = super().find_package_modules(package, package_dir)
        return [module for module in found if module[1] not in NOT_FOR_ROBOTS]

    def run(self) -> None:
        super().run()
        Path(self.build_lib, "aos-adapter.pth").write_text(SEARCH, encoding="ascii")


setup(cmdclass={"build_py": BuildForRobots})
