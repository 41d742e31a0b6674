"""The environment's Python side: low-level types and constants."""

import msgspec

from aos_protocol.diagnostics import Span
from aos_protocol.documents.code import Snippet
from aos_protocol.documents.skill_model import Parameter


class LowLevelType(msgspec.Struct, frozen=True):
    """A Python-side structure for `anyValue` parameters."""

    name: str
    fields: tuple[Parameter, ...]
    span: Span


class LowLevelConstant(msgspec.Struct, frozen=True):
    """A Python-side value that an `anyValue` field may hold; in model code the name stands for `true`."""

    name: str
    type: str
    code: Snippet
    span: Span


class LowLevelDocument(msgspec.Struct, frozen=True):
    """The environment's Python side (AOS 1.x `EnvironmentGlue`)."""

    project: str
    span: Span
    types: tuple[LowLevelType, ...] = ()
    constants: tuple[LowLevelConstant, ...] = ()
