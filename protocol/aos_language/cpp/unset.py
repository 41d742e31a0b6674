"""Local variables of C++ that are read before they have a value, found by definite assignment.

Told are numbers, truths and values of enums that are declared without a value and then read where nothing has
set them: on no way there (`never`), or on some way only. Whatever may set a variable counts as if it does: a
call that takes it, a reference, a lambda that names it. Nobody asks whether two conditions exclude each
other, so a variable that was set under a condition counts as set under another one about the same names.
"""

import msgspec
from tree_sitter import Node

from aos_language.cpp.evaluation import Evaluation, State, Ways, merged
from aos_language.cpp.facts import Cpp
from aos_language.cpp.flow import names_in
from aos_language.cpp.tokens import Extent
from aos_language.cpp.tree import (
    Places,
    below,
    field_of,
    field_text,
    operator_of,
    parts_of,
    text_of,
    tree_of,
    without_brackets,
)


class Unset(msgspec.Struct, frozen=True):
    """A read of a variable without a value; `never` if no way to it sets one. `type` is as written."""

    name: str
    type: str
    extent: Extent
    never: bool


def unset_reads(cpp: Cpp, enums: frozenset[str] = frozenset()) -> tuple[Unset, ...]:
    """The first such read of each variable of the statements of a function body, in text order."""
    if cpp.is_empty or cpp.faults:
        return ()
    complete = cpp.complete
    root = tree_of(f"{_BEFORE}{complete}\n}}")
    if root.has_error or any(part.type in _JUMPS for part in below(root)):
        return ()
    walk = _Walk(enums)
    body = root.children[0].child_by_field_name("body")
    assert body is not None
    try:
        walk.statement(body, State())
    except RecursionError:
        return ()  # Text that is nested so deeply no person reads either.
    places = Places(cpp.code, complete, len(_BEFORE), cpp.missing_semicolons)
    return tuple(
        Unset(text_of(node), kind, places.extent(node), never) for node, kind, never in walk.found.values()
    )


_BEFORE = "void f() {"
_JUMPS = frozenset({"goto_statement", "labeled_statement", "try_statement"})
_DEEPEST = 6
"""Loops deeper than this are not looked into: each looks twice at what is in it."""
_HANDLES = frozenset({"reference_declarator", "pointer_declarator"})
_NUMBERS = frozenset({"primitive_type", "sized_type_specifier"})


class _Loop(msgspec.Struct):
    """The states at its breaks and at what goes on with the next turn. A `switch` has breaks alone."""

    is_switch: bool = False
    breaks: list[State] = []
    turns: list[State] = []


