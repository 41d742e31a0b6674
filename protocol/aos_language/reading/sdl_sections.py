"""A file's sections by word, and where words belong that its kind does not know."""

from aos_language.findings import Findings
from aos_language.reading.sdl_blocks import read_block
from aos_language.reading.sdl_text import Section, last_of
from aos_language.reading.sdl_words import GRAMMARS
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Assignment, Snippet

DEFAULT_DISCOUNT = 0.9999

_KINDS = {
    ".ef": "the environment file (.ef)",
    ".sd": "a skill document (.sd)",
    ".am": "a mapping (.am)",
    ".lf": "the low-level file (.lf)",
}


def places_of_words(suffix: str) -> dict[str, str]:
    """Returns for the words that this kind of file does not know the kind in which they belong."""
    return {
        word: f"in {_KINDS[other]}"
        for other, grammar in GRAMMARS.items()
        for word in grammar
        if other != suffix and word not in GRAMMARS[suffix]
    }


class Sections:
    """A file's sections. `span` is the file's first line."""

    def __init__(self, sections: list[Section], span: Span, findings: Findings) -> None:
        self.span = span
        self._sections = sections
        self.findings = findings

    def of(self, *words: str) -> list[Section]:
        """The sections of any of these words, in order."""
        return [section for section in self._sections if section.word in words]

    def all(self, word: str) -> list[Section]:
        return self.of(word)

    def last(self, word: str) -> Section | None:
        """The last section of that word, as `last_of` has it; a second `project:` begins a document."""
        projects = [section.span.line for section in self.of("project")]
        return last_of(self.all(word), projects)

    def block(self, word: str) -> tuple[Assignment, ...]:
        """The model code of a section."""
        return read_block(self.last(word))

    def code(self, word: str) -> Snippet | None:
        """The code of a section that is one snippet."""
        section = self.last(word)
        return section.code() if section is not None else None
