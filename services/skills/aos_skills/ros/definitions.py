"""Interface files of ROS: `.msg`, `.srv` and `.action`, each read into the messages that it defines.

A service defines a request and a response, an action a goal, a result and a feedback. What ROS derives from
them (an action's services, a service's event) is added here too, so that everything after this file knows
messages only. The texts of the messages are ROS's own notation.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from aos_protocol.errors import DeployError

KINDS = ("msg", "srv", "action")

SHIPPED = Path(__file__).parent / "share"
"""Interfaces that most robots use and that come with AOS."""


class InterfaceName(NamedTuple):
    """`std_srvs/srv/Trigger`, in three parts."""

    package: str
    kind: str
    name: str

    def __str__(self) -> str:
        return f"{self.package}/{self.kind}/{self.name}"


class Definition(NamedTuple):
    """A message: its name, as `package/kind/Name`, and its fields in ROS's notation."""

    name: InterfaceName
    text: str


def interface_name(text: str, kind: str) -> InterfaceName:
    """The full name behind `std_srvs/Trigger` or `std_srvs/srv/Trigger`; DeployError AOS106 if neither."""
    parts = [part for part in text.replace("::", "/").split("/") if part and part != "dds_"]
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or parts[1] not in KINDS:
        hint = f"Write it as package/{kind}/Name, such as {_EXAMPLES[kind]}"
        raise DeployError(f"{text!r} is not the name of a ROS interface", code="AOS106", hint=hint)
    return InterfaceName(*parts)


_EXAMPLES = {
    "msg": "std_msgs/msg/String",
    "srv": "std_srvs/srv/Trigger",
    "action": "nav2_msgs/action/NavigateToPose",
}


def definitions_in(places: Iterable[Path]) -> dict[InterfaceName, Path]:
    """The interface files in folders, at any depth, or named one by one; earlier places win.

    The package is the folder that holds `msg`, `srv` or `action`, as in every ROS package; without such a
    folder it is the one that the file is in. DeployError AOS101 for a place that does not exist.
    """
    found: dict[InterfaceName, Path] = {}
    for place in places:
        if not place.exists():
            hint = "Name a .msg, .srv or .action file, or a folder of them"
            raise DeployError(f"there is no interface file or folder {place}", code="AOS101", hint=hint)
        for path in [place] if place.is_file() else sorted(_interface_files(place)):
            folder = path.resolve().parent
            package = folder.parent if folder.name in KINDS else folder
            found.setdefault(InterfaceName(package.name, path.suffix[1:], path.stem), path)
    return found


def _interface_files(folder: Path) -> Iterator[Path]:
    for kind in KINDS:
        yield from folder.rglob(f"*.{kind}")


def file_of(name: InterfaceName) -> str:
    """Returns the path at which a definition is looked for: `std_srvs/srv/Trigger.srv`."""
    return f"{name.package}/{name.kind}/{name.name}.{name.kind}"


def missing_interface(name: InterfaceName, used_by: str = "") -> DeployError:
    """The error for a type that nobody has defined; it names the file to add."""
    user = f", which {used_by} uses," if used_by else ""
    return DeployError(
        f"the ROS interface {name}{user} is not known here",
        code="AOS806",
        hint=f"Add the file {file_of(name)} to a folder that `interfaces:` of the adapter names; "
        f"on a machine with ROS it is in the folder share/{name.package}",
    )


def messages_of(name: InterfaceName, text: str) -> tuple[Definition, ...]:
    """The messages that a file defines, and what ROS derives from them, for a service or an action."""
    package, kind, short = name
    if kind == "msg":
        return (Definition(name, text),)
    parts = _parts(name, text)
    if kind == "srv":
        return _service(package, "srv", short, *parts)
    goal, result, feedback = parts
    prefix = f"{package}/{kind}/{short}"
    return (
        Definition(InterfaceName(package, kind, f"{short}_Goal"), goal),
        Definition(InterfaceName(package, kind, f"{short}_Result"), result),
        Definition(InterfaceName(package, kind, f"{short}_Feedback"), feedback),
        *_service(
            package,
            kind,
            f"{short}_SendGoal",
            f"{_GOAL_ID}{prefix}_Goal goal\n",
            "bool accepted\nbuiltin_interfaces/Time stamp\n",
        ),
        *_service(package, kind, f"{short}_GetResult", _GOAL_ID, f"int8 status\n{prefix}_Result result\n"),
        Definition(
            InterfaceName(package, kind, f"{short}_FeedbackMessage"),
            f"{_GOAL_ID}{prefix}_Feedback feedback\n",
        ),
    )


_GOAL_ID = "unique_identifier_msgs/UUID goal_id\n"


def _service(package: str, kind: str, short: str, request: str, response: str) -> tuple[Definition, ...]:
    prefix = f"{package}/{kind}/{short}"
    return (
        Definition(InterfaceName(package, kind, f"{short}_Request"), request),
        Definition(InterfaceName(package, kind, f"{short}_Response"), response),
        # ROS 2 hashes these two into the service's type. Nobody sends them to us.
        Definition(
            InterfaceName(package, kind, f"{short}_Event"),
            "service_msgs/ServiceEventInfo info\n"
            f"{prefix}_Request[<=1] request\n{prefix}_Response[<=1] response\n",
        ),
        Definition(
            InterfaceName(package, kind, short),
            f"{prefix}_Request request_message\n{prefix}_Response response_message\n"
            f"{prefix}_Event event_message\n",
        ),
    )


def _parts(name: InterfaceName, text: str) -> list[str]:
    """The sections of a file between its lines of dashes."""
    sections: list[list[str]] = [[]]
    for line in text.splitlines():
        if line.split("#")[0].strip() == "---":
            sections.append([])
        else:
            sections[-1].append(line)
    expected = 2 if name.kind == "srv" else 3
    if len(sections) != expected:
        raise DeployError(
            f"{name} has {len(sections)} sections instead of {expected}",
            code="AOS104",
            hint="Lines of three dashes, ---, separate "
            + ("request and response" if name.kind == "srv" else "goal, result and feedback"),
        )
    return ["\n".join(lines) + "\n" for lines in sections]
