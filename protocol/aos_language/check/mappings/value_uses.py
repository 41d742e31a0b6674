"""Uses of values in mappings: an enum's is the text of its name, a compound's a dict, and a number no text.
Others are told, and so are slips of Python."""

import ast
import re
from collections.abc import Collection, Iterator

from aos_language.check.scope import Scope
from aos_language.findings import Findings
from aos_language.local_types import ELEMENTS, local_type
from aos_language.python_syntax import tree_of
from aos_protocol import documents
from aos_protocol.spelling import did_you_mean, nearest, quoted

_OF_NUMBERS = frozenset({"abs", "chr", "float", "int", "round"})
_PYTHON = {"bool": bool, "int": int, "float": float, "double": float, "string": str}
_STATUSES = ("succeeded", "refused", "failed", "timed_out", "cancelled", "unknown", "stopped")
_ORDERINGS = (ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE)


def check_value_uses(
    mapping: documents.AbstractionMapping,
    snippets: Iterator[documents.Snippet],
    model: documents.SkillModel,
    scope: Scope,
    findings: Findings,
) -> None:
    """Reports AOS149 for comparisons with what no value is called, of numbers with texts, and for
    calculations, and AOS121 for fields of a compound that are taken as attributes."""
    kinds = {variable.name: _type_of(variable, model, scope) for variable in mapping.local_variables}
    enums = {name: scope.enums[kind] for name, kind in kinds.items() if kind in scope.enums}
    enums["__skill_status"] = documents.EnumType("__skill_status", _STATUSES, mapping.span)
    kinds["__skill_status"] = "string"
    compounds = {name: scope.compounds[kind] for name, kind in kinds.items() if kind in scope.compounds}
    plain = {name: kind for name, kind in kinds.items() if kind in ELEMENTS}
    # A skill may take some of the values alone.
    takes_all = not model.possible_parameters and not any(v.is_constant for v in scope.variables.values())
    for snippet in snippets:
        tree, lines_above = _tree(snippet)
        nodes = list(ast.walk(tree))
        own = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        own |= {node.arg for node in nodes if isinstance(node, ast.arg)}
        own |= {name for node in nodes for name in _asked_for_type(node)}
        known = {name: enum for name, enum in enums.items() if name not in own}
        known_plain = {name: kind for name, kind in plain.items() if name not in own}
        fields = {name: compound for name, compound in compounds.items() if name not in own}
        numbers_and_texts = known_plain | dict.fromkeys(known, "string")
        tested = {id(part) for node in nodes for part in _tested(node)}
        for place, message, hint in python_slips(tree, kinds):
            span = snippet.locate(place.lineno - lines_above, place.col_offset + 1)
            findings.warning("AOS149", message, span, hint)
        for node in nodes:
            for name, message, hint in (
                *_attribute(node, numbers_and_texts, kinds, id(node) in tested),
                *_mistakes(node, known, takes_all),
                *_unlike(node, known_plain),
            ):
                span = snippet.locate(name.lineno - lines_above, name.col_offset + 1)
                findings.warning("AOS149", message, span, hint)
            for name, message, hint in _field(node, fields):
                span = snippet.locate(name.lineno - lines_above, name.col_offset + 1)
                findings.error("AOS121", message, span, hint)


def _tree(snippet: documents.Snippet) -> tuple[ast.AST, int]:
    """The syntax tree of an expression or of statements, and how many lines it has above the code.

    What is neither is told by `mapping_code`.
    """
    for text, mode, lines_above in ((f"(\n{snippet.code}\n)", "eval", 1), (snippet.code, "exec", 0)):
        try:
            return tree_of(text, mode), lines_above
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            continue
    return ast.Pass(), 0


def _type_of(variable: documents.LocalVariable, model: documents.SkillModel, scope: Scope) -> str:
    """The type of the skill's parameter, or of a part of it, that a local variable takes; of another variable
    its own where that is a number's or a text's."""
    if variable.source is not documents.LocalSource.PARAMETER:
        own = local_type(variable.type)
        return own.element if own is not None and not own.is_array else ""
    name, *fields = variable.parameter_path.split(".")
    kind = next((parameter.type for parameter in model.parameters if parameter.name == name), "")
    for field in fields:
        compound = scope.compounds.get(kind)
        types = {inner.name: inner.type for inner in compound.fields} if compound is not None else {}
        kind = types.get(field, "")
    return kind


