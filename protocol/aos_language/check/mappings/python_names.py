"""The names that the Python of a mapping uses: is there something behind each when it runs?

A name that nothing gives is an error, for it is a NameError in every run that comes to it. What an `import *`
brings nobody knows here, so there only names that are nearly known are told. Code in a `try` that catches
NameErrors is ready for them.
"""

from __future__ import annotations

import ast
import builtins
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from importlib import import_module

import msgspec
from msgspec.structs import replace

from aos_language.check.scope import Scope
from aos_language.check.shared_calls import check_python_call
from aos_language.cpp.keywords import STATES
from aos_language.findings import Findings
from aos_language.local_types import OF_SKILL
from aos_language.python_syntax import module_of, names_bound_by, own_scope, place_in, place_of_byte
from aos_protocol.diagnostics import Mend, Severity
from aos_protocol.documents import (
    AbstractionMapping,
    Import,
    LowLevelConstant,
    LowLevelDocument,
    LowLevelType,
    SkillModel,
    Snippet,
)
from aos_protocol.spelling import quoted

_OF_MESSAGES = (".msg", ".srv", ".action")
_INPUT, _PARAMETERS = "__input", "parameters"
_MESSAGES = frozenset({"data", "message", "msg", "req", "res", "response", "result"})
"""Names that people give to what has come."""
_LOOKED_INTO = frozenset({"math", "json", "random", "re", "statistics", "time"})
"""Modules that are imported to see what they have: they do nothing when they are."""
_BUILT_IN_NAMES = frozenset(dir(builtins))
_NEARLY = 0.85
"""A share of a name, from 0 to 1: with so much of a known one it is that one, mistyped."""
_WORD = re.compile(r"[A-Za-z_]\w*")
_OF_OTHER_LANGUAGES = {"true": "True", "false": "False", "null": "None", "none": "None"}


class PythonNames(msgspec.Struct, frozen=True):
    """The names that the code of one mapping can use.

    `known` are all names; `local_names` those of local variables, which are meant most often; `parameters`
    those of the skill. `is_open` where an `import *` brings names that nobody knows here. `of_end` are those
    that say how the skill has ended, `messages` the classes that are imported from modules of messages,
    `enum_values` those of the model, each with its enum, `functions` those of shared code, and `modules` what
    is imported as a whole.
    """

    known: frozenset[str]
    local_names: tuple[str, ...] = ()
    parameters: tuple[str, ...] = ()
    is_open: bool = False
    of_end: frozenset[str] = frozenset()
    messages: frozenset[str] = frozenset()
    enum_values: Mapping[str, str] = {}
    functions: Mapping[str, ast.FunctionDef] = {}
    modules: frozenset[str] = frozenset()

    @classmethod
    def of(cls, mapping: AbstractionMapping, model: SkillModel | None, scope: Scope) -> PythonNames:
        """The names of a mapping's own expressions."""
        imports = mapping.imports
        imported = _imported_names(imports)
        local_names = tuple(variable.name for variable in mapping.local_variables)
        known = _BUILT_IN_NAMES.union(imported or (), local_names, _names_of_constants(scope.low_level))
        known |= _names_of_shared(scope.shared_mapping_code)
        parameters = tuple(parameter.name for parameter in model.parameters) if model is not None else ()
        of_end = frozenset(() if mapping.monitor else OF_SKILL)
        messages = _imported_names(item for item in imports if item.module.endswith(_OF_MESSAGES)) or ()
        return cls(
            known,
            local_names,
            parameters,
            is_open=imported is None,
            of_end=of_end,
            messages=frozenset(messages),
            enum_values=scope.enum_values,
            functions=_shared_functions(scope.shared_mapping_code, local_names),
            modules=frozenset(name for item in imports if not item.module for name in item.names).difference(
                local_names
            ),
        )

    @classmethod
    def of_constants(cls, mappings: Iterable[AbstractionMapping], scope: Scope) -> PythonNames:
        """The names of the code that makes low-level constants, which each mapping's module has a copy of."""
        of_each = [cls.of(mapping, None, scope) for mapping in mappings]
        known = _names_of_constants(scope.low_level).union(
            _BUILT_IN_NAMES, *(names.known for names in of_each)
        )
        return cls(known, is_open=any(names.is_open for names in of_each))

    def of_rules(self, before: Iterable[ast.AST]) -> PythonNames:
        """Those of a rule: what says how the skill has ended, and what the rules `before` it have bound."""
        return self._also(self.of_end.union(*map(_bound_names, before)))

    def at_start(self) -> PythonNames:
        """Those of a first value, which is made when there is no local variable yet."""
        known = self.known.difference(self.local_names).union({_PARAMETERS})
        return replace(self, known=known)

    def of_code(self) -> PythonNames:
        """Those of a local variable's code."""
        return self._also({_INPUT})

    def _also(self, names: Iterable[str]) -> PythonNames:
        return replace(self, known=self.known.union(names))


