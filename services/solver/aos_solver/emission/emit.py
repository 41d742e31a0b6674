"""The emission of the lowered model as one C++ file that a person can read, and the way back from its lines.

The templates lay out; document code is put in afterwards, so that no text of a document is ever taken for a
template or for a mark. The same program gives the same bytes.
"""

import hashlib
import json
import re
from functools import cache
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_language.cpp.snippets import read_cpp
from aos_language.mission_parameters import ParameterLeaf
from aos_language.templates import Environment, templates_in
from aos_protocol import __version__
from aos_protocol.diagnostics import Span
from aos_protocol.spelling import column_of
from aos_solver.emission.document_lines import END, MARK, MODEL_FILE, Origin, put_code, string_literal
from aos_solver.emission.layout import Layout, layout_of, saved_variables
from aos_solver.emission.program import Local, ObjectList, Observed, Piece, Program, Skill

__all__ = ["MODEL_FILE", "Bound", "EmittedModel", "Origin", "emit"]

_OWN_NAMES = (
    "State", "Draft", "Constants", "Environment", "constants", "default_values", "members", "variables",
)  # fmt: skip


class Bound(msgspec.Struct, frozen=True):
    """A constraint of the mission: its event as it is written, and how probable it may be at most."""

    never: str
    probability: float


class EmittedModel(msgspec.Struct, frozen=True):
    """The file with what leads back from it. `snippets[n - 1]` is where document code of number n starts.

    `state_digest` is that of the declared state: models with the same can take over each other's beliefs.
    `locals` are the local variables that the engine wants with a real observation, for each skill whose
    observations correct the belief; `observed` are the numbers that a skill reports. `choosing_skills` are
    those whose parameters stand for state variables. `bounds` are the mission's constraints, in the order of
    the model's. `names` are those of types, shared code and enum values, which every section sees. `layout`
    is that of the state. The responses of `texting_skills` may be any text. `parameters` are the parts of
    mission parameters, by name: what may be set when the engine is started.
    """

    project: str
    cpp: str
    digest: str
    state_digest: str
    snippets: tuple[Span, ...]
    pieces: tuple[Piece, ...]
    origins: dict[int, tuple[Origin, ...]]
    locals: dict[str, tuple[Local, ...]] = {}
    observed: dict[str, tuple[Observed, ...]] = {}
    choosing_skills: frozenset[str] = frozenset()
    bounds: tuple[Bound, ...] = ()
    names: frozenset[str] = frozenset()
    layout: Layout = Layout()
    texting_skills: frozenset[str] = frozenset()
    parameters: dict[str, ParameterLeaf] = {}

    def locate(self, line: int, byte_column: int = 1) -> Span | None:
        """The document place of a place in the file; None for code that no document gave."""
        origins = self.origins.get(line)
        if not origins:
            return None
        column = column_of(self.cpp.split("\n")[line - 1], byte_column - 1)
        inside = [o for o in origins if o.column <= column <= o.column + o.length]
        if inside:
            return self.pieces[inside[0].piece - 1].locate(inside[0].line, column - inside[0].column + 1)
        return self.pieces[origins[0].piece - 1].locate(origins[0].line, 1)

    def place_of_loop(self, number: int) -> Span | None:
        """The document place of a loop that draws, by its number in the file."""
        found = re.search(rf"aos::DrawingLoop \w+\{{AOS, {number}\}}; ", self.cpp)
        if found is None:
            return None
        before = self.cpp[: found.end()].split("\n")
        return self.locate(len(before), len(before[-1].encode()) + 1)


def emit(program: Program) -> EmittedModel:
    cpp, origins = _laid_out(program)
    # Constraints without a cost leave the model what it is: what was solved for it goes on to fit.
    without = replace(program, constraints=())
    is_itself = not program.constraints or any(constraint.cost for constraint in program.constraints)
    return EmittedModel(
        project=program.project,
        cpp=cpp,
        digest=_sha256(cpp if is_itself else _laid_out(without)[0]),
        state_digest=_state_digest(program),
        snippets=tuple(piece.snippet.span for piece in program.pieces),
        pieces=program.pieces,
        origins=origins,
        locals={skill.name: skill.locals for skill in program.skills if skill.is_corrected},
        observed={skill.name: skill.observed for skill in program.skills if skill.observed},
        choosing_skills=frozenset(s.name for s in program.skills if s.possible_parameters is None),
        layout=layout_of(program),
        texting_skills=frozenset(skill.name for skill in program.skills if skill.has_text_response),
        names=_names_of_types(program) | program.shared_names | _values(program),
        parameters={leaf.name: leaf for leaf in program.leaves},
        bounds=tuple(
            Bound(constraint.never.snippet.code, constraint.probability) for constraint in program.constraints
        ),
    )


