"""The meanings of a project's names: types, enum values, state variables, skills."""

from __future__ import annotations

import re
from collections.abc import Mapping

import msgspec

from aos_language.assembly import Assembly
from aos_language.cpp.shared import NO_SHARED_CODE, SharedCode
from aos_language.document_code import shared_code_of
from aos_language.reading.document import array_type
from aos_protocol import documents

NUMBERS = frozenset({"bool", "double", "float", "int"})
PRIMITIVES = NUMBERS | {"anyValue", "string"}

_LIBRARY_TYPES = frozenset({
    "array", "auto", "bool", "char", "const", "deque", "double", "float", "int", "int16_t", "int32_t",
    "int64_t", "int8_t", "list", "long", "map", "pair", "set", "short", "signed", "size_t", "std", "string",
    "tuple", "uint16_t", "uint32_t", "uint64_t", "uint8_t", "unordered_map", "unordered_set", "unsigned",
    "vector",
})  # fmt: skip


class ValueType(msgspec.Struct, frozen=True):
    """The type of an expression as far as the documents say: a type's name, and whether it is a container.

    `index_enum` is the enum that an array is indexed by.
    """

    name: str
    is_container: bool = False
    index_enum: str = ""

    @classmethod
    def of(cls, type_name: str) -> ValueType:
        """The type of a field or a name."""
        return cls(*array_type(type_name))


class Scope(msgspec.Struct, frozen=True):
    """The environment's names, those of its shared code, and the skills' parameters."""

    enums: Mapping[str, documents.EnumType]
    compounds: Mapping[str, documents.CompoundType]
    variables: Mapping[str, documents.StateVariable]
    enum_values: Mapping[str, str]
    skills: Mapping[str, documents.SkillModel]
    low_level_names: frozenset[str]
    low_level_types: frozenset[str]
    low_level: documents.LowLevelDocument | None
    has_environment: bool
    is_one_state_model: bool
    has_unread_files: bool = False
    shared: SharedCode = NO_SHARED_CODE
    shared_mapping_code: documents.Snippet | None = None

    @classmethod
    def of(cls, assembly: Assembly) -> Scope:
        environment, low_level = assembly.environment, assembly.low_level
        enums = environment.enums if environment else ()
        compounds = environment.compounds if environment else ()
        variables = environment.variables if environment else ()
        return cls(
            enums={enum.name: enum for enum in enums},
            compounds={compound.name: compound for compound in compounds},
            # The first of a name. The name `my-count` is told already, and not its uses `state.my`.
            variables={re.split(r"\W", variable.name)[0]: variable for variable in reversed(variables)},
            enum_values={value: enum.name for enum in enums for value in enum.values},
            skills=assembly.models,
            low_level_names=frozenset(c.name for c in low_level.constants) if low_level else frozenset(),
            low_level_types=frozenset(t.name for t in low_level.types) if low_level else frozenset(),
            low_level=low_level,
            has_environment=environment is not None,
            is_one_state_model=environment is not None and environment.is_one_state_model,
            has_unread_files=assembly.has_unread_files,
            shared=shared_code_of(environment) if environment is not None else NO_SHARED_CODE,
            shared_mapping_code=environment.shared_mapping_code if environment is not None else None,
        )

    @property
    def type_names(self) -> tuple[str, ...]:
        return (*sorted(PRIMITIVES), *self.enums, *self.compounds)

    def unknown_type_name(self, type_name: str) -> str:
        """The first name in a type that means nothing; empty where all do."""
        known = PRIMITIVES | self.enums.keys() | self.compounds.keys()
        if type_name in known:
            return ""
        names = names_in_type(type_name)
        if len(names) == 1 and names[0] == type_name and type_name not in _LIBRARY_TYPES - {"std"}:
            return type_name
        return next((name for name in names if name not in known | _LIBRARY_TYPES), "")

    def state_member(self, name: str) -> ValueType | None:
        """The type of `state.<name>`: a variable, or one of the lists that every compound and enum has."""
        if variable := self.variables.get(name):
            is_container = variable.is_array or bool(variable.key_types)
            return ValueType(variable.type, is_container, variable.index_enum)
        for suffix in ("ObjectsForActions", "Objects"):
            owner = name.removesuffix(suffix)
            if owner != name and (owner in self.compounds or owner in self.enums):
                return ValueType(owner, is_container=True)
        return None

    def lacks_objects(self, name: str) -> bool:
        """Returns whether a compound type has no variable for lists of objects and for loops."""
        own = (v for v in self.variables.values() if v.type == name)
        return name in self.compounds and not any(
            not (v.is_array or v.is_constant or v.key_types) for v in own
        )

    def state_member_names(self) -> tuple[str, ...]:
        return (*self.variables, *(f"{name}Objects" for name in (*self.compounds, *self.enums)))


def names_in_type(type_name: str) -> list[str]:
    """The names a C++ type is made of, without numbers."""
    return re.findall(r"[A-Za-z_]\w*", type_name)
