"""The flow of values in C++ statements: the names that a change of a name may depend on.

The reading is by name and without order: a flow stands for every time that the statement runs. Where the text
leaves a doubt, a name counts as `used`: it may have an effect on anything. So a name that no chain of flows
leads from to what is used has an effect on nothing.
"""

import re
from collections.abc import Iterator, Sequence

import msgspec
from tree_sitter import Node

from aos_language.cpp.facts import (
    CHANGING_METHODS,
    EXCHANGING_METHODS,
    HANDLE_METHODS,
    READING_FUNCTIONS,
    READING_METHODS,
    Cpp,
)
from aos_language.cpp.keywords import STATES
from aos_language.cpp.tree import (
    below,
    field_of,
    field_text,
    parts_of,
    picks_member,
    text_of,
    tree_of,
    without_brackets,
)


class Name(msgspec.Struct, frozen=True):
    """A variable of the state, or another one of the snippet. The whole state has no text."""

    text: str
    is_of_state: bool = False


_WHOLE_STATE = Name("", is_of_state=True)


class Flow(msgspec.Struct, frozen=True):
    """A change of `target`, of which the new value and whether it happens depend on `sources` at most."""

    target: Name
    sources: frozenset[Name]


class Flows(msgspec.Struct, frozen=True):
    """All of a snippet. `is_opaque`: the text cannot be read, so that everything may be used.

    `looped` decides how often a loop runs. `draws` stand for what the snippet's draws give, in the order of
    the text; each is a name of its own among the sources.
    """

    flows: tuple[Flow, ...] = ()
    used: frozenset[Name] = frozenset()
    looped: frozenset[Name] = frozenset()
    draws: tuple[Name, ...] = ()
    is_opaque: bool = False


class Locals(msgspec.Struct):
    """The names that the snippets of a section have declared so far, as the next snippet finds them.

    `made_of` says what a name was made of, `handles` may lead to that, and `values` lead to nothing else. A
    variable of a type in `types` may be a reference.
    """

    own: set[str] = set()
    types: set[str] = set()
    made_of: dict[Name, set[Name]] = {}
    handles: set[Name] = set()
    values: set[Name] = set()


def flows_of(
    cpp: Cpp,
    reading: frozenset[str] = frozenset(),
    shared: frozenset[str] = frozenset(),
    local: Locals | None = None,
) -> Flows:
    """The flows of the statements of a function body; `reading` are functions that change nothing, `shared`
    those that change at most what they are given. `local` goes on from snippet to snippet."""
    if cpp.is_empty:
        return Flows()
    root = tree_of(f"void f() {{{cpp.complete}\n}}")
    if cpp.faults or root.has_error:
        return Flows(is_opaque=True)
    local = Locals() if local is None else local
    local.own |= cpp.declared
    aliases = (part for node in below(root) if node.type in _ALIASES for part in below(node))
    local.types |= shared | {text_of(part) for part in aliases if part.type == "type_identifier"}
    walk = _Reading(_Functions((READING_FUNCTIONS | reading) - local.own, shared - local.own), local)
    walk.statement(root.children[0].child_by_field_name("body"), frozenset(), None)
    walk.flows += walk.flows_through_handles()
    draws = sorted(part.start_byte for part in below(root) if is_draw(part))
    return Flows(
        tuple(walk.flows), frozenset(walk.used), frozenset(walk.looped), tuple(map(_name_of_draw, draws))
    )


_Control = frozenset[Name]


class _Functions(msgspec.Struct, frozen=True):
    """Functions by name: those that only read, and those that see nothing but what they are given."""

    reading: frozenset[str]
    shared: frozenset[str]


