"""The names of a mapping's module beside its functions: shared code, low-level values, imports."""

import ast
import builtins
import keyword
from collections.abc import Iterator

import msgspec

from aos_language.local_types import RESERVED_LOCAL_NAMES
from aos_language.python_syntax import module_of
from aos_middleware.emission.generated_lines import ReadSnippets, function_name, literal
from aos_middleware.emission.python_code import LineOrigin, read_body
from aos_protocol.diagnostics import Diagnostic, Span
from aos_protocol.documents import AbstractionMapping, Import, LocalSource, LowLevelDocument, Snippet

_PRIMITIVES = frozenset({"bool", "int", "float", "double", "string", "str"})


class ImportPart(msgspec.Struct, frozen=True):
    """An import and what stands in for it: statements of the `except` branch."""

    load: str
    otherwise: tuple[str, ...]


class ModuleNames:
    """Builds what a mapping's functions find in their module, from what `snippets` has read of them.

    So it is asked behind the functions. That the names can be used is checked at once.
    """

    def __init__(
        self,
        mapping: AbstractionMapping,
        low_level: LowLevelDocument | None,
        shared: Snippet | None,
        snippets: ReadSnippets,
    ) -> None:
        self._mapping = mapping
        self._low_level = low_level
        self._shared = shared
        self._snippets = snippets
        self._check_names()

    def shared_code(self) -> list[str]:
        """Returns the code that all mappings share, where this one uses any of it."""
        code = read_body(self._shared) if self._shared is not None else None
        if isinstance(code, Diagnostic):
            self._snippets.diagnostics.append(code)
            return []
        if code is None or not any(snippet.reads & code.assigns for snippet in self._snippets.codes):
            return []
        self._snippets.codes.append(code)
        return self._snippets.marks.body(code, 0)

    def low_level_types(self) -> list[str]:
        """The classes of the low-level document, where this mapping can meet one."""
        if self._low_level is None or not self._meets_constants():
            return []
        types = []
        for type in self._low_level.types:
            fields = "".join(f", {literal(field.name)}" for field in type.fields)
            line = f"{type.name} = low_level_type({literal(type.name)}{fields})"
            types.append(self._snippets.marks.line(line, LineOrigin.of_span(type.span)))
        return types

    def constants(self) -> dict[str, list[str]]:
        """The statements that make each low-level constant, where this mapping can meet one."""
        if self._low_level is None or not self._meets_constants():
            return {}
        classes = {type.name for type in self._low_level.types}
        constants = {}
        for constant in self._low_level.constants:
            code = self._snippets.body(constant.code)
            if code is None:
                continue
            lines = []
            if constant.type not in _PRIMITIVES:
                made = (
                    constant.type if constant.type in classes else f"low_level_type({literal(constant.type)})"
                )
                origin = LineOrigin.of_span(constant.span)
                lines.append(self._snippets.marks.line(f"{constant.name} = {made}()", origin))
            constants[constant.name] = lines + self._snippets.marks.body(code, 0)
        return constants

    def _meets_constants(self) -> bool:
        """Returns whether a parameter can give this mapping a low-level value, or a snippet names one or
        its type."""
        assert self._low_level is not None
        names = {name for name, _ in self._low_level_names()}
        return any(
            variable.source is LocalSource.PARAMETER for variable in self._snippets.variables.values()
        ) or any(code.reads & names for code in self._snippets.codes)

    def imports(self) -> tuple[list[str], list[ImportPart], list[ImportPart]]:
        """Modules as a whole; names out of modules; and names that an `import *` may have to bring.

        Call it last: the third part goes by what the snippets call. `load` of that part is the name.
        """
        whole: dict[str, str] = {}
        parts: dict[str, ImportPart] = {}
        known = {
            *self._snippets.variables,
            *dir(builtins),
            *(name for code in self._snippets.codes for name in code.assigns),
        }
        known.update(name for name, _ in self._low_level_names())
        star = ""
        for imported in self._mapping.imports:
            names = self._import_names(imported)
            if names is None:
                continue
            known.update(names)
            text = ", ".join(imported.names)
            origin = LineOrigin.of_span(imported.span)
            if not imported.module:
                whole[text] = self._snippets.marks.line(f"import {text}", origin)
                continue
            stand_ins = [f"{name} = stand_in({literal(name)}, {literal(imported.module)})" for name in names]
            load = self._snippets.marks.line(f"    from {imported.module} import {text}", origin)
            parts[f"{imported.module} {text}"] = ImportPart(load, tuple(stand_ins) or ("pass",))
            if not names:
                star = star or imported.module
        called = (
            sorted({name for code in self._snippets.codes for name in code.calls} - known) if star else []
        )
        by_star = [
            ImportPart(name, (f"{name} = stand_in({literal(name)}, {literal(star)})",)) for name in called
        ]
        return list(whole.values()), list(parts.values()), by_star

    def _import_names(self, imported: Import) -> list[str] | None:
        """The names an import brings, none for `*`; None if it is not one."""
        functions = {function_name(variable) for variable in self._snippets.variables.values()}
        names = ", ".join(imported.names)
        text = f"from {imported.module} import {names}" if imported.module else f"import {names}"
        try:
            match module_of(text).body:
                case [ast.Import(names=aliases)] | [ast.ImportFrom(level=0, names=aliases)]:
                    brought = [alias.asname or alias.name.partition(".")[0] for alias in aliases]
                case _:
                    raise SyntaxError
        except (SyntaxError, ValueError):
            self._snippets.mistake("AOS121", f"{text!r} is not an import", imported.span)
            return None
        for name in brought:
            if name in RESERVED_LOCAL_NAMES or name in functions:
                self._snippets.mistake(
                    "AOS126", f"the import of {name} hides a generated function", imported.span
                )
        return [name for name in brought if name != "*"]

    def _check_names(self) -> None:
        known: set[str] = set()
        for variable in self._mapping.local_variables:
            name = variable.name
            if not _is_usable(name):
                self._snippets.mistake(
                    "AOS126", f"{name!r} cannot be the name of a local variable", variable.span
                )
            elif name in known:
                self._snippets.mistake("AOS126", f"two local variables are called {name}", variable.span)
            known.add(name)
        for name, span in self._low_level_names():
            if not _is_usable(name):
                self._snippets.mistake("AOS126", f"{name!r} cannot be the name of a low-level value", span)

    def _low_level_names(self) -> Iterator[tuple[str, Span]]:
        if self._low_level is not None:
            yield from ((type.name, type.span) for type in self._low_level.types)
            yield from ((constant.name, constant.span) for constant in self._low_level.constants)


def _is_usable(name: str) -> bool:
    return name.isidentifier() and not keyword.iskeyword(name) and name not in RESERVED_LOCAL_NAMES