def _laid_out(program: Program) -> tuple[str, dict[int, tuple[Origin, ...]]]:
    """The file, and where each line of a piece went."""
    own_names = _own_names(program)
    text = _templates().get_template("model.cpp.jinja").render(
        program=program,
        its=own_names,
        version=__version__,
        title=_one_line(program.project),
        before="" if program.is_one_state else "const ",
        flags_type=_flags_type(program),
        has_tables=any(variable.axes for variable in program.variables),
        has_named_arrays=_has_named_arrays(program),
        has_drawing_loops=any("aos::DrawingLoop" in piece.text for piece in program.pieces),
        facts=_facts(program),
        special_states=[state for state in program.special_states if state.condition or state.section],
        watched_skills=_watched_skills(program),
        saved_variables=saved_variables(program),
        members_of=lambda objects: _members_of(objects, own_names["State"]),
        declares=lambda piece: bool(read_cpp(piece.snippet.code).declarations),
        par_names=lambda variable: ", ".join(f"par{n}" for n, _ in enumerate(variable.axes, 1)),
        MARK=MARK,
        END=END,
    )  # fmt: skip
    return put_code(re.sub(r"\n{3,}", "\n\n", text), program.pieces)


@cache
def _templates() -> Environment:
    environment = templates_in(Path(__file__).parent / "templates")
    environment.filters["literal"] = string_literal
    environment.filters["number"] = _number_literal
    environment.filters["skill_type"] = "aos_skill_{}".format
    return environment


# --- facts for the templates ---


def _names_of_types(program: Program) -> frozenset[str]:
    return frozenset(e.name for e in program.enums) | {compound.name for compound in program.compounds}


def _values(program: Program) -> frozenset[str]:
    return frozenset(value for enum in program.enums for value in enum.values)


def _own_names(program: Program) -> dict[str, str]:
    used_names = _names_of_types(program) | program.shared_names | _values(program)
    used_names |= {variable.name for variable in program.variables} | set(program.low_level_constants)
    names = {}
    for name in _OWN_NAMES:
        free = name
        while free in used_names:
            free += "_"
        names[name] = free
    return names


def _facts(program: Program) -> dict[str, bool]:
    return {
        "draws_defaults": program.draws_defaults,
        "has_rollout_policy": any(skill.rollout_policy for skill in program.skills),
        "has_state_heuristic": program.state_heuristic is not None,
        "has_corrections": any(skill.is_corrected for skill in program.skills),
        "constraints_look_ahead": any(constraint.looks_ahead for constraint in program.constraints),
        "has_costs": any(constraint.cost for constraint in program.constraints),
    }


def _flags_type(program: Program) -> str:
    flags = max((special.bit.bit_length() for special in program.special_states), default=0)
    return next((f"std::uint{bits}_t" for bits in (8, 16, 32, 64) if flags <= bits), "") if flags else ""


def _watched_skills(program: Program) -> list[Skill]:
    changes = program.extrinsic_changes
    return [skill for skill in program.skills if changes is not None and changes.uses(skill.name)]


def _members_of(objects: ObjectList, state: str) -> list[str]:
    return [f"&{state}::{name}" for name in objects.members]


def _has_named_arrays(program: Program) -> bool:
    types = [field.type for compound in program.compounds for field in compound.fields]
    types += [variable.type for variable in program.variables]
    return any("aos::Named<" in type for type in types)


def _state_digest(program: Program) -> str:
    flags = [(special.number, special.bit) for special in program.special_states if special.bit]
    compounds = [
        (c.name, [(field.name, _shape(field.type)) for field in c.fields]) for c in program.compounds
    ]
    enums = [(enum.name, enum.values) for enum in program.enums]
    variables = [(v.name, _shape(v.type)) for v in saved_variables(program)]
    return _sha256(json.dumps([enums, compounds, variables, flags]))


def _shape(type_text: str) -> str:
    """A type without the capacity of its vectors, which depends on all code."""
    return re.sub(r"(aos::Vector<.*), \d+>", r"\1>", type_text)


# --- literals ---


def _number_literal(number: float) -> str:
    """A C++ literal of exactly this number, which is finite."""
    return repr(float(number))


def _one_line(text: str) -> str:
    return re.sub(r"[^\x20-\x7e]|\\", "?", text)


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