class _Reading:
    """One walk over the statements.

    `control` is what decides whether a statement runs; `switch_control` is that of the innermost `switch`,
    where a `break` would leave one.
    """

    def __init__(self, functions: _Functions, local: Locals) -> None:
        self._functions = functions
        self._types, self._values = local.types, local.values
        self._made_of, self._handles = local.made_of, local.handles
        self.flows: list[Flow] = []
        self.used: set[Name] = set()
        self.looped: set[Name] = set()

    def flows_through_handles(self) -> Iterator[Flow]:
        """Yields what changes where something is changed through a handle: what it is made of, also by way of
        other variables."""
        waiting = list(self._handles)
        seen = set(waiting)
        while waiting:
            handle = waiting.pop()
            for name in self._made_of.get(handle, ()):
                yield Flow(name, frozenset({handle}))
                if not name.is_of_state and name not in seen | self._values:
                    seen.add(name)
                    waiting.append(name)

    def statement(self, node: Node | None, control: _Control, switch_control: _Control | None) -> None:
        if node is None or not node.is_named or node.type in _WITHOUT_EFFECT:
            return
        if node.type in _NESTED:
            for child in node.named_children:
                self.statement(child, control, switch_control)
        elif node.type == "expression_statement":
            for child in node.named_children:
                self._expression(child, control)
        elif node.type == "declaration":
            self._declaration(node, control)
        elif node.type == "if_statement":
            inner = self._condition(field_of(node, "condition"), control)
            self.statement(field_of(node, "consequence"), inner, switch_control)
            self.statement(field_of(node, "alternative"), inner, switch_control)
        elif node.type in ("while_statement", "do_statement"):
            inner = self._loop_condition(field_of(node, "condition"), control)
            self.statement(field_of(node, "body"), inner, None)
        elif node.type == "for_statement":
            self._for(node, control)
        elif node.type == "for_range_loop":
            self._range_for(node, control)
        elif node.type == "switch_statement":
            inner = self._condition(field_of(node, "condition"), control)
            self.statement(field_of(node, "body"), inner, inner)
        elif node.type == "case_statement":
            for child in node.named_children:
                if child != field_of(node, "value"):
                    self.statement(child, control, switch_control)
        elif node.type == "break_statement" and switch_control is not None and control == switch_control:
            pass
        else:
            # Jumps decide on all that follows; of other statements nothing is known.
            self.used |= control | names_in(node)

    # --- statements with parts ---

    def _condition(self, node: Node | None, control: _Control) -> _Control:
        """The control within; what the condition itself does is read as well."""
        if node is None:
            return control
        for declaration in (part for part in below(node) if part.type in ("declaration", "init_statement")):
            self.statement(declaration, control, None)
        self._no_effects(node, control)
        return control | names_in(node)

    def _loop_condition(self, node: Node | None, control: _Control) -> _Control:
        inner = self._condition(node, control)
        self.looped |= inner
        return inner

    def _for(self, node: Node, control: _Control) -> None:
        first = field_of(node, "initializer")
        if first is not None and first.type == "declaration":
            self._declaration(first, control)
        elif first is not None:
            self._expression(first, control)
        inner = self._loop_condition(field_of(node, "condition"), control)
        update = field_of(node, "update")
        if update is not None:
            self._expression(update, inner)
        self.statement(field_of(node, "body"), inner, None)

    def _range_for(self, node: Node, control: _Control) -> None:
        whole = field_of(node, "right")
        declarator = field_of(node, "declarator")
        if whole is None or declarator is None:
            self.used |= control | names_in(node)
            return
        self.statement(field_of(node, "initializer"), control, None)
        self._no_effects(whole, control)
        inner = control | names_in(whole)
        self.looped |= inner
        kind = field_of(node, "type")
        is_handle = self._may_refer(kind, declarator) or _gives_handle(whole)
        self._declare(declarator, inner, is_handle, of=names_in(whole))
        self.statement(field_of(node, "body"), inner, None)

    def _declaration(self, node: Node, control: _Control) -> None:
        for declarator in node.children_by_field_name("declarator"):
            value = field_of(declarator, "value") if declarator.type == "init_declarator" else None
            inner = field_of(declarator, "declarator") if value is not None else declarator
            if inner is None:
                self.used |= control | names_in(node)
                continue
            initial = names_in(value) if value is not None else frozenset()
            if value is not None:
                self._no_effects(value, control)
            kind = field_of(node, "type")
            is_handle = self._may_refer(kind, inner) or (
                value is not None and (_gives_handle(value) or _has_effects(value, self._functions))
            )
            is_value = _is_value_type(kind) and inner.type == "identifier"
            if is_value:
                self._values.add(Name(text_of(inner)))
            self._declare(inner, control | initial, is_handle and not is_value, of=initial)

    def _may_refer(self, kind: Node | None, declarator: Node) -> bool:
        words = {text_of(part) for part in below(kind)}
        is_hidden = not words.isdisjoint({"decltype", *self._types})
        return is_hidden or any(part.type in _HANDLE_DECLARATORS for part in below(declarator))

    def _declare(self, declarator: Node, sources: _Control, is_handle: bool, of: frozenset[Name]) -> None:
        """The names that a declarator gives. What is changed through a handle changes what it is made of."""
        for part in below(declarator):
            if part.type != "identifier":
                continue
            local = Name(text_of(part))
            self.flows.append(Flow(local, sources))
            self._made_of.setdefault(local, set()).update(of)
            if is_handle:
                self._handles.add(local)
                self.flows += [Flow(name, sources) for name in of]

    # --- expressions ---

    def _expression(self, node: Node, control: _Control) -> None:
        if node.type == "parenthesized_expression" and node.named_child_count == 1:
            self._expression(node.named_children[0], control)
        elif node.type == "comma_expression":
            for child in node.named_children:
                self._expression(child, control)
        elif node.type == "assignment_expression":
            value = field_of(node, "right")
            self._change(node, field_of(node, "left"), [value], control)
        elif node.type == "update_expression":
            self._change(node, field_of(node, "argument"), [], control)
        elif (target := _changed_by_method(node)) is not None:
            self._change(node, target, parts_of(node, "arguments"), control)
        elif _has_effects(node, self._functions):
            self.used |= control | names_in(node)

    def _change(
        self, node: Node, target: Node | None, values: Sequence[Node | None], control: _Control
    ) -> None:
        name = _root(target)
        if (
            name is None
            or target is None
            or any(_has_effects(part, self._functions) for part in (target, *values) if part)
        ):
            self.used |= control | names_in(node)
            return
        if not name.is_of_state and not name.text.startswith("__"):
            made_of = (names_in(value) for value in values)
            self._made_of.setdefault(name, set()).update(*made_of)
            # Any other target goes through what a variable refers to, or may do so.
            if target.type != "identifier" or any(_gives_handle(value) for value in values if value):
                self._handles.add(name)
        # The target's own name is a source as well, of an update as of an element among others.
        self.flows.append(Flow(name, control | names_in(node)))

    def _no_effects(self, node: Node, control: _Control) -> None:
        """Notes an effect on the side as a doubt, where a value is expected."""
        if _has_effects(node, self._functions):
            self.used |= control | names_in(node)


