"""An SDL file to a document: its suffix gives the kind, its stem a skill's name."""

from pathlib import PurePath

from aos_language.findings import Findings
from aos_language.reading.document import Document, DocumentKind, check_name, read_version
from aos_language.reading.sdl_environment import read_environment, read_low_level
from aos_language.reading.sdl_mapping import read_mapping
from aos_language.reading.sdl_sections import Sections, places_of_words
from aos_language.reading.sdl_skill import read_skill
from aos_language.reading.sdl_text import Section, parse_sdl
from aos_language.reading.sdl_words import GRAMMARS
from aos_language.reading.source import Source, Text

_KINDS = {
    ".ef": DocumentKind.ENVIRONMENT,
    ".sd": DocumentKind.SKILL,
    ".am": DocumentKind.MAPPING,
    ".lf": DocumentKind.LOW_LEVEL,
}


def read_sdl(source: Source, findings: Findings) -> Document:
    """The document of an SDL file, whatever could be read of it."""
    path = PurePath(source.name)
    suffix = path.suffix.lower()
    kind = _KINDS[suffix]
    span = source.span()
    parsed = parse_sdl(source, GRAMMARS[suffix], places_of_words(suffix), findings)
    sections = Sections(parsed, span, findings)
    project = _project(parsed, sections)
    place = next((given.value.span for given in sections.all("project")), None)
    given = sections.last("version")
    version = read_version(given.value if given is not None else None, findings)
    if kind is DocumentKind.ENVIRONMENT:
        content = read_environment(sections, project, span)
        return Document(kind, project, "environment", span, content, version, place)
    if kind is DocumentKind.LOW_LEVEL:
        low_level = read_low_level(sections, project, span)
        return Document(kind, project, "environment", span, low_level, version, place)
    name = path.stem if check_name(Text(path.stem, span), "a skill", findings) else ""
    if kind is DocumentKind.SKILL:
        skill = read_skill(sections, project, name, span)
        return Document(kind, project, name, span, skill, version, place)
    mapping = read_mapping(sections, project, name, span)
    return Document(kind, project, name, span, mapping, version, place)


def _project(parsed: list[Section], sections: Sections) -> str:
    given = sections.all("project")
    if not given or not given[0].value.text:
        span = given[0].span if given else sections.span
        hint = "Start it with `project: <name>`"
        sections.findings.error("AOS105", "this file does not say its project", span, hint)
        return ""
    if parsed[0].word != "project":
        sections.findings.warning("AOS127", "`project:` should be the first line", given[0].span)
    first = given[0].value
    for other in given[1:]:
        if other.value.text == first.text:
            hint = "It is skipped; of the sections that repeat, the last counts"
            sections.findings.warning("AOS125", "`project:` is given again", other.span, hint)
        else:
            message = f"this file is of project {first.text}, not of {other.value.text}"
            sections.findings.error("AOS113", message, other.value.span)
    return first.text
