"""Abstraction mappings to Python: one readable module for each skill.

The module's text depends on nothing but the documents, byte for byte. Every line that stands for a part of a
document knows its place there, so that whatever Python says about the module is said about the document.
"""

import hashlib
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from aos_language.observed import reported_numbers
from aos_language.templates import templates_in
from aos_middleware.emission.generated_lines import ReadSnippets, word
from aos_middleware.emission.module_names import ModuleNames
from aos_middleware.emission.python_code import LineOrigin, python_fault
from aos_middleware.emission.sections import Sections
from aos_protocol.diagnostics import Diagnostic, Span
from aos_protocol.documents import AbstractionMapping, LowLevelDocument, Skill, SkillModel, Snippet
from aos_protocol.errors import DocumentError

_DIGEST_LENGTH = 16

_templates = templates_in(Path(__file__).parent / "templates", trims_blocks=True)


class EmittedMapping(msgspec.Struct, frozen=True):
    """A mapping as a Python module. `digest` is over `python`, and so over the documents with their places.

    `origins[i]` is where line i + 1 of `python` came from, None for lines that no document part made.
    `constants` names the low-level constants behind the state's `anyValue`s, `observed` the local variables
    that are observed as numbers; both are in the digest too. `handles_failures` says whether a rule looks at
    how the skill has ended.
    """

    skill: str
    python: str
    digest: str
    origins: tuple[LineOrigin | None, ...]
    mapping: AbstractionMapping
    constants: Mapping[str, str] = {}
    observed: tuple[str, ...] = ()
    handles_failures: bool = False

    @property
    def file_name(self) -> str:
        """The module's name in tracebacks and in the folder of generated modules."""
        return f"{self.skill}.py"

    @property
    def truths(self) -> tuple[str, ...]:
        """The local variables of the type bool."""
        return tuple(variable.name for variable in self.mapping.local_variables if variable.type == "bool")

    def locate(self, line: int, column: int = 1) -> Span:
        """The document place of a line and column of the module, both from 1."""
        if not 1 <= line <= len(self.origins):
            return self.mapping.span
        origin = self.origins[line - 1]
        return self.mapping.span if origin is None else origin.locate(column)


def emit_monitor(
    mapping: AbstractionMapping, low_level: LowLevelDocument | None, shared: Snippet | None
) -> EmittedMapping:
    """The Python module of a monitor's mapping, as of a skill that calls nothing."""
    return emit_mapping(
        Skill(SkillModel(mapping.project, mapping.monitor, mapping.span), mapping), low_level, shared=shared
    )


def emit_mapping(
    skill: Skill,
    low_level: LowLevelDocument | None = None,
    constants: Mapping[str, str] | None = None,
    shared: Snippet | None = None,
) -> EmittedMapping:
    """The Python module of a skill's abstraction mapping; `constants` are `low_level.default_constants`.

    `shared` is the environment's `shared_mapping_code`.

    DocumentError AOS121 with a diagnostic for each mistake if the documents' Python is not valid.
    """
    mapping = skill.mapping
    snippets = ReadSnippets(mapping)
    sections, names = Sections(mapping, snippets), ModuleNames(mapping, low_level, shared, snippets)
    request, functions, observe = sections.request(), sections.functions(), sections.observe()
    start_values = sections.start_values()
    shared_lines = names.shared_code()
    constant_code = names.constants()
    types = names.low_level_types()
    whole, parts, by_star = names.imports()
    if snippets.diagnostics:
        raise _refusal(mapping, snippets.diagnostics)
    support = [
        *(["low_level_type"] if constant_code or types else []),
        *(["stand_in"] if by_star or any(part.otherwise != ("pass",) for part in parts) else []),
    ]
    rendered = _templates.get_template("mapping.py.jinja").render(
        skill=skill.name,
        project=word(mapping.project),
        documents=word(mapping.span.file),
        digest=_digest_of(mapping, low_level),
        support=", ".join(support),
        whole_imports=whole,
        from_imports=parts,
        star_imports=by_star,
        low_level_types=types,
        constants=constant_code,
        shared_code=shared_lines,
        start_values=start_values,
        request=None if mapping.monitor else request,
        functions=functions,
        observe=observe,
        tables=sections.tables(constant_code),
    )
    python, origins = snippets.marks.separate(rendered)
    constant_names = dict(constants or {})
    observed = tuple(number.name for number in reported_numbers(skill.model))
    emitted = EmittedMapping(
        skill=skill.name,
        python=python,
        digest=_digest_of(python, constant_names, observed),
        origins=origins,
        mapping=mapping,
        constants=constant_names,
        observed=observed,
        handles_failures=sections.handles_failures,
    )
    _check_whole(emitted)
    return emitted


def _digest_of(*parts: Any) -> str:
    return hashlib.sha256(msgspec.msgpack.encode(parts)).hexdigest()[:_DIGEST_LENGTH]


def _check_whole(emitted: EmittedMapping) -> None:
    """Compiles the module, for what shows only there, such as `global` in front of a local variable."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            compile(emitted.python, emitted.file_name, "exec", dont_inherit=True)
        except SyntaxError as error:
            span = emitted.locate(error.lineno or 1, error.offset or 1)
            raise _refusal(emitted.mapping, [python_fault(error, span)]) from None
        except (ValueError, RecursionError, MemoryError) as error:
            raise _refusal(emitted.mapping, [python_fault(error, emitted.mapping.span)]) from None


def _refusal(mapping: AbstractionMapping, diagnostics: list[Diagnostic]) -> DocumentError:
    return DocumentError(
        f"the abstraction mapping of {mapping.name} cannot be used",
        code="AOS121",
        hint="Mend the places named with this error",
        diagnostics=tuple(sorted(diagnostics, key=lambda diagnostic: diagnostic.span)),
    )