_ALIASES = ("type_definition", "alias_declaration")
_WITHOUT_EFFECT = frozenset({"comment", "using_declaration", "enum_specifier", *_ALIASES})
_NESTED = frozenset({"compound_statement", "else_clause", "labeled_statement", "init_statement"})
_HANDLE_DECLARATORS = ("reference_declarator", "pointer_declarator", "structured_binding_declarator")
_DRAWS = frozenset({"Bernoulli", "IsInitialized", "SampleDiscrete", "SampleNormal", "SampleUniform"})
_DRAW = re.compile(r"AOS(?:Utils)?\s*(?:\.|::)\s*(?:Bernoulli|SampleDiscrete|SampleNormal|SampleUniform)")
_EFFECTS = frozenset({
    "assignment_expression", "update_expression", "lambda_expression", "new_expression", "delete_expression",
    "co_await_expression", "throw_statement",
})  # fmt: skip


def names_in(node: Node | None) -> frozenset[Name]:
    """Every name that stands in a piece of the tree, but for those of types and members."""
    return frozenset(_names_in(node)) if node is not None else frozenset()


def _names_in(node: Node) -> Iterator[Name]:
    waiting = [node]
    while waiting:
        part = waiting.pop()
        field = field_of(part, "field") if picks_member(part) else None
        if field is not None:
            yield Name(text_of(field))
        if part.type == "field_expression" and (name := _of_state(part)) is not None:
            yield name
        elif part.type == "identifier":
            text = text_of(part)
            yield _WHOLE_STATE if text in STATES else Name(text)
        elif part.type == "qualified_identifier":
            waiting += [child for child in part.named_children if child.type == "template_function"]
        else:
            if is_draw(part):
                yield _name_of_draw(part.start_byte)
            waiting += part.named_children