def _mistakes(
    node: ast.AST, enums: dict[str, documents.EnumType], takes_all: bool
) -> Iterator[tuple[ast.expr, str, str]]:
    """The name, the message and the hint of each mistake in one node of the syntax tree."""

    def name_of(part: ast.AST) -> ast.Name | None:
        return part if isinstance(part, ast.Name) and part.id in enums else None

    if isinstance(node, ast.Compare) and len(node.comparators) == 1:
        sides = (node.left, node.comparators[0])
        for name, other in ((name_of(sides[0]), sides[1]), (name_of(sides[1]), sides[0])):
            if name is not None and isinstance(node.ops[0], _ORDERINGS):
                yield from _compared(name, other, enums[name.id])
        name, listed = name_of(node.left), getattr(node.comparators[0], "elts", [])
        for element in listed if name is not None and isinstance(node.ops[0], ast.In | ast.NotIn) else ():
            yield from _compared(element, element, enums[name.id]) if name is not None else ()
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _OF_NUMBERS:
        for argument in node.args:
            if (name := name_of(argument)) is not None:
                yield name, *_no_number(name.id, enums[name.id])
    elif (
        isinstance(node, ast.Subscript)
        and isinstance(node.value, ast.Dict)
        and (name := name_of(node.slice)) is not None
    ):
        yield from _looked_up(name, node.value, enums[name.id], takes_all)
    elif (
        isinstance(node, ast.Subscript)
        and isinstance(node.value, (ast.List, ast.Tuple))
        and (name := name_of(node.slice)) is not None
    ):
        yield name, *_no_number(name.id, enums[name.id])


def _attribute(
    node: ast.AST, plain: dict[str, str], kinds: dict[str, str], is_tested: bool
) -> Iterator[tuple[ast.expr, str, str]]:
    """An attribute that a number or a text does not have, and a method that a condition does not call."""
    if not (isinstance(node, ast.Attribute) and isinstance(value := node.value, ast.Name)):
        return
    kind = plain.get(value.id, "")
    if kind and not hasattr(_PYTHON[kind], node.attr):
        message = f"`{value.id}` is of the type {kinds[value.id]}, which has no `{node.attr}`"
        close = did_you_mean(node.attr, dir(_PYTHON[kind]))
        yield value, message, close or f"Write `{value.id}` alone"
    elif kind and is_tested and callable(getattr(_PYTHON[kind], node.attr)):
        called = f"{value.id}.{node.attr}"
        yield value, f"`{called}` is a function, and counts as true", f"Write `{called}()`"


def _field(
    node: ast.AST, compounds: dict[str, documents.CompoundType]
) -> Iterator[tuple[ast.expr, str, str]]:
    match node:
        case ast.Attribute(value=ast.Name(id=name) as value, attr=attribute) if name in compounds:
            if attribute in {field.name for field in compounds[name].fields}:
                message = f"`{name}` is a dict of the fields of {compounds[name].name}"
                yield value, message, f"Write `{name}['{attribute}']`"


def _tested(node: ast.AST) -> Iterator[ast.AST]:
    """Yields the parts that a node compares or takes for true or false."""
    match node:
        case ast.Compare(left=left, comparators=others):
            yield from (left, *others)
        case ast.BoolOp(values=parts):
            yield from parts
        case ast.If(test=part) | ast.IfExp(test=part) | ast.Expression(body=part):
            yield part
        case ast.UnaryOp(op=ast.Not(), operand=part):
            yield part


def _asked_for_type(node: ast.AST) -> Iterator[str]:
    """Yields the name of a value whose type the code asks for: it is written for more than one."""
    match node:
        case ast.Call(func=ast.Name(id="isinstance" | "type"), args=[ast.Name(id=name), *_]):
            yield name


def _unlike(node: ast.AST, kinds: dict[str, str]) -> Iterator[tuple[ast.expr, str, str]]:
    """Comparisons of a number with a text: they are never equal, and have no order."""
    if not (isinstance(node, ast.Compare) and len(node.ops) == 1 and isinstance(node.ops[0], _ORDERINGS)):
        return
    sides = (node.left, node.comparators[0])
    for name, other in (sides, sides[::-1]):
        if not (isinstance(name, ast.Name) and name.id in kinds and isinstance(other, ast.Constant)):
            continue
        kind, value = kinds[name.id], other.value
        if kind == "string" and isinstance(value, int | float):
            yield name, f"`{name.id}` is a text, and {value!r} is none", f"Write it in quotes: `'{value}'`"
        elif kind != "string" and isinstance(value, str):
            message = f"`{name.id}` is of the type {kind}, and {value!r} is a text"
            yield name, message, "Write the value without quotes"


