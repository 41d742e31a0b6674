"""The grammar of the three SDL files, and a file's sections by word."""

from collections.abc import Mapping

from aos_language.findings import Findings
from aos_language.reading.sdl_blocks import read_block
from aos_language.reading.sdl_text import Body, Grammar, Section, Word, last_of
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Assignment

DEFAULT_DISCOUNT = 0.9999

_LINE = Word()
_CPP = Word(Body.CPP)
_PYTHON = Word(Body.PYTHON)
_VARIABLE_PARTS = {
    "code": _CPP,
    "default_value": _CPP,
    "key_types": _LINE,
    "ml_max_value": _LINE,
    "ml_ignore": _LINE,
}
_BLOCK = Word(
    Body.CPP,
    parts={
        "assignment": _LINE,
        "temporary_variable": _LINE,
        "loop_previous": _LINE,
        "loop_next": _LINE,
        "loop_condition": _CPP,
        "loop_body": _CPP,
        "code": _CPP,
    },
)

GRAMMARS: Mapping[str, Grammar] = {
    ".ef": {
        "project": _LINE,
        "version": _LINE,
        "horizon": _LINE,
        "discount": _LINE,
        "define_type": Word(parts={"variable": _LINE, "enum_members": Word(is_list=True)}),
        "state_variable": Word(parts=_VARIABLE_PARTS),
        "action_parameter": Word(parts=_VARIABLE_PARTS),
        "mission_parameter": Word(parts={"code": _CPP, "default_value": _CPP}),
        "one_state_model": _LINE,
        "shared_code": _CPP,
        "shared_mapping_code": _PYTHON,
        "initial_belief": _BLOCK,
        "reward_code": _BLOCK,
        "special_state": Word(
            parts={
                "state_condition": _CPP,
                "reward": _LINE,
                "is_goal_state": _LINE,
                "is_failure_state": _LINE,
                "is_one_time_reward": _LINE,
            }
        ),
        "extrinsic_code": _BLOCK,
        "heuristic_code": _BLOCK,
        "print_code": _BLOCK,
        "monitor": Word(parts={"code": _CPP}),
    },
    ".sd": {
        "project": _LINE,
        "version": _LINE,
        "parameter": _LINE,
        "available_parameters_code": _BLOCK,
        "precondition": _BLOCK,
        "violate_penalty": _LINE,
        "rollout_policy": _BLOCK,
        "execution_time": _BLOCK,
        "dynamic_model": _BLOCK,
        "state_given_observation": _BLOCK,
    },
    ".am": {
        "project": _LINE,
        "version": _LINE,
        "response": Word(parts={"response_rule": _PYTHON, "assign_variable": _LINE, "value": _PYTHON}),
        "response_local_variable": _LINE,
        "stop_when": _PYTHON,
        "monitor": _LINE,
        "module_activation": Word(
            parts={
                "imports": _LINE,
                "path": _LINE,
                "srv": _LINE,
                "max_duration": _LINE,
                "parameter": _LINE,
                "code": _PYTHON,
            }
        ),
        "local_variable": Word(
            parts={
                "imports": _LINE,
                "type": _LINE,
                "topic": _LINE,
                "message_type": _LINE,
                "initial_value": _PYTHON,
                "action_parameter": _LINE,
                "from_ros_service_response": _LINE,
                "from_ros_reservice_response": Word(canonical="from_ros_service_response"),
                "is_heavy_variable": _LINE,
                "code": _PYTHON,
            }
        ),
    },
    ".lf": {
        "project": _LINE,
        "version": _LINE,
        "define_type": Word(parts={"variable": _LINE}),
        "constant": Word(parts={"code": _PYTHON}),
    },
}
"""The words of each kind of file: those of AOS 2.0, and ours for what JSON can say and it cannot; the
language page marks ours."""

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
        self._findings = findings

    def of(self, *words: str) -> list[Section]:
        """The sections of any of these words, in order."""
        return [section for section in self._sections if section.word in words]

    def all(self, word: str) -> list[Section]:
        return self.of(word)

    def last(self, word: str) -> Section | None:
        """The last section of that word, as `last_of` has it; a second `project:` begins a document."""
        projects = [section.span.line for section in self.of("project")]
        return last_of(self.all(word), self._findings, projects)

    def block(self, word: str) -> tuple[Assignment, ...]:
        """The model code of a section."""
        return read_block(self.last(word), self._findings)