def is_draw(node: Node) -> bool:
    """Returns whether a piece of the tree is a call such as `AOS.Bernoulli(p)` or
    `AOSUtils::SampleDiscrete(w)`."""
    return node.type == "call_expression" and _DRAW.fullmatch(field_text(node, "function")) is not None


def _name_of_draw(start_byte: int) -> Name:
    return Name(f"draw {start_byte}")


def _of_state(node: Node) -> Name | None:
    """The variable behind `state.x`."""
    if picks_member(node):
        return None
    argument, field = without_brackets(field_of(node, "argument")), field_of(node, "field")
    if argument is None or field is None or argument.type != "identifier" or text_of(argument) not in STATES:
        return None
    return Name(text_of(field), is_of_state=True)


_NUMBERS = frozenset({"bool", "char", "double", "float", "int", "long", "short", "size_t", "unsigned"})


def _is_value_type(node: Node | None) -> bool:
    """Returns whether a variable of the type, without `&` and `*`, refers to nothing else."""
    return node is not None and text_of(node).split()[-1] in _NUMBERS


def _root(node: Node | None) -> Name | None:
    """Returns the name that changes when a place changes: `state__.x[i].y` is a part of `x`."""
    while node is not None:
        if node.type == "identifier":
            return _WHOLE_STATE if text_of(node) in STATES else Name(text_of(node))
        if node.type == "field_expression" and (name := _of_state(node)) is not None:
            return name
        if node.type == "parenthesized_expression":
            node = node.named_children[0] if node.named_child_count == 1 else None
        elif node.type in ("field_expression", "subscript_expression", "pointer_expression"):
            node = field_of(node, "argument")
        elif node.type == "call_expression":
            function = field_of(node, "function")
            node = function if function is not None and function.type == "field_expression" else None
        else:
            return None
    return None


def _method_of(call: Node) -> str:
    """The name of the method that a call calls; empty where it calls something else."""
    is_call = call.type == "call_expression"
    return field_text(field_of(call, "function"), "field").split("<")[0] if is_call else ""


def _changed_by_method(node: Node) -> Node | None:
    """The object of a call such as `x.push_back(y)`, which changes nothing else."""
    method = _method_of(node)
    if method not in CHANGING_METHODS - EXCHANGING_METHODS:
        return None
    return field_of(field_of(node, "function"), "argument")


def _has_effects(node: Node, functions: _Functions) -> bool:
    """Returns whether evaluating it may change anything that is named in it."""
    return any(_is_effect(part, functions) for part in below(node))


def _is_effect(node: Node, functions: _Functions) -> bool:
    if node.type == "pointer_expression":
        return node.children[0].type == "&"
    if node.type == "binary_expression" and text_of(node.children[1]) in ("<<", ">>"):
        return node.children[0].type in ("call_expression", "identifier")  # It may be a stream.
    return node.type in _EFFECTS or (node.type == "call_expression" and _may_change(node, functions))


def _may_change(call: Node, functions: _Functions) -> bool:
    """Returns whether a call may change its object or an argument."""
    function = field_of(call, "function")
    if function is None or function.type == "primitive_type":
        return False
    if method := _method_of(call):
        is_draw = text_of(function).split(".")[0].strip() == "AOS" and method in _DRAWS
        return not is_draw and method not in READING_METHODS | HANDLE_METHODS
    name = text_of(function).split("<")[0].removeprefix("std::")
    if name in functions.reading or name.removeprefix("AOSUtils::") in _DRAWS:
        return False
    is_global = function.type in ("qualified_identifier", "template_function") or name in functions.shared
    if not is_global:
        return True  # A lambda changes what it captures.
    return bool(names_in(field_of(call, "arguments")))


def _gives_handle(node: Node) -> bool:
    """Returns whether the value of an expression may be an iterator or a pointer."""
    for part in below(node):
        name = field_text(part, "field") if part.type == "field_expression" else ""
        if name in HANDLE_METHODS or name.endswith("Objects"):
            return True
    return False
