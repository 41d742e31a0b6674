"""Shared code of C++: the constants and functions that all model code of a project sees.

A function that draws, itself or by way of another one, has a source of draws as its first parameter in
emitted code. Documents do not write it: they write `AOS.Bernoulli(p)` in the function, and call it like any
other.
"""

import re
from collections.abc import Iterator
from functools import lru_cache

import msgspec
from msgspec.structs import replace
from tree_sitter import Node

from aos_language.cpp.facts import READING_FUNCTIONS
from aos_language.cpp.keywords import DRAW_SOURCES
from aos_language.cpp.snippets import Cpp, read_cpp_declarations
from aos_language.cpp.tokens import Extent
from aos_language.cpp.tree import Places, below, field_of, field_text, parts_of, text_of, tree_of


class SharedName(msgspec.Struct, frozen=True):
    """A declaration: what it declares, its kind for people, and where declaration and name stand.

    `is_late`: it needs compound types or functions, and so stands behind them.
    """

    name: str
    kind: str
    extent: Extent
    name_extent: Extent
    is_late: bool


class SharedFunction(SharedName, frozen=True):
    """A function. Its parameters begin at offset `parameters`, its body at offset `body`.

    `takes` are its parameters' names, in their order, `written` what stands for them in the document, and
    `needs` is how many of them have no default. `draws`: it has a source of draws as a parameter of its own.
    `only_reads`: a call changes nothing and gives a plain value, which follows from the arguments.
    `gives_handle`: a call may give a reference or a pointer.
    """

    parameters: int
    body: int
    has_parameters: bool
    draws: bool = False
    only_reads: bool = False
    gives_handle: bool = False
    takes: tuple[str, ...] = ()
    written: tuple[str, ...] = ()
    needs: int = 0


class SharedMisuse(msgspec.Struct, frozen=True):
    """A use that shared code cannot have, at a place of it."""

    extent: Extent
    message: str
    hint: str


class SharedCode(msgspec.Struct, frozen=True):
    """The declarations of the text, in its order."""

    cpp: Cpp
    names: tuple[SharedName, ...] = ()
    functions: tuple[SharedFunction, ...] = ()
    misuses: tuple[SharedMisuse, ...] = ()

    @property
    def drawing(self) -> frozenset[str]:
        return frozenset(function.name for function in self.functions if function.draws)

    @property
    def reading(self) -> frozenset[str]:
        """The functions of which a call changes nothing and gives a plain value."""
        changing = {function.name for function in self.functions if not function.only_reads}
        return frozenset(function.name for function in self.functions) - changing

    @property
    def changing(self) -> frozenset[str]:
        """The other functions."""
        return frozenset(function.name for function in self.functions) - self.reading

    @property
    def all_names(self) -> frozenset[str]:
        """The names of constants, functions, types and enum values; of text that is none, every word."""
        if self.cpp.faults:
            return frozenset(re.findall(r"[A-Za-z_]\w*", self.cpp.code))
        return frozenset(item.name for item in (*self.names, *self.functions) if item.name)

    @property
    def whole_numbers(self) -> dict[str, str]:
        """The constants that are whole numbers, as they are written."""
        constants = {name.name for name in self.names if name.kind == "constant"}
        values = {
            declaration.name: self.cpp.text(declaration.initial)
            for declaration in self.cpp.declarations
            if declaration.name in constants and declaration.initial is not None
        }
        return {name: value for name, value in values.items() if value.isdecimal()}

    def bodies(self) -> Iterator[str]:
        """The bodies of the functions, each at its lines and columns with blanks around it."""
        code = self.cpp.code
        blank = "".join(character if character == "\n" else " " for character in code)
        for function in self.functions:
            yield blank[: function.body - 1] + code[function.body - 1 : function.extent.end]

    def without(self, *, late: bool) -> str:
        """The text with the declarations of one kind blanked, so that lines and columns stay."""
        characters = list(self.cpp.code)
        for item in (*self.names, *self.functions):
            if item.is_late == late:
                for index in range(item.extent.start, item.extent.end):
                    if characters[index] != "\n":
                        characters[index] = " "
        return "".join(characters)


NO_SHARED_CODE = SharedCode(Cpp(""))

_OTHER_TYPES = re.compile(r"\b(?:auto|decltype|function|iterator)\b|[*&]")
_CONSTANT_REFERENCE = re.compile(r"const\b[^*&]*&|[^*&]*\bconst\s*&")
_HINT = "Shared code has constants, functions, enums and names of types"


