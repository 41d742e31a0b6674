"""A walk over the syntax tree of a C++ snippet that collects what it mentions, calls and declares."""

from collections.abc import Iterable
from typing import TypeVar

from tree_sitter import Node

from aos_language.cpp.elements import asks_for_element, begun_container, is_checked, root_of
from aos_language.cpp.facts import (
    CHANGING_METHODS,
    HANDLE_METHODS,
    Access,
    Call,
    Cpp,
    Declaration,
    DeclarationKind,
    Element,
    Mention,
    OddPart,
)
from aos_language.cpp.odd import idle_parts, is_condition, is_turned, odd_parts
from aos_language.cpp.syntax_faults import mistaken_label, unexpected
from aos_language.cpp.tokens import Extent, Fault, FaultKind, Tokens
from aos_language.cpp.tree import (
    Places,
    below,
    child_of,
    field_of,
    names_of,
    operator_of,
    parts_of,
    picks_member,
    text_of,
)

_CHANGING_FUNCTIONS = frozenset({"Initialize", "SetNull", "Uninitialize", "exchange", "iota", "swap", "tie"})


class TreeReader:
    """One walk over a syntax tree. Nodes wait on a stack, so that no text is too deep to read.

    The tree is that of `complete`, the code with its missing semicolons; places are those of the code.
    """

    def __init__(self, code: str, complete: str, prefix: int, tokens: Tokens) -> None:
        self._code = code
        self._prefix = prefix
        self._tokens = tokens
        self.extent = Places(code, complete, prefix, tokens.missing_semicolons).extent
        self._stack: list[tuple[Node, Access]] = []
        self.mentions: list[Mention] = []
        self.calls: list[Call] = []
        self.elements: list[Element] = []
        self.declarations: list[Declaration] = []
        self.types: list[tuple[str, Extent]] = []
        self.faults: list[Fault] = []
        self.idle_operators: list[Extent] = []
        self.idle_values: list[Extent] = []
        self.set_in_conditions: list[tuple[Extent, Extent]] = []
        self.odd_parts: list[OddPart] = []

    def read(self, root: Node) -> Cpp:
        self._stack.append((root, Access.READ))
        while self._stack:
            self._visit(*self._stack.pop())
        return Cpp(
            code=self._code,
            mentions=_of_code(self.mentions),
            calls=tuple(sorted(self.calls, key=_by_start)),
            elements=tuple(self.elements),
            declarations=_of_code(self.declarations),
            types=tuple(sorted(self.types, key=lambda item: item[1].start)),
            literals=self._tokens.literals,
            missing_semicolons=self._tokens.missing_semicolons,
            faults=tuple(sorted(self.faults, key=_by_start)),
            idle_operators=tuple(sorted(self.idle_operators, key=lambda extent: extent.start)),
            idle_values=tuple(sorted(self.idle_values, key=lambda extent: extent.start)),
            set_in_conditions=tuple(sorted(self.set_in_conditions, key=lambda pair: pair[0].start)),
            odd_parts=tuple(sorted(self.odd_parts, key=_by_start)),
        )

    def _visit(self, node: Node, access: Access) -> None:
        if node.is_missing:
            self._fault(node, f"expected {node.type!r}")
            return
        if node.is_error:
            self._fault(node, *unexpected(node))
        for odd in odd_parts(node):
            extent = self.extent(odd.place)
            self.odd_parts.append(OddPart(extent, odd.message, odd.hint, odd.of_enums, odd.local))
        handler = _HANDLERS.get(node.type)
        if handler is None:
            self._push(node.children)
        else:
            handler(self, node, access)

    def _push(self, nodes: Iterable[Node | None], access: Access = Access.READ) -> None:
        self._stack += [(node, access) for node in nodes if node is not None]

    def _statement(self, node: Node, access: Access) -> None:
        compared, values = idle_parts(node)
        self.idle_operators += map(self.extent, compared)
        self.idle_values += map(self.extent, values)
        self._push(node.children)

    def _label(self, node: Node, access: Access) -> None:
        label = child_of(node, "label")
        if mistake := mistaken_label(text_of(label), self._code):
            self._fault(label, *mistake)
        self._push(node.children[1:])

    def _binary(self, node: Node, access: Access) -> None:
        """Takes what stands behind `>>` as changed, since a stream may set it."""
        self._push(node.children[:-1])
        self._push(node.children[-1:], Access.BIND if operator_of(node) == ">>" else Access.READ)

    def _comma(self, node: Node, access: Access) -> None:
        """A comma that drops what stands before it; between two digits it was meant as a point."""
        left, comma, right = (text_of(child) for child in node.children[:3])
        follows = node.children[0].end_byte == node.children[1].start_byte == node.children[2].start_byte - 1
        is_lone = node.children[2].type == "number_literal"
        if comma == "," and right[:1].isdigit() and (is_lone or (follows and left[-1:].isdigit())):
            self.idle_operators.append(self.extent(node.children[1]))
        self._push(node.children)

    def _fault(self, node: Node, message: str, hint: str = "") -> None:
        self.faults.append(Fault(FaultKind.SYNTAX, message, self.extent(node), hint))

    # --- paths ---

    def _path(self, node: Node, access: Access, assigned: Extent | None = None) -> None:
        parts, root = self._flatten(node, access)
        if root is None:
            return
        if any(picks_member(part) for part in below(node)):
            access, assigned = Access.UPDATE if access is Access.WRITE else access, None
        if node.type == "qualified_identifier" and _is_type(node):
            self.types.append((text_of(node).split("<")[0], self.extent(node)))
        else:
            extent, root_extent = self.extent(node), self.extent(root)
            self.mentions.append(Mention(parts, access, extent, root_extent, assigned=assigned))

    def _flatten(self, node: Node, access: Access = Access.READ) -> tuple[tuple[str, ...], Node | None]:
        """The parts of an access path; subscripts, and what an unnamed root is made of, go on the stack."""
        parts: list[str] = []
        current = node
        while True:
            if picks_member(current):
                parts.clear()  # The field may be any.
                chosen = child_of(current, "field")
                extent = self.extent(chosen)
                self.mentions.append(Mention((text_of(chosen),), Access.READ, extent, extent))
                current = child_of(current, "argument")
            elif current.type == "field_expression" and any(child.is_error for child in current.children):
                self._push(current.children)  # Such as two paths without the semicolon between them.
                return (), None
            elif current.type == "field_expression":
                parts += reversed(names_of(field_of(current, "field")))
                is_arrow = text_of(current.children[1]) == "->"
                current = child_of(current, "argument")
                if is_arrow:
                    self._dereferenced(current)
            elif current.type == "subscript_expression":
                parts.append("[]")
                indices = field_of(current, "indices")
                self._push([indices])
                if indices is not None and is_checked(current, indices):
                    self._element(child_of(current, "argument"), self.extent(indices))
                current = child_of(current, "argument")
            elif current.type == "parenthesized_expression" and current.named_child_count == 1:
                current = current.named_children[0]
            elif current.type in ("identifier", "this"):
                return (text_of(current), *reversed(parts)), current
            elif current.type == "qualified_identifier":
                self._push_template_arguments(current)
                return (*names_of(current), *reversed(parts)), current
            else:
                self._push([current], access)
                return (), None

    def _element(self, container: Node, brackets: Extent | None = None) -> None:
        self.elements.append(Element(self.extent(container), brackets, text_of(root_of(container))))

    def _dereferenced(self, iterator: Node) -> None:
        """Asks the container of an iterator, also one of the state, whose iterators check nothing."""
        if (container := begun_container(iterator)) is not None:
            self.elements.append(Element(self.extent(container)))

    def _push_template_arguments(self, node: Node | None) -> None:
        while node is not None and node.type == "qualified_identifier":
            node = field_of(node, "name")
        if node is not None and node.type in ("template_function", "template_method", "template_type"):
            self._push([field_of(node, "arguments")])

    # --- expressions ---

    def _assignment(self, node: Node, access: Access) -> None:
        operator = field_of(node, "operator")
        is_plain = operator is None or text_of(operator) == "="
        left, right = child_of(node, "left"), field_of(node, "right")
        kind = Access.WRITE if is_plain else Access.UPDATE
        if right is not None and is_turned(node):
            self.idle_operators.append(self.extent(right))
        if is_plain and operator is not None and is_condition(node, self._prefix):
            self.set_in_conditions.append((self.extent(left), self.extent(operator)))
        if _HANDLERS.get(left.type) is TreeReader._path:
            self._path(left, kind, self.extent(right) if right is not None else None)
        else:
            self._push([left], kind)
        self._push([right])
        self._push(child for child in node.children if child.is_error)

    def _update(self, node: Node, access: Access) -> None:
        self._push([field_of(node, "argument")], Access.UPDATE)

    def _pointer(self, node: Node, access: Access) -> None:
        is_address = node.children[0].type == "&"
        if not is_address:
            self._dereferenced(child_of(node, "argument"))
        self._push([field_of(node, "argument")], Access.BIND if is_address else access)

    def _pass_on(self, node: Node, access: Access) -> None:
        self._push(node.children, access)

    def _conditional(self, node: Node, access: Access) -> None:
        self._push([field_of(node, "condition")])
        branches = [field_of(node, "consequence"), field_of(node, "alternative")]
        self._push(branches, access)
        self._push(child for child in node.children if child.is_error)

    def _call(self, node: Node, access: Access) -> None:
        function = child_of(node, "function")
        arguments = child_of(node, "arguments")
        named = [child for child in arguments.named_children if child.type != "comment"]
        name = self._called(function, access)
        gives_place = access is not Access.READ and function.type != "field_expression"
        is_changing = gives_place or not _CHANGING_FUNCTIONS.isdisjoint(name)
        self._push(arguments.children, Access.BIND if is_changing else Access.READ)
        self.calls.append(
            Call(name, self.extent(node), self.extent(function), tuple(map(self.extent, named)))
        )

    def _called(self, function: Node, access: Access) -> tuple[str, ...]:
        if function.type == "template_function":
            self._push([field_of(function, "arguments")])
            function = child_of(function, "name")
        if function.type != "field_expression":
            parts, root = self._flatten(function)
            if root is not None:
                self.mentions.append(Mention(parts, Access.CALL, self.extent(function), self.extent(root)))
            return parts
        target = child_of(function, "argument")
        method = names_of(field_of(function, "field"))[-1:]
        if asks_for_element(function):
            self._element(target)
        parts, root = self._flatten(target, _method_access("".join(method), access, is_aos=False))
        if root is not None:
            kind = _method_access("".join(method), access, is_aos=parts == ("AOS",))
            path = (*parts, *method) if kind is Access.CALL else parts
            extent = self.extent(function if kind is Access.CALL else target)
            self.mentions.append(Mention(path, kind, extent, self.extent(root), "".join(method)))
        return (*parts, *method)

    # --- declarations ---

    def _declaration(self, node: Node, access: Access) -> None:
        type_node = field_of(node, "type")
        self._push([type_node])
        prefix = [child for child in node.children if child.type == "type_qualifier"]
        type_text = " ".join(text_of(part) for part in [*prefix, type_node] if part is not None)
        is_parameter = "parameter" in node.type
        kind = DeclarationKind.PARAMETER if is_parameter else DeclarationKind.VARIABLE
        is_constant = any(text_of(part) == "const" for part in prefix)
        for child in node.children_by_field_name("declarator"):
            self._declarator(child, type_text, kind, is_constant)
        self._push([field_of(node, "default_value"), field_of(node, "value")])
        if node.type == "for_range_loop":
            declarator = field_of(node, "declarator")
            binds = declarator is not None and "reference" in declarator.type and not is_constant
            self._push([field_of(node, "right")], Access.BIND if binds else Access.READ)
            self._push([field_of(node, "initializer"), field_of(node, "body")])
        self._push(child for child in node.children if child.is_error or child.is_missing)

    def _declarator(self, node: Node, type_text: str, kind: DeclarationKind, is_constant: bool) -> None:
        initial = field_of(node, "value") if node.type == "init_declarator" else None
        inner = child_of(node, "declarator") if node.type == "init_declarator" else node
        if inner.type in ("reference_declarator", "pointer_declarator"):
            initial = _within_brackets(initial)
        binds = inner.type == "reference_declarator" and not is_constant
        self._push([initial], Access.BIND if binds else Access.READ)
        self._push(child for child in node.children if child.is_error)
        while inner.type in ("reference_declarator", "pointer_declarator", "array_declarator"):
            if inner.type == "array_declarator":
                self._push([field_of(inner, "size")])
            type_text += {"reference_declarator": "&", "pointer_declarator": "*"}.get(inner.type, "[]")
            inner = field_of(inner, "declarator") or inner.named_children[-1]
        names = inner.named_children if inner.type == "structured_binding_declarator" else [inner]
        for name in names:
            if name.type == "identifier":
                extent = self.extent(initial) if initial is not None else None
                self.declarations.append(
                    Declaration(text_of(name), type_text, kind, self.extent(name), extent)
                )
            else:
                self._push(name.children)

    def _enum(self, node: Node, access: Access) -> None:
        name = field_of(node, "name")
        enum_name = text_of(name) if name is not None else ""
        if name is not None:
            self._push([name])
            extent = self.extent(name)
            self.declarations.append(Declaration(enum_name, "enum", DeclarationKind.ENUM, extent))
        for enumerator in parts_of(node, "body"):
            value_name = field_of(enumerator, "name")
            if enumerator.type == "enumerator" and value_name is not None:
                extent = self.extent(value_name)
                declaration = Declaration(text_of(value_name), enum_name, DeclarationKind.ENUMERATOR, extent)
                self.declarations.append(declaration)
                self._push([field_of(enumerator, "value")])

    def _captures(self, node: Node, access: Access) -> None:
        """Captures with a value, `[n = 1]`, are variables of the lambda. Others are named in its body."""
        for capture in node.named_children:
            left, right = (field_of(capture, side) for side in ("left", "right"))
            if capture.type != "lambda_capture_initializer" or left is None or right is None:
                continue
            binds = any(child.type == "&" for child in capture.children)
            self._push([right], Access.BIND if binds else Access.READ)
            self.declarations.append(
                Declaration(
                    text_of(left),
                    "auto&" if binds else "auto",
                    DeclarationKind.VARIABLE,
                    self.extent(left),
                    self.extent(right),
                )
            )

    def _type(self, node: Node, access: Access) -> None:
        self.types.append((text_of(node), self.extent(node)))

    def _skip(self, node: Node, access: Access) -> None:
        pass


