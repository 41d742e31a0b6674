"""Imports that one mapping has and another needs.

The original system made one program of all mappings, so that each found what any of them imports. Here a
mapping has a module of its own, which takes what it needs from the others.
"""

import ast
from collections.abc import Iterable, Iterator

from msgspec.structs import replace

from aos_language.assembly import Assembly
from aos_language.check.mappings.mapping_code import snippets_of_mapping
from aos_language.check.mappings.python_names import PythonNames, imported_name, nodes_read
from aos_language.check.mappings.python_parsed import parsed
from aos_language.check.scope import Scope
from aos_language.findings import Findings
from aos_language.python_syntax import names_bound_by, place_in
from aos_protocol.diagnostics import Span
from aos_protocol.documents import AbstractionMapping, Import


def borrow_imports(assembly: Assembly, findings: Findings) -> None:
    """Gives each mapping the imports of names that only others import; warns (AOS110) of each such name."""
    lent = _lent_names(assembly.mappings.values())
    if not lent:
        return
    scope = Scope.of(assembly)
    for skill, mapping in assembly.mappings.items():
        names = PythonNames.of(mapping, assembly.models.get(skill), scope)
        borrowable = lent.keys() - names.known - {*names.parameters}
        missing = {name: span for name, span in _names_read(mapping) if name in borrowable}
        if missing and not names.is_open:
            assembly.mappings[skill] = _borrowing(mapping, [lent[name] for name in missing])
            _warn(missing, lent, findings)


def _lent_names(mappings: Iterable[AbstractionMapping]) -> dict[str, Import]:
    """Returns each name that an import of a mapping brings, with that import of this name alone."""
    lent: dict[str, Import] = {}
    for mapping in mappings:
        for imported in mapping.imports:
            for text in imported.names:
                one = replace(imported, names=(text,))
                lent.setdefault(imported_name(text), one)
    lent.pop("*", None)
    return lent


def _names_read(mapping: AbstractionMapping) -> Iterator[tuple[str, Span]]:
    """The names that snippets of a mapping read and do not bind, each at its last place."""
    for snippet in snippets_of_mapping(mapping):
        tree = parsed(snippet, "exec", Findings()) or parsed(snippet, "eval", Findings())
        if tree is None:
            continue  # Told where the code is checked.
        bound = {name for node in ast.walk(tree) for name in names_bound_by(node)}
        for node in nodes_read(tree, "NameError"):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id not in bound:
                yield node.id, place_in(snippet, node)


def _borrowing(mapping: AbstractionMapping, imports: Iterable[Import]) -> AbstractionMapping:
    activation = mapping.activation
    more = replace(activation, imports=(*activation.imports, *imports))
    return replace(mapping, activation=more)


def _warn(missing: dict[str, Span], lent: dict[str, Import], findings: Findings) -> None:
    for name, span in missing.items():
        message = f"`{name}` is imported in {lent[name].span.file} alone, and is taken from there"
        findings.warning("AOS110", message, span, "Import it here, too: the other document may go away")