def _looked_up(
    name: ast.Name, table: ast.Dict, enum: documents.EnumType, takes_all: bool
) -> Iterator[tuple[ast.expr, str, str]]:
    """The keys of a dict that are no value of the enum; the values without a key, where all are written."""
    keys = [key.value for key in table.keys if isinstance(key, ast.Constant)]
    for key in table.keys:
        if isinstance(key, ast.Constant) and key.value not in enum.values:
            close = nearest(str(key.value), enum.values)
            hint = f"Did you mean '{close}'?" if close else f"There are {quoted(enum.values)}"
            yield key, f"no value of {enum.name} is called {key.value!r}", hint
            return
    missing = [value for value in enum.values if value not in keys]
    if takes_all and missing and len(keys) == len(table.keys):
        message = f"there is no key for {quoted(missing)} of {enum.name}, with which this fails"
        yield name, message, "Add it, or write `.get(...)` with a value for what is missing"


def _compared(
    name: ast.Name, other: ast.AST, enum: documents.EnumType
) -> Iterator[tuple[ast.expr, str, str]]:
    value = other.value if isinstance(other, ast.Constant) else None
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        yield name, *_no_number(name.id, enum, value)
    elif isinstance(value, str) and value not in enum.values:
        close = nearest(value, enum.values)
        hint = f"Did you mean '{close}'?" if close else f"There are {quoted(enum.values)}"
        yield name, f"no value of {enum.name} is called {value!r}", hint


def _no_number(name: str, enum: documents.EnumType, number: float = 0) -> tuple[str, str]:
    index = int(number) if 0 <= number < len(enum.values) else 0
    message = f"`{name}` is the text of a value of {enum.name}, and no number"
    return message, f"Compare it with the name, as in `{name} == '{enum.values[index]}'`"


Slip = tuple[ast.expr, str, str]
"""The place, the message and the hint."""

_OF_TEXTS = frozenset({"lower", "lstrip", "replace", "rstrip", "split", "splitlines", "strip", "upper"})
_GIVING = frozenset({"abs", "max", "min", "round", "sorted", "str", "sum"})
_GIVING_NONE = frozenset({"append", "extend", "reverse", "sort"})
_FILLING = frozenset({"format", "format_map", "replace", "sub"})
_FIELD = re.compile(r"\{(\w+)[^{}]*\}")


def python_slips(tree: ast.AST, variables: Collection[str]) -> Iterator[Slip]:
    """Yields the slips in the code of a mapping that has these local variables."""
    nodes = list(ast.walk(tree))
    names = {node.id for node in nodes if isinstance(node, ast.Name)} | {*variables, "__input"}
    fills_in = any(isinstance(node, ast.Attribute) and node.attr in _FILLING for node in nodes)
    for node in nodes:
        yield from _slip(node)
        if not fills_in and not isinstance(node, ast.JoinedStr | ast.Expr):
            yield from _without_f(node, names)


def _slip(node: ast.AST) -> Iterator[Slip]:
    match node:
        case ast.Compare(left=left, ops=[ast.Is() | ast.IsNot()], comparators=[ast.Constant(value=value)]):
            if isinstance(value, str | int | float) and not isinstance(value, bool):
                yield left, f"`is` asks whether this is the very object {value!r}", "Write `==` or `!=`"
        case ast.Assign(value=ast.Call(func=ast.Attribute(attr=name)) as call) if name in _GIVING_NONE:
            yield call, f"`{name}` changes the list and gives None", "Call it in a line of its own"
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=whole, attr=name)) as call):
            taker = whole.id if isinstance(whole, ast.Name) else "NAME"
            if name in _OF_TEXTS and taker != "os":
                yield call, f"nothing takes what `{name}` gives", f"Write `{taker} = {ast.unparse(call)}`"
        case ast.Expr(value=ast.Call(func=ast.Name(id=name)) as call) if name in _GIVING:
            yield call, f"nothing takes what `{name}` gives", f"Write `NAME = {ast.unparse(call)}`"
        case ast.BinOp(op=ast.BitXor(), left=left, right=ast.Constant(value=2 | 3 as power)):
            yield node, "`^` is no power in Python", f"Write `{ast.unparse(left)} ** {power}`"


def _without_f(node: ast.AST, names: Collection[str]) -> Iterator[Slip]:
    """Yields texts right below a node, but for those of an f-string and for comments."""
    for text in ast.iter_child_nodes(node):
        if isinstance(text, ast.Constant) and isinstance(text.value, str):
            field = _FIELD.search(text.value)
            if field is not None and field[1] in names:
                yield text, f"`{field[0]}` is text here, and no value", "Write an `f` before the quote"