_HANDLERS = {
    "assignment_expression": TreeReader._assignment,
    "call_expression": TreeReader._call,
    "binary_expression": TreeReader._binary,
    "comma_expression": TreeReader._comma,
    "comment": TreeReader._skip,
    "conditional_expression": TreeReader._conditional,
    "declaration": TreeReader._declaration,
    "enum_specifier": TreeReader._enum,
    "expression_statement": TreeReader._statement,
    "field_expression": TreeReader._path,
    "for_range_loop": TreeReader._declaration,
    "identifier": TreeReader._path,
    "labeled_statement": TreeReader._label,
    "lambda_capture_specifier": TreeReader._captures,
    "optional_parameter_declaration": TreeReader._declaration,
    "parameter_declaration": TreeReader._declaration,
    "parenthesized_expression": TreeReader._pass_on,
    "pointer_expression": TreeReader._pointer,
    "qualified_identifier": TreeReader._path,
    "subscript_expression": TreeReader._path,
    "this": TreeReader._path,
    "type_identifier": TreeReader._type,
    "update_expression": TreeReader._update,
}


def _method_access(method: str, outer: Access, *, is_aos: bool) -> Access:
    if is_aos:
        return Access.CALL
    if method in CHANGING_METHODS:
        return Access.UPDATE
    if method in HANDLE_METHODS:
        return Access.BIND
    return outer


def _is_type(node: Node | None) -> bool:
    while node is not None and node.type == "qualified_identifier":
        node = field_of(node, "name")
    return node is not None and node.type in ("type_identifier", "template_type")


def _within_brackets(initial: Node | None) -> Node | None:
    """The place that a reference is bound to: `x` of `int& one{x}`."""
    if initial is None or initial.type not in ("argument_list", "initializer_list"):
        return initial
    return initial.named_children[0] if initial.named_child_count == 1 else initial


def _by_start(item: Mention | Call | Declaration | OddPart | Fault) -> int:
    return item.extent.start


_Placed = TypeVar("_Placed", Mention, Declaration)


def _of_code(found: list[_Placed]) -> tuple[_Placed, ...]:
    """The finds of the code itself, in the order of the text: those around it have places without length."""
    return tuple(item for item in sorted(found, key=_by_start) if item.extent.start < item.extent.end)
