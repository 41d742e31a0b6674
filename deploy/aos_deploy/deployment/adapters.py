"""The deploy file's `adapters:` and `bind:`: which adapters there are, and what each of them serves."""

from collections.abc import Iterable, Mapping
from typing import Any

import msgspec
from msgspec.structs import replace

from aos_deploy.deployment.adapter_kinds import (
    COMMAND,
    EXTERNAL,
    MODEL,
    OURS,
    PYTHON,
    Kind,
    adapter_kinds,
    kind_of,
)
from aos_deploy.deployment.hosts import check_host
from aos_deploy.deployment.typed import known_names, plain_value
from aos_deploy.deployment.yaml_source import YamlMap, YamlNode, YamlScalar
from aos_language.findings import Findings
from aos_protocol.access import ADAPTER, OPERATOR, WATCHER, Party
from aos_protocol.diagnostics import Span
from aos_protocol.keys import NAME, PATH
from aos_runtime.adapters import Binding
from aos_runtime.adapters.expressions import check_expression

EVERYTHING_ELSE = "*"

SPANS = "spans"
"""The process that sends spans to a collector."""

_OURS_ALONE = ("router", "registry", "middleware", "solver", "aos-up", SPANS, OPERATOR, WATCHER)
"""The names of our own processes, and of those who command and look on."""
_BINDING_KEYS = ("fields", "result")


def how_to_name(name: str, adapters: Iterable[str] = ()) -> str:
    """Returns what to do about the name of an adapter or a program; nothing where it can be used.

    `adapters` are the others, whose names a program cannot have.
    """
    if name in _OURS_ALONE:
        return f"AOS has these names for itself: {', '.join(_OURS_ALONE)}"
    if name in adapters:
        return "An adapter has this name"
    return "" if NAME.fullmatch(name) else "Use letters, digits, - and _"


class AdapterPlan(msgspec.Struct, frozen=True, kw_only=True):
    """One adapter: its kind, its options, and what is bound to it; see `AdapterSettings`."""

    name: str
    kind_name: str
    kind: Kind
    options: dict[str, Any] = {}
    bind: dict[str, Binding] = {}
    serves_others: bool = False
    elsewhere: tuple[str, ...] = ()

    @property
    def party(self) -> Party:
        """The adapter as the bus knows it."""
        return Party(
            name=self.name,
            role=ADAPTER,
            paths=tuple(self.bind),
            serves_others=self.serves_others,
            elsewhere=self.elsewhere,
        )

    @property
    def is_process(self) -> bool:
        """True if aos-up starts a process for it."""
        return self.kind_name != EXTERNAL

    @property
    def is_command(self) -> bool:
        """True if it is a program of the user's own."""
        return self.kind_name == COMMAND


def read_adapters(node: YamlMap, findings: Findings, world: str) -> tuple[AdapterPlan, ...]:
    """The adapters that something is bound to, in the order of the file. `world` is the simulated world's."""
    adapters = node.entries.get("adapters")
    named = _named(adapters, findings)
    # What is bound to an adapter with a mistake of its own is no mistake.
    wrong = adapters.entries.keys() - named.keys() if isinstance(adapters, YamlMap) else set()
    bind = node.entries.get("bind")
    bound: dict[str, dict[str, Binding]] = {}
    taken: dict[str, str] = {}
    others = ""
    for key, value in bind.entries.items() if isinstance(bind, YamlMap) else ():
        assert isinstance(bind, YamlMap)
        if _adapter_word(value) in wrong:
            continue
        found = _bound(key, value, named, bind.keys[key], findings)
        if found is None:
            continue
        name, binding = found
        bound.setdefault(name, {})
        if key == EVERYTHING_ELSE:
            others = name
            _check_others(name, value, named, findings)
        elif (path := "/" + key.strip("/")) in taken:
            findings.error("AOS103", f"the path {path} is bound twice", bind.keys[key])
        else:
            taken[path] = name
            bound[name][path] = binding
    plans = []
    for name, paths in bound.items():
        if (plan := named.get(name)) is None:
            kind = kind_of(name)
            assert kind is not None, "_bound has found it"
            plan = AdapterPlan(name=name, kind_name=name, kind=kind)
        if plan.kind_name == "pybullet" and "world" not in plan.options:
            plan = replace(plan, options=plan.options | {"world": world})
        if plan.kind_name == COMMAND and "command" not in plan.options:
            findings.error("AOS105", f"the adapter {name} has no command", node.span, _HOW_TO_NAME)
            continue
        elsewhere = tuple(path for path, of in taken.items() if of != name)
        plans.append(replace(plan, bind=paths, serves_others=name == others, elsewhere=elsewhere))
    return tuple(plans)


