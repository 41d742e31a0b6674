"""The words of a project's mappings about its robot: the paths that they call, the topics that they listen
to."""

from collections.abc import Iterable
from typing import NamedTuple

from aos_protocol.documents import Import, LocalSource, Project


class Documented(NamedTuple):
    """Full ROS types by path and by topic; empty where the documents do not name one."""

    paths: dict[str, str]
    topics: dict[str, str]


def documented(project: Project) -> Documented:
    """Paths and topics of all mappings of a project, with a leading slash.

    A type may be imported by another mapping, as in the original system, if that names it.
    """
    paths: dict[str, str] = {}
    topics: dict[str, str] = {}
    of_all = [one for skill in project.skills for one in skill.mapping.imports if "*" not in one.names]
    for skill in project.skills:
        activation = skill.mapping.activation
        path = "/" + activation.path.strip("/")
        imports = (*activation.imports, *of_all)
        paths[path] = paths.get(path) or _full_type(activation.service_type, "srv", imports)
        for variable in skill.mapping.local_variables:
            if variable.source is LocalSource.TOPIC:
                imports = (*variable.imports, *activation.imports, *of_all)
                topic = "/" + variable.topic.strip("/")
                topics[topic] = topics.get(topic) or _full_type(variable.message_type, "msg", imports)
    return Documented(paths, topics)


def _full_type(name: str, kind: str, imports: Iterable[Import]) -> str:
    """`Trigger` with `from std_srvs.srv import *` is `std_srvs/srv/Trigger`."""
    parts = name.replace(".", "/").split("/")
    if len(parts) == 3:
        return name.replace(".", "/")
    if len(parts) == 2:
        return f"{parts[0]}/{kind}/{parts[1]}"
    modules = [one for one in imports if one.module.endswith(f".{kind}")]
    named = [one for one in modules if name in one.names]
    starred = [one for one in modules if "*" in one.names]
    found = [*named, *starred]
    return f"{found[0].module.replace('.', '/')}/{name}" if name and found else ""