class _Walk(Evaluation):
    """One walk over the statements, in the order in which they run."""

    def __init__(self, enums: frozenset[str]) -> None:
        super().__init__()
        self._enums = enums
        self._loops: list[_Loop] = []

    def statement(self, node: Node | None, state: State) -> State:
        if node is None or not node.is_named or state.ended:
            return state
        handler = _STATEMENTS.get(node.type)
        if handler is not None:
            return handler(self, node, state)
        self.expression(node, state)
        return state

    def _block(self, node: Node, state: State) -> State:
        outer = set(state.unset)
        hidden = dict(self.declared)
        for child in node.named_children:
            state = self.statement(child, state)
        self.declared = hidden
        if node.type == "compound_statement":
            # A variable of the block is gone with it; one that it hid counts as set.
            state.unset = {name: ways for name, ways in state.unset.items() if name in outer}
        return state

    def _declaration(self, node: Node, state: State) -> State:
        kind = field_of(node, "type")
        words = {text_of(child) for child in node.children if child.type == "storage_class_specifier"}
        is_number = kind is not None and (kind.type in _NUMBERS or text_of(kind) in self._enums)
        of_condition = field_of(node, "value")  # `if (int n = count())`
        self.expression(of_condition, state)
        for declarator in node.children_by_field_name("declarator"):
            if declarator.type == "init_declarator":
                inner = field_of(declarator, "declarator")
                value = field_of(declarator, "value")
                if inner is not None and inner.type in _HANDLES:
                    self.may_be_set(value, state)
                self.expression(value, state)
                self.may_be_set(inner, state)
            elif of_condition is not None:
                self.may_be_set(declarator, state)
            elif declarator.type == "identifier" and is_number and not words & {"static", "extern"}:
                assert kind is not None
                self.declared[text_of(declarator)] = (declarator.start_byte, text_of(kind))
                state.unset[text_of(declarator)] = Ways()
            else:
                self.may_be_set(declarator, state)
        return state

    def _if(self, node: Node, state: State) -> State:
        condition = field_of(node, "condition")
        named = self.condition(condition, state)
        then = self._under(named, field_of(node, "consequence"), state.copy())
        alternative = field_of(node, "alternative")
        if alternative is None and _is_last_case(node):
            return then  # `if (x == A) .. else if (x == B) ..` may well be all there is.
        otherwise = self._under(named, alternative, state.copy())
        return merged([then, otherwise], named)

    def _under(self, named: frozenset[str], node: Node | None, state: State) -> State:
        self.conditions.append(named)
        state = self.statement(node, state)
        self.conditions.pop()
        return state

    def _while(self, node: Node, state: State) -> State:
        condition = field_of(node, "condition")
        named = self.condition(condition, state)
        after, breaks = self._body(named, field_of(node, "body"), state)
        # Most loops run: what each turn sets counts as set.
        return merged(breaks if _is_true(condition) else [after, *breaks], named)

    def _do(self, node: Node, state: State) -> State:
        state, breaks = self._body(frozenset(), field_of(node, "body"), state)
        if not state.ended:
            self.condition(field_of(node, "condition"), state)
        if _is_true(field_of(node, "condition")):
            return merged(breaks)
        return merged([state, *breaks])

    def _for(self, node: Node, state: State) -> State:
        outer, hidden = set(state.unset), dict(self.declared)
        state = self.statement(field_of(node, "initializer"), state)
        condition = field_of(node, "condition")
        named = self.condition(condition, state)
        after, breaks = self._body(named, field_of(node, "body"), state)
        if not after.ended:
            self.expression(field_of(node, "update"), after)
        is_endless = condition is None or _is_true(condition)
        state = merged(breaks if is_endless else [after, *breaks], named)
        self.declared = hidden
        state.unset = {name: unset for name, unset in state.unset.items() if name in outer}
        return state

    def _for_range(self, node: Node, state: State) -> State:
        whole = field_of(node, "right")
        named = self.condition(whole, state)
        hidden = dict(self.declared)
        inner = state.copy()
        self.may_be_set(field_of(node, "declarator"), inner)
        after, breaks = self._body(named, field_of(node, "body"), inner)
        self.declared = hidden
        return merged([after, *breaks], named)

    def _body(self, named: frozenset[str], node: Node | None, state: State) -> tuple[State, list[State]]:
        """The state where a turn of a loop ends, and those at its breaks.

        A turn may follow another one, so the first pass only finds out what that would have set.
        """
        if len(self._loops) >= _DEEPEST:
            return State(), []
        was_trial, self.is_trial = self.is_trial, True
        after, _ = self._turn(named, node, state.copy())
        self.is_trial = was_trial
        return self._turn(named, node, merged([state, after], named))

    def _turn(self, named: frozenset[str], node: Node | None, state: State) -> tuple[State, list[State]]:
        self._loops.append(_Loop())
        state = self._under(named, node, state)
        loop = self._loops.pop()
        return merged([state, *loop.turns], named), loop.breaks

    def _switch(self, node: Node, state: State) -> State:
        named = self.condition(field_of(node, "condition"), state)
        self._loops.append(_Loop(is_switch=True))
        self.conditions.append(named)
        current = State(ended=True)
        for case in parts_of(node, "body"):
            if case.type != "case_statement":
                current = self.statement(case, current)
                continue
            # A case is reached from the head, and from the one above that does not break.
            current = merged([state.copy(), current])
            value = field_of(case, "value")
            for child in case.named_children:
                if value is None or child != value:
                    current = self.statement(child, current)
        self.conditions.pop()
        # Cases without a `default` may well be all values.
        return merged([current, *self._loops.pop().breaks], named)

    def _break(self, node: Node, state: State) -> State:
        if self._loops:
            self._loops[-1].breaks.append(state.copy())
        return State(ended=True)

    def _continue(self, node: Node, state: State) -> State:
        for loop in reversed(self._loops):
            if not loop.is_switch:
                loop.turns.append(state.copy())
                break
        return State(ended=True)

    def _leave(self, node: Node, state: State) -> State:
        for child in node.named_children:
            self.expression(child, state)
        return State(ended=True)

    def _expression_statement(self, node: Node, state: State) -> State:
        for child in node.named_children:
            self.expression(child, state)
        return state

    def _nothing(self, node: Node, state: State) -> State:
        return state

    def condition(self, node: Node | None, state: State) -> frozenset[str]:
        """Reads a condition, which may declare; the names in it."""
        if node is None:
            return frozenset()
        for part in node.named_children:
            if part.type in ("declaration", "init_statement"):
                for child in [part] if part.type == "declaration" else part.named_children:
                    self.statement(child, state)
        self.expression(node, state)
        return frozenset(name.text for name in names_in(node))


_STATEMENTS = {
    "compound_statement": _Walk._block,
    "else_clause": _Walk._block,
    "init_statement": _Walk._block,
    "declaration": _Walk._declaration,
    "expression_statement": _Walk._expression_statement,
    "if_statement": _Walk._if,
    "while_statement": _Walk._while,
    "do_statement": _Walk._do,
    "for_statement": _Walk._for,
    "for_range_loop": _Walk._for_range,
    "switch_statement": _Walk._switch,
    "break_statement": _Walk._break,
    "continue_statement": _Walk._continue,
    "return_statement": _Walk._leave,
    "throw_statement": _Walk._leave,
    "function_definition": _Walk._nothing,
    "type_definition": _Walk._nothing,
    "using_declaration": _Walk._nothing,
    "alias_declaration": _Walk._nothing,
    "enum_specifier": _Walk._nothing,
    "struct_specifier": _Walk._nothing,
    "class_specifier": _Walk._nothing,
}


def _is_last_case(node: Node) -> bool:
    """Returns whether an `if` without `else` ends a chain that asks the same value for one constant after
    another."""
    asked = _asked(node)
    outer = node.parent.parent if node.parent is not None and node.parent.type == "else_clause" else None
    return bool(asked) and outer is not None and outer.type == "if_statement" and _asked(outer) == asked


def _asked(node: Node) -> str:
    """Returns the `x` of `if (x == A)`; empty for another condition."""
    condition = without_brackets(field_of(node, "condition"))
    if condition is None or condition.type != "binary_expression" or operator_of(condition) != "==":
        return ""
    return field_text(condition, "left")


def _is_true(node: Node | None) -> bool:
    value = without_brackets(node)
    return value is not None and text_of(value) in ("true", "1")
