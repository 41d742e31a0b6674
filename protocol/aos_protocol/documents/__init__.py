"""The documents as typed data: one model for every dialect.

Written by the registry's readers, sent over the bus, read by the solver's lowering and the middleware's
emission. Nothing here is interpreted: code stays text, in `Snippet`, with the place every line came from.
Names follow the field (skill, response, local variable); the documents' own spellings stay in the readers.

Source: the paper, sections 3.2.1 and 3.2.2; the AOS documentation manual, versions 1.2 and 2.0.
"""

from __future__ import annotations

from aos_protocol.documents.code import Assignment, Iteration, Snippet, TemporaryVariable
from aos_protocol.documents.environment import (
    MAX_HORIZON,
    CompoundType,
    EnumType,
    Environment,
    Field,
    MonitorModel,
    SpecialState,
    StateVariable,
)
from aos_protocol.documents.low_level import LowLevelConstant, LowLevelDocument, LowLevelType
from aos_protocol.documents.mapping import (
    ACTIVATION_KINDS,
    NO_ACTIVATION,
    AbstractionMapping,
    Activation,
    ActivationField,
    Import,
    LocalSource,
    LocalVariable,
    LowLevelAssignment,
    ResponseRule,
)
from aos_protocol.documents.project import Constraint, MissionValue, Project, Skill
from aos_protocol.documents.skill_model import Parameter, SkillModel

__all__ = [
    "ACTIVATION_KINDS",
    "MAX_HORIZON",
    "NO_ACTIVATION",
    "AbstractionMapping",
    "Activation",
    "ActivationField",
    "Assignment",
    "CompoundType",
    "Constraint",
    "EnumType",
    "Environment",
    "Field",
    "Import",
    "Iteration",
    "LocalSource",
    "LocalVariable",
    "LowLevelAssignment",
    "LowLevelConstant",
    "LowLevelDocument",
    "LowLevelType",
    "MissionValue",
    "MonitorModel",
    "Parameter",
    "Project",
    "ResponseRule",
    "Skill",
    "SkillModel",
    "Snippet",
    "SpecialState",
    "StateVariable",
    "TemporaryVariable",
]
