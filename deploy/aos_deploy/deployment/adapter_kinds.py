"""The kinds of adapters that a deploy file can name, one line each; installed packages can add more.

A package adds a kind by an entry point of the group `aos.adapters`, whose object is an adapter's class.
"""

from functools import cache
from importlib.util import find_spec

import msgspec

from aos_protocol.errors import DeployError
from aos_runtime.distribution import Extra, pip_install


class Kind(msgspec.Struct, frozen=True, kw_only=True):
    """The way to start an adapter of this kind.

    `adapter` is `module:Class`, empty where no adapter class of Python runs. The value of the kind's own word
    in the deploy file becomes the option `value`. `options` are those it knows, None for any. Its process may
    take `start_s` to get ready, its paths `ready_s` from then on, and `stop_s` to end. When it ends by itself
    it is started again if `is_restarted`. It imports the module `needs`, which comes with the `extra` of our
    package.
    """

    adapter: str = ""
    value: str = ""
    options: tuple[str, ...] | None = ()
    start_s: float = 20.0
    ready_s: float = 30.0
    stop_s: float = 5.0
    is_restarted: bool = True
    needs: str = ""
    extra: Extra = ""


COMMAND = "command"
EXTERNAL = "external"
MODEL = "model"
PYTHON = "python"

OURS = {
    "pybullet": Kind(
        adapter="aos_skills.pybullet.adapter:PybulletAdapter",
        value="world",
        start_s=60.0,
        ready_s=1.0,  # It serves its paths before it says that it is ready.
        stop_s=20.0,  # It makes the mission's picture while it stops.
        is_restarted=False,  # Its world would begin anew.
        needs="pybullet",
        extra="sim",
    ),
    MODEL: Kind(
        adapter="aos_deploy.played.adapter:ModelAdapter",
        value="note",
        ready_s=600.0,  # It compiles the model.
    ),
    PYTHON: Kind(adapter="aos_skills.python_functions:PythonAdapter", value="file", ready_s=1.0),
    "ros2": Kind(
        adapter="aos_skills.ros.adapter:Ros2Adapter",
        value="router",
        options=("domain", "distribution", "interfaces", "topics"),
        needs="rosbags",
        extra="ros",
    ),
    "dds": Kind(
        adapter="aos_skills.ros.adapter:DdsAdapter",
        value="interface",
        options=("peers", "domain", "distribution", "interfaces", "topics"),
        needs="cyclonedds",
        extra="dds",
    ),
    "ros1": Kind(
        adapter="aos_skills.ros.adapter:Ros1Adapter",
        value="master",
        options=("python", "interfaces", "topics"),
    ),
    "class": Kind(value="class", options=None),
    COMMAND: Kind(value="command", options=("host", "folder")),
    EXTERNAL: Kind(value="note", options=("credential",)),
}


def kind_of(name: str) -> Kind | None:
    """The kind of that name. Installed packages are looked through for what is not ours."""
    return OURS.get(name) or adapter_kinds().get(name)


@cache
def adapter_kinds() -> dict[str, Kind]:
    """All kinds by name, ours and installed ones; ours count where names collide."""
    from importlib.metadata import entry_points  # It reads the names of all packages.

    installed = {
        point.name: Kind(adapter=point.value, value="value", options=None)
        for point in entry_points(group="aos.adapters")
    }
    return installed | OURS


def check_installed(adapter: str, kind: Kind) -> None:
    """Raises DeployError AOS805 if an adapter of this kind needs a package that is not installed."""
    if kind.needs and find_spec(kind.needs) is None:
        message = f"the adapter {adapter} needs the package {kind.needs}, which is not installed"
        raise DeployError(message, code="AOS805", hint=f"Run {pip_install(kind.extra)}")