def _imported_names(imports: Iterable[Import]) -> frozenset[str] | None:
    """The names that imports bring; None where an `import *` brings names we cannot know."""
    names = [imported_name(name) for item in imports for name in item.names]
    return None if "*" in names else frozenset(names)


def imported_name(text: str) -> str:
    """Returns the name that one part of an import brings: `b` of `a as b`, `a` of `a.b`."""
    return text.split(" as ")[-1].strip().split(".")[0]


def _names_of_constants(document: LowLevelDocument | None) -> frozenset[str]:
    """Returns the names from the low-level document in the mappings' modules: types, constants, what their
    code binds."""
    if document is None:
        return frozenset()
    names = {type.name for type in document.types} | {constant.name for constant in document.constants}
    for constant in document.constants:
        try:
            names |= _bound_names(module_of(constant.code.code))
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            continue  # Told where the code is checked.
    return frozenset(names)


def _names_of_shared(snippet: Snippet | None) -> frozenset[str]:
    """Returns the names that the environment's `shared_mapping_code` gives to the mappings' modules."""
    if snippet is None:
        return frozenset()
    try:
        return top_level_names(module_of(snippet.code))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return frozenset(_WORD.findall(snippet.code))  # Told where the code is checked.


def _shared_functions(snippet: Snippet | None, hidden: tuple[str, ...]) -> dict[str, ast.FunctionDef]:
    """The functions of the environment's `shared_mapping_code` by name, but for those that are hidden."""
    try:
        body = module_of(snippet.code).body if snippet is not None else []
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return {}  # Told where the code is checked.
    functions = (each for each in body if isinstance(each, ast.FunctionDef) and not each.decorator_list)
    return {function.name: function for function in functions if function.name not in hidden}


def top_level_names(tree: ast.AST) -> frozenset[str]:
    """The names that code's own statements bind: not those of functions' insides."""
    return frozenset(name for node in own_scope(tree) for name in names_bound_by(node))


def check_names(
    snippet: Snippet,
    tree: ast.AST,
    names: PythonNames,
    findings: Findings,
    severity: Severity = Severity.ERROR,
) -> None:
    """Reports AOS110 for each name of the snippet that nothing gives, and warns (AOS121) of messages that are
    made by position."""
    bound = _bound_names(tree)
    own = bound.union(names.local_names)
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name(id=name), args=[_, *_]) if name in names.messages:
                span = place_in(snippet, node)
                message = f"{name} is given fields by position, which fails where it cannot be imported"
                findings.warning("AOS121", message, span, f"Give them by name: `{name}(field=...)`")
            case ast.Call(func=ast.Name(id=name)) if name in names.functions and name not in bound:
                check_python_call(node, names.functions[name], place_in(snippet, node), findings)
            case ast.Attribute(value=ast.Name(id=name), attr=constant) if name in names.messages:
                span = place_in(snippet, node)
                message = f"{name}.{constant} is not known where {name} cannot be imported"
                findings.warning("AOS121", message, span, "Write the constant's number")
            case ast.Attribute(value=ast.Name(id="input") as name) if "input" not in own:
                span = place_in(snippet, name)
                mend = Mend(span, len("input"), _INPUT)
                message = "`input` is a function of Python, which has no message"
                findings.error("AOS121", message, span, f"Write `{_INPUT}`", mend)
    _check_modules(snippet, tree, names, findings)
    known = names.known | bound
    is_open = names.is_open or "*" in known
    for node in nodes_read(tree, "NameError"):
        if not isinstance(node, ast.Name) or not isinstance(node.ctx, ast.Load) or node.id in known:
            continue
        span = place_in(snippet, node)
        hint = _hint(node.id, names)
        if is_open:
            close = get_close_matches(node.id, {*names.local_names, *names.known & {_INPUT}}, 1, _NEARLY)
            if not close and node.id.lower() not in _OF_OTHER_LANGUAGES:
                continue
            severity = Severity.WARNING
        known_here = (*names.local_names, *sorted(known - _BUILT_IN_NAMES))
        candidates, hint = (() if hint else known_here), hint or _local_variables(names)
        message = f"no local variable gives `{node.id}`"
        findings.unknown(node.id, candidates, message, span, hint, severity=severity)


