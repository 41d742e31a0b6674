"""The code that all model code of a project shares: can each part of it be shared, and is it used?"""

import re
from collections.abc import Iterable

from aos_language.check.models.blocks import SHARED, all_blocks
from aos_language.check.scope import Scope
from aos_language.cpp.keywords import CPP_KEYWORDS, SPECIAL_NAMES
from aos_language.cpp.shared import SharedName
from aos_language.document_code import shared_code_of
from aos_language.findings import Findings
from aos_protocol.documents import Environment, SkillModel

_WORD = re.compile(r"[A-Za-z_]\w*")


def check_shared_code(environment: Environment, scope: Scope, findings: Findings) -> None:
    """Reports AOS145 for what cannot be shared, AOS126 for names that mean something else."""
    snippet = environment.shared_code
    if snippet is None:
        return
    shared = shared_code_of(environment)
    for misuse in shared.misuses:
        span = snippet.at(misuse.extent.start)
        findings.error("AOS145", misuse.message, span, misuse.hint)
    of_types = {*scope.enums, *scope.compounds, *scope.enum_values, *scope.low_level_names}
    functions = {function.name for function in shared.functions}
    first: dict[str, SharedName] = {}
    for item in (*shared.names, *shared.functions):
        span = snippet.at(item.name_extent.start)
        other = first.setdefault(item.name, item) if item.name else item
        if item.name in CPP_KEYWORDS or item.name in SPECIAL_NAMES:
            findings.error("AOS126", f"`{item.name}` means something else", span, "Choose another name")
        elif item.name in of_types:
            message = f"`{item.name}` is already the name of a type, an enum value or a low-level value"
            findings.error("AOS126", message, span, "Choose another name")
        elif other is not item and not (item.name in functions and other in shared.functions):
            place = snippet.at(other.name_extent.start)
            findings.error("AOS126", f"a second `{item.name}`", span, f"The first is at {place}")


def check_shared_names_are_used(
    environment: Environment, models: Iterable[SkillModel], findings: Findings
) -> None:
    """Reports AOS133 for each constant and function that no code names, and for enums of which nothing is
    named."""
    snippet = environment.shared_code
    if snippet is None:
        return
    shared = shared_code_of(environment)
    words: set[str] = set()
    for block in all_blocks(environment, models):
        if block.role is not SHARED:
            words.update(_WORD.findall(block.snippet.code))
    for kind in (*environment.compounds, *environment.variables):
        types = [field.type for field in getattr(kind, "fields", ())] or [getattr(kind, "type", "")]
        words.update(word for text in types for word in _WORD.findall(text))
    declared = (*shared.names, *shared.functions)
    for item in declared:
        others = shared.cpp.code[: item.extent.start] + shared.cpp.code[item.extent.end :]
        together = [other.name for other in declared if other.extent == item.extent]
        named = words.union(_WORD.findall(others))
        if not item.name or not named.isdisjoint(together) or together[0] != item.name:
            continue
        span = snippet.at(item.name_extent.start)
        message = f"no code uses the shared {item.kind} {item.name}"
        findings.warning("AOS133", message, span, "Leave it out, or use it")