def played_by_model(faults: Mapping[str, float] | None = None) -> tuple[AdapterPlan, ...]:
    """Every skill is played by its own document, with these faults (`aos_deploy.played.faults`)."""
    options = {"faults": dict(faults)} if faults else {}
    return (AdapterPlan(name=MODEL, kind_name=MODEL, kind=OURS[MODEL], options=options, serves_others=True),)


_HOW_TO_SHARE = "Write it as {external: '', credential: FILE}; the adapter reads its password there"
_HOW_TO_NAME = "Write it as adapters: {NAME: {command: [PROGRAM, ARGUMENT]}}, and bind paths to NAME"


def _named(node: YamlNode | None, findings: Findings) -> dict[str, AdapterPlan]:
    """The adapters that are given a name and options."""
    plans = {}
    for name, item in node.entries.items() if isinstance(node, YamlMap) else ():
        assert isinstance(node, YamlMap)
        where = node.keys[name]
        if hint := how_to_name(name):
            findings.error("AOS126", f"{name!r} is no name for an adapter", where, hint)
        elif (plan := _plan(name, item, where, findings)) is not None:
            plans[name] = plan
    return plans


def _plan(name: str, node: YamlNode, where: Span, findings: Findings) -> AdapterPlan | None:
    if isinstance(node, YamlScalar) and isinstance(node.value, str):
        node = YamlMap({node.value: YamlScalar(None, node.span)}, {node.value: node.span}, node.span)
    if not isinstance(node, YamlMap):
        hint = f"Name its kind: {', '.join(adapter_kinds())}"
        findings.error("AOS106", f"adapters.{name} is not a mapping", where, hint)
        return None
    chosen = {word: kind for word in node.entries if (kind := kind_of(word)) is not None}
    if len(chosen) != 1:
        said = " and ".join(chosen) or ", ".join(node.entries) or "nothing"
        hint = f"Give it one kind of {', '.join(sorted(adapter_kinds()))}"
        findings.error("AOS106", f"adapters.{name} has no one kind but {said}", where, hint)
        return None
    ((kind_name, kind),) = chosen.items()
    options = {}
    for word, value in node.entries.items():
        if word == kind_name:
            given = plain_value(value)
            if given is not None:
                options[kind.value] = given
        elif kind.options is None or word in kind.options:
            options[word] = plain_value(value)
        else:
            words = (kind_name, *kind.options)
            message, otherwise = f"unknown key adapters.{name}.{word}", known_names(words)
            findings.unknown(word, words, message, node.keys[word], otherwise, code="AOS102")
    if kind_name == COMMAND:
        command = options.get("command")
        if not (isinstance(command, list) and command and all(isinstance(word, str) for word in command)):
            findings.error("AOS106", f"adapters.{name}.command is not a list of texts", where, _HOW_TO_NAME)
            return None
        host, folder = options.get("host"), options.get("folder", "")
        check_host(f"adapters.{name}", host, folder, where, findings)
    credential = options.get("credential")
    if kind_name == EXTERNAL and "credential" in options and not (isinstance(credential, str) and credential):
        findings.error("AOS106", f"adapters.{name}.credential is no file", where, _HOW_TO_SHARE)
        return None
    if kind_name == "class":
        kind = replace(kind, adapter=str(options.pop("class", "")))
    return AdapterPlan(name=name, kind_name=kind_name, kind=kind, options=options)


