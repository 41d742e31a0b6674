"""The colours of SDL without a language server: a TextMate grammar, made of the words that documents have.

C++ and Python are coloured by the editor's own grammars. `code:` is Python in the sections of mappings, and
else C++.
"""

import json
from typing import Any

from aos_language.reading.sdl_text import Body
from aos_language.reading.sdl_words import GRAMMARS

_SECTIONS = [item for grammar in GRAMMARS.values() for item in grammar.items()]
_WORDS = [*_SECTIONS, *(part for _, section in _SECTIONS for part in section.parts.items())]
_WITH_PYTHON = [
    (name, section)
    for name, section in _SECTIONS
    if any(part.body is Body.PYTHON for part in section.parts.values())
]


def textmate_grammar() -> str:
    line = {"match": _opening(_names(_WORDS)), "captures": _captures()}
    comment = {"name": "comment.line.aos", "match": r"(?:^|\s)(?://|#).*$"}
    outside_code = {"include": "#outside"}
    parts = [part for _, section in _WITH_PYTHON for part in section.parts.items()]
    python = _names(part for part in parts if _is(part, Body.PYTHON))
    with_python = _region(_names(_WITH_PYTHON), _names(_SECTIONS))
    with_python["patterns"] = [_code(python, "python"), outside_code]
    own = [
        {"name": "variable.language.aos", "match": r"\b__[A-Za-z]\w*|\bstate_{0,2}(?=\.)"},
        {"name": "support.function.aos", "match": r"\bAOS(?:Utils::|\.)\w+"},
    ]
    grammar = {
        "name": "AOS",
        "scopeName": "source.aos",
        "fileTypes": [suffix.lstrip(".") for suffix in GRAMMARS],
        "patterns": [
            with_python,
            _code(_names(word for word in _WORDS if _is(word, Body.CPP)), "cpp"),
            outside_code,
        ],
        "repository": {"own": {"patterns": own}, "outside": {"patterns": [line, comment]}},
    }
    return json.dumps(grammar)


def _is(word: tuple[str, Any], body: Body) -> bool:
    return word[1].body is body


def _names(words: Any) -> str:
    return "|".join(dict.fromkeys(name for name, _ in words))


def _opening(names: str) -> str:
    return rf"^\s*({names})\s*(:)(?!:)"


def _captures() -> dict[str, dict[str, str]]:
    return {"1": {"name": "keyword.control.aos"}, "2": {"name": "punctuation.separator.aos"}}


def _region(names: str, next_names: str) -> dict[str, Any]:
    """Returns a pattern from a word's line to that of the next word."""
    return {
        "begin": _opening(names),
        "beginCaptures": _captures(),
        "end": rf"^(?=\s*(?:{next_names})\s*:(?!:))",
    }


def _code(names: str, language: str) -> dict[str, Any]:
    return {
        **_region(names, _names(_WORDS)),
        "contentName": f"meta.embedded.{language}",
        "patterns": [{"include": "#own"}, {"include": f"source.{language}"}],
    }
