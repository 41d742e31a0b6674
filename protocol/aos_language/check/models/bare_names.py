"""The bare names of model code that no compiler will look at, since declarations around it are wrong."""

import math
import re
from collections import Counter
from collections.abc import Iterator

import msgspec

from aos_language.assembly import Assembly
from aos_language.check.models.blocks import Block, environment_blocks, read_block, skill_blocks
from aos_language.check.scope import Scope
from aos_language.cpp.keywords import CPP_KEYWORDS, OUR_NAMES, SPECIAL_NAMES
from aos_language.cpp.snippets import Access
from aos_language.findings import Findings
from aos_protocol.documents import Assignment, Environment, Project, SkillModel, line_and_column
from aos_protocol.spelling import nearest

_OWN_TYPE = re.compile(r"\b(?:class|enum|struct|typedef|typename|union|using)\s+(?:class\s+)?(\w+)")


class _Document(msgspec.Struct, frozen=True):
    """The code of a document, and the names of it that code may use."""

    blocks: tuple[Block, ...]
    names: frozenset[str]


def check_bare_names(assembly: Assembly, compiled: Project | None, findings: Findings) -> None:
    """Reports AOS110 for names that nothing declares in code that is not in what will be compiled.

    Only those that are like a name of the documents and stand once: others may be of C++'s library, or of a
    declaration that could not be read.
    """
    scope = Scope.of(assembly)
    if assembly.environment is None or scope.has_unread_files:
        return
    told = {(found.span.file, found.span.line) for found in findings.diagnostics if found.is_error}
    documents = list(_documents(assembly, assembly.environment, compiled))
    roots = (m.path[0] for doc in documents for block in doc.blocks for m in read_block(block).mentions)
    counts = Counter(roots)
    project = {*scope.enum_values, *scope.type_names, *scope.shared.all_names, *scope.low_level_names}
    foreign = {*scope.variables, *scope.skills, *CPP_KEYWORDS, *OUR_NAMES, *SPECIAL_NAMES, *dir(math), "std"}
    for document in documents:
        names = project | document.names
        for block in document.blocks:
            for mention in read_block(block).mentions:
                name = mention.path[0]
                if name in names | foreign or counts[name] > 1 or name.startswith("__"):
                    continue
                line, _ = line_and_column(block.snippet.code, mention.root.start)
                if "__moduleResponse" in block.snippet.code.splitlines()[line - 1]:
                    continue  # A response that its mapping gives, told as one.
                close = nearest(name, scope.shared.all_names if mention.access is Access.CALL else names)
                span = block.snippet.at(mention.root.start)
                if close and (span.file, span.line) not in told:
                    findings.unknown(name, (close,), f"unknown name `{name}`", span)


def _documents(assembly: Assembly, environment: Environment, compiled: Project | None) -> Iterator[_Document]:
    if compiled is None:
        yield _document(environment, tuple(environment_blocks(environment)), set())
    for name in assembly.models.keys() - {skill.name for skill in (compiled.skills if compiled else ())}:
        model, mapping = assembly.models[name], assembly.mappings.get(name)
        responses = {rule.response for rule in mapping.rules} if mapping is not None else set()
        yield _document(model, tuple(skill_blocks(model)), responses)


def _document(model: Environment | SkillModel, blocks: tuple[Block, ...], names: set[str]) -> _Document:
    for block in blocks:
        names |= {*block.names, *(declaration.name for declaration in read_block(block).declarations)}
        names.update(_OWN_TYPE.findall(block.snippet.code))
    for part in msgspec.structs.astuple(model):
        for assignment in part if isinstance(part, tuple) else ():
            if isinstance(assignment, Assignment) and assignment.temporary is not None:
                names |= {assignment.temporary.enum_name, *assignment.temporary.enum_values}
    return _Document(blocks, frozenset(names))