def _bound(
    path: str, node: YamlNode, named: dict[str, AdapterPlan], where: Span, findings: Findings
) -> tuple[str, Binding] | None:
    """The adapter's name and how the path is bound to it."""
    if path != EVERYTHING_ELSE and not PATH.fullmatch(path):
        findings.error(
            "AOS106", f"{path!r} is not an activation path", where, 'Write it as /pick, or "*" for all others'
        )
        return None
    if isinstance(node, YamlScalar) and isinstance(node.value, str):
        if _is_known(node.value, named):
            return node.value, Binding()
        known = {**adapter_kinds(), **named}
        message = f"bind.{path} names an unknown adapter, {node.value}"
        findings.unknown(node.value, known, message, node.span, known_names(known))
        return None
    if not isinstance(node, YamlMap):
        findings.error("AOS106", f"bind.{path} is not an adapter's name, and no mapping", node.span)
        return None
    words = [word for word in node.entries if word not in _BINDING_KEYS]
    if len(words) != 1:
        hint = "Write it as {ADAPTER: what the adapter calls it}"
        findings.error("AOS106", f"bind.{path} does not name one adapter", node.span, hint)
        return None
    if not _is_known(words[0], named):
        known = {**adapter_kinds(), **named}
        names = [*known, *_BINDING_KEYS]
        message = f"bind.{path} names an unknown adapter, {words[0]}"
        findings.unknown(words[0], names, message, node.keys[words[0]], known_names(names))
        return None
    binding = Binding(
        target=plain_value(node.entries[words[0]]),
        fields=_expressions(node, "fields", path, findings),
        result=_expressions(node, "result", path, findings),
    )
    return words[0], binding


def _is_known(name: str, named: Mapping[str, AdapterPlan]) -> bool:
    return name in named or kind_of(name) is not None


def _adapter_word(node: YamlNode) -> object:
    """The adapter that a value of `bind:` names; None where it names none, or several."""
    if isinstance(node, YamlMap):
        words = [word for word in node.entries if word not in _BINDING_KEYS]
        return words[0] if len(words) == 1 else None
    return node.value if isinstance(node, YamlScalar) else None


def _check_others(name: str, node: YamlNode, named: Mapping[str, AdapterPlan], findings: Findings) -> None:
    """Tells what `"*"` cannot say: which function serves a path, and what the adapter calls it."""
    if (named[name].kind_name if name in named else name) == PYTHON:
        function = "FILE.py:pick" if name == PYTHON else "pick"
        message = f"bind.{EVERYTHING_ELSE} names {name}, whose paths are bound one by one to functions"
        findings.error("AOS106", message, node.span, f"Write it as /pick: {{{name}: {function}}}")
    elif isinstance(node, YamlMap):
        message = f"bind.{EVERYTHING_ELSE} says more than an adapter's name"
        findings.error("AOS106", message, node.span, f'Write it as "{EVERYTHING_ELSE}": {name}')


def _expressions(node: YamlMap, key: str, path: str, findings: Findings) -> dict[str, str] | None:
    """Field names with their expressions; numbers and truth values stand for themselves."""
    given = node.entries.get(key)
    if given is None:
        return None
    if not isinstance(given, YamlMap):
        findings.error("AOS106", f"bind.{path}.{key} is not a mapping", given.span)
        return None
    texts = {}
    for name, item in given.entries.items():
        value = plain_value(item)
        texts[name] = value if isinstance(value, str) else repr(value)
        if wrong := check_expression(texts[name]):
            hint = "It is a Python expression over the fields that come in; a text needs quotes within quotes"
            findings.error("AOS106", f"bind.{path}.{key}.{name} is no expression: {wrong}", item.span, hint)
    return texts
