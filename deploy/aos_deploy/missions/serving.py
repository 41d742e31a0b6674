"""The deploy file's `serve:`: what others see of a robot that AOS simulates or drives, by kind."""

from typing import Any

from aos_deploy.deployment.reading import Deployment
from aos_deploy.processes.program import Program
from aos_language.load import load_bundle
from aos_protocol.errors import DeployError
from aos_skills.ros.connect import KINDS
from aos_skills.ros.definitions import interface_name
from aos_skills.ros.documented import documented

_COMMON = ("interfaces", "types")
_OPTIONS = {
    "ros2": ("router", "domain", "distribution"),
    "dds": ("interface", "peers", "domain", "distribution"),
    "ros1": ("master", "python"),
}


def serving_program(deployment: Deployment, kind: str) -> Program:
    """The program that serves the adapters' paths and topics to nodes of a kind.

    Types are those that `serve:` gives, and for others those that the documents name. DeployError AOS801 if
    the kind or its options are wrong, or nothing has a type.
    """
    if kind not in KINDS:
        raise DeployError(f"nothing can be served as {kind!r}", hint=f"Known are {', '.join(KINDS)}")
    part = deployment.file.serve
    options = part.get(kind) or {}
    _check_keys("serve", part, (*_COMMON, *KINDS), deployment)
    _check_keys(f"serve.{kind}", options, _OPTIONS[kind], deployment)
    types = _types(deployment, part.get("types") or {})
    if not types:
        hint = "Name them, as in serve: {types: {/pick: std_srvs/srv/Trigger}}"
        raise DeployError(f"nothing in {deployment.path.name} has a ROS type to be served with", hint=hint)
    settings = {
        "kind": kind,
        "folder": str(deployment.path.parent),
        "options": {"interfaces": part.get("interfaces", [])} | options,
        "types": types,
    }
    return Program(name=f"serve-{kind}", module="aos_skills.ros.server", settings=settings)


def _check_keys(where: str, given: Any, known: tuple[str, ...], deployment: Deployment) -> None:
    if not isinstance(given, dict):
        raise DeployError(f"{where} in {deployment.path.name} is not a mapping")
    for name in given:
        if name not in known:
            hint = f"Its keys are {', '.join(known)}"
            raise DeployError(f"{where} in {deployment.path.name} has an unknown key {name}", hint=hint)


def _types(deployment: Deployment, given: dict[str, Any]) -> dict[str, str]:
    types: dict[str, str] = {}
    for bundle in deployment.bundles:
        project = load_bundle(bundle).project
        if project is not None:
            known = documented(project)
            types |= {name: text for name, text in (known.paths | known.topics).items() if text}
    for name, text in given.items():
        kind = next((word for word in ("msg", "action") if f"/{word}/" in str(text)), "srv")
        types["/" + name.strip("/")] = str(interface_name(str(text), kind))
    return types