@lru_cache(maxsize=256)
def shared_code(code: str, compounds: frozenset[str] = frozenset()) -> SharedCode:
    """Reads the text; `compounds` are the names of compound types."""
    cpp = read_cpp_declarations(code)
    if cpp.is_empty or cpp.faults:
        return SharedCode(cpp)
    return _Reading(code, cpp, compounds).read(tree_of(cpp.complete))


class _Reading:
    """One walk over the declarations."""

    def __init__(self, code: str, cpp: Cpp, compounds: frozenset[str]) -> None:
        self._extent = Places(code, cpp.complete, 0, cpp.missing_semicolons).extent
        self._cpp = cpp
        self._names: list[SharedName] = []
        self._functions: list[SharedFunction] = []
        self._misuses: list[SharedMisuse] = []
        self._words: dict[str, set[str]] = {}
        self._late: set[str] = set(compounds)
        self._other_types = _OTHER_TYPES

    def read(self, root: Node) -> SharedCode:
        functions = {_declared(node) for node in root.named_children if _is_function(node)}
        self._late |= {name for name in functions if name}
        for node in root.named_children:
            self._declaration(node)
        drawing = self._closure({name for name, words in self._words.items() if words & DRAW_SOURCES})
        plain = {function.name for function in self._functions if function.only_reads}
        changing = self._closure({function.name for function in self._functions} - plain) | drawing
        found = [
            replace(
                function,
                draws=function.name in drawing,
                only_reads=function.only_reads and function.name not in changing,
            )
            for function in self._functions
        ]
        return SharedCode(self._cpp, tuple(self._names), tuple(found), tuple(self._misuses))

    def _closure(self, names: set[str]) -> set[str]:
        """These functions, and those that call them."""
        found = set(names)
        while new := {name for name, words in self._words.items() if words & found} - found:
            found |= new
        return found

    def _declaration(self, node: Node) -> None:
        kind = node.type
        if kind == "comment" or (kind == "expression_statement" and text_of(node) == ";"):
            return
        if kind == "static_assert_declaration":
            # It has no name, and may ask anything.
            self._names.append(SharedName("", kind, self._extent(node), self._extent(node), True))
        elif _is_function(node):
            self._function(node)
        elif kind == "declaration":
            self._constant(node)
        elif kind == "enum_specifier":
            self._enum(node)
        elif kind in ("alias_declaration", "type_definition"):
            name = field_of(node, "name") or field_of(node, "declarator")
            self._add(node, name, "type")
            if name is not None and self._other_types.search(text_of(node)):
                names = rf"{self._other_types.pattern}|\b{re.escape(text_of(name).strip('*&( '))}\b"
                self._other_types = re.compile(names)
        elif kind in ("struct_specifier", "class_specifier", "union_specifier"):
            self._misuse(node, "a structure in shared code", "Declare a compound type with `define_type:`")
        elif kind == "using_declaration":
            self._misuse(node, "names of the library are known without this", "Leave it out")
        else:
            self._misuse(node, "this is no declaration", _HINT)

    def _constant(self, node: Node) -> None:
        qualifiers = {text_of(child) for child in node.children if child.type in _QUALIFIERS}
        for declarator in node.children_by_field_name("declarator"):
            name = _name_node(declarator)
            if any(part.type == "function_declarator" for part in _declarators(declarator)):
                self._misuse(
                    node, "a function without a body", "Write the whole function before its first use"
                )
                return
            if name is None:
                self._misuse(node, "this is no declaration", _HINT)
                return
            is_pointer = any(part.type == "pointer_declarator" for part in _declarators(declarator))
            is_constant = "constexpr" in qualifiers or ("const" in qualifiers and not is_pointer)
            value = field_of(declarator, "value")
            if not is_constant:
                hint = f"Write `const` before its type, or make a state variable of it: {_HINT.lower()}"
                self._misuse(name, f"`{text_of(name)}` could change, and steps could not be repeated", hint)
            elif value is None:
                self._misuse(
                    name, f"the constant `{text_of(name)}` has no value", "Write `= VALUE` behind it"
                )
            elif value.type == "lambda_expression":
                self._misuse(name, f"`{text_of(name)}` is a lambda", "Write a function")
            elif DRAW_SOURCES & set(_identifiers(value)):
                self._misuse(name, f"the constant `{text_of(name)}` is drawn", "Draw where it is needed")
            self._add(node, name, "constant")

    def _enum(self, node: Node) -> None:
        if (name := field_of(node, "name")) is not None:
            self._add(node, name, "enum")
        for value in parts_of(node, "body"):
            if (name := field_of(value, "name")) is not None:
                self._add(node, name, "enum value")

    def _add(self, node: Node, name: Node | None, kind: str) -> None:
        if name is None:
            self._misuse(node, "this is no declaration", _HINT)
            return
        is_late = not self._late.isdisjoint(_identifiers(node))
        if is_late:
            self._late.add(text_of(name))
        extent = self._extent(node)
        self._names.append(SharedName(text_of(name), kind, extent, self._extent(name), is_late))

    def _function(self, node: Node) -> None:
        function = next(part for part in below(node) if part.type == "function_definition")
        declarators = [*_declarators(field_of(function, "declarator"))]
        header = next((each for each in declarators if each.type == "function_declarator"), None)
        body = field_of(function, "body")
        name, parameters = field_of(header, "declarator"), field_of(header, "parameters")
        if body is None or name is None or parameters is None or name.type != "identifier":
            self._misuse(node, "this is no function", _HINT)
            return
        if text_of(name) in READING_FUNCTIONS:
            message = f"`{text_of(name)}` is a function of C++ already"
            self._misuse(name, message, "Choose another name")
        for source in (part for part in below(parameters) if text_of(part) in DRAW_SOURCES):
            message = f"`{text_of(source)}` is no parameter: a function that draws has it by itself"
            self._misuse(source, message, "Leave the parameter out, and call the function without it")
        declared = [parameter for parameter in parameters.named_children if parameter.type != "comment"]
        if len(declared) == 1 and text_of(declared[0]) == "void":
            declared = []
        self._words.setdefault(text_of(name), set()).update(_identifiers(body), _identifiers(parameters))
        written = text_of(function)[: text_of(function).index(text_of(name))]
        gives_handle = node.type != "function_definition" or self._other_types.search(written) is not None
        has_result = re.search(r"\bvoid\b", written) is None
        only_reads = has_result and not gives_handle and all(map(self._only_read, declared))
        self._functions.append(
            SharedFunction(
                text_of(name),
                "function",
                self._extent(node),
                self._extent(name),
                True,
                self._extent(parameters).start + 1,
                self._extent(body).start + 1,
                bool(declared),
                only_reads=only_reads,
                gives_handle=gives_handle,
                takes=tuple(_parameter_name(parameter) for parameter in declared),
                written=tuple(" ".join(text_of(parameter).split()) for parameter in declared),
                needs=sum(parameter.type == "parameter_declaration" for parameter in declared),
            )
        )

    def _only_read(self, parameter: Node) -> bool:
        """Returns whether a function can change nothing of its caller's through a parameter."""
        kind = text_of(parameter).partition("=")[0]
        return self._other_types.search(kind) is None or _CONSTANT_REFERENCE.match(kind.strip()) is not None

    def _misuse(self, node: Node, message: str, hint: str) -> None:
        self._misuses.append(SharedMisuse(self._extent(node), message, hint))


_QUALIFIERS = ("type_qualifier", "storage_class_specifier")


def _is_function(node: Node) -> bool:
    if node.type == "template_declaration":
        return any(child.type == "function_definition" for child in node.named_children)
    return node.type == "function_definition"


def _declared(node: Node) -> str:
    for part in below(node):
        if part.type == "function_declarator":
            return field_text(part, "declarator")
    return ""


def _declarators(node: Node | None) -> Iterator[Node]:
    while node is not None:
        yield node
        inner = field_of(node, "declarator")
        if inner is None and node.type in ("reference_declarator", "parenthesized_declarator"):
            inner = node.named_children[-1] if node.named_children else None
        node = inner


def _name_node(declarator: Node) -> Node | None:
    last = [*_declarators(declarator)][-1]
    return last if last.type == "identifier" else None


def _parameter_name(parameter: Node) -> str:
    """Returns the name of a parameter; empty for one without a name."""
    names = [text_of(part) for part in _declarators(field_of(parameter, "declarator"))]
    return names[-1] if names and names[-1].isidentifier() else ""


def _identifiers(node: Node) -> Iterator[str]:
    kinds = ("identifier", "type_identifier", "namespace_identifier")
    return (text_of(part) for part in below(node) if part.type in kinds)