def _check_modules(snippet: Snippet, tree: ast.AST, names: PythonNames, findings: Findings) -> None:
    """Warns (AOS110) of what a module of Python's own does not have."""
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import)]
    own = {alias.name for node in imports for alias in node.names if alias.asname is None}
    for node in nodes_read(tree, "AttributeError"):
        match node:
            case ast.Attribute(value=ast.Name(id=module) as owner, attr=name) if (
                module in own | names.modules
            ):
                has = dir(import_module(module)) if module in _LOOKED_INTO else [name]
                if name not in has:
                    at = place_in(snippet, owner)
                    span = replace(at, column=at.column + len(module) + 1)
                    message = f"the module {module} has no `{name}`"
                    findings.unknown(name, has, message, span, severity=Severity.WARNING)


def check_fields_set(
    constant: LowLevelConstant, tree: ast.AST, types: Iterable[LowLevelType], findings: Findings
) -> None:
    """Warns (AOS110) where a constant's code sets a field that its low-level type has not."""
    known = {type.name: [field.name for field in type.fields] for type in types}.get(constant.type)
    for node in ast.walk(tree) if known is not None else ():
        match node:
            case ast.Attribute(value=ast.Name(id=constant.name), attr=name, ctx=ast.Store()):
                if known is None or name in known:
                    continue
                line, end = node.end_lineno or node.lineno, node.end_col_offset or 0
                message = f"the low-level type {constant.type} has no field `{name}`"
                span = place_of_byte(constant.code, line, end - len(name.encode()))
                hint = f"The fields are {quoted(known)}"
                findings.unknown(name, known, message, span, hint, severity=Severity.WARNING)


def _bound_names(tree: ast.AST) -> frozenset[str]:
    """Every name that code binds somewhere, in whatever order and scope."""
    bound: set[str] = set()
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Del()) | ast.ExceptHandler(name=str(name)):
                bound.add(name)
            case ast.Global(names=several) | ast.Nonlocal(names=several):
                bound.update(several)
            case _:
                bound.update(names_bound_by(node))
    return frozenset(bound)


def nodes_read(tree: ast.AST, error: str = "") -> Iterator[ast.AST]:
    """The nodes of code, but for those in a `try` that catches such errors, or any: it is ready for them."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        skipped: list[ast.stmt] = []
        if isinstance(node, ast.Try | ast.TryStar) and any(_catches(each, error) for each in node.handlers):
            skipped = node.body
        waiting += [child for child in ast.iter_child_nodes(node) if child not in skipped]


def _catches(handler: ast.ExceptHandler, error: str) -> bool:
    """Returns whether an error, or any, is caught. What has no name of Python's own may catch it."""
    if handler.type is None or not error:
        return True
    named = {node.id for node in ast.walk(handler.type) if isinstance(node, ast.Name)}
    return not named <= _BUILT_IN_NAMES or bool(named & {error, "Exception", "BaseException"})


def _hint(name: str, names: PythonNames) -> str:
    """Advice on a name that people take for another; empty for other names."""
    if name.lower() in _OF_OTHER_LANGUAGES:
        return f"Python writes `{_OF_OTHER_LANGUAGES[name.lower()]}`"
    if name in names.local_names:
        return "A first value is made when there is no local variable yet: write a constant"
    if name in STATES:
        return "A mapping knows its local variables, not the state of the model"
    if name == _INPUT:
        return "It is there in the code of a local variable: make one of it, and name that one here"
    if name in _MESSAGES and _INPUT in names.known:
        return f"What has come is `{_INPUT}`"
    if name in OF_SKILL:
        return "Only rules of a skill's mapping know it"
    if name in names.parameters:
        return f"Add a local variable with `action_parameter: {name}`"
    if name in names.enum_values:
        return f"A value of {names.enum_values[name]} is a text here: write `'{name}'`"
    return "It is a module of Python: import it" if name in sys.stdlib_module_names else ""


def _local_variables(names: PythonNames) -> str:
    if names.local_names:
        return f"The local variables are {quoted(names.local_names)}"
    return "There are no local variables: add one that gives it"
