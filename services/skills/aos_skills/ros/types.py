"""Types of ROS messages, and values of them as CDR: the only file that imports rosbags.

A value is plain data: a dict of fields. Two things that rosbags does differently from ROS 2 are put right
here, because with either of them the key expressions of ROS 2 over Zenoh never match, without an error: it
names the messages of services `package/srv/msg/X`, and it hashes the type `char` as a character of its own
where ROS 2 hashes `uint8`.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from aos_protocol.errors import DeployError, SkillError
from aos_runtime.distribution import pip_install
from aos_skills.ros import definitions

try:
    from rosbags.interfaces import Nodetype
    from rosbags.serde import SerdeError
    from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
except ImportError as error:  # pragma: no cover - the extra is not installed
    raise DeployError(
        "the adapters for ROS 2 need the package rosbags", code="AOS805", hint=f"Run {pip_install('ros')}"
    ) from error

DISTRIBUTIONS = tuple(
    store.value.removeprefix("ros2_") for store in Stores if store.value.startswith("ros2_")
)
"""Releases of ROS 2 whose common messages are known without files."""

NO_HASH = "TypeHashNotSupported"
_WITHOUT_HASHES = ("dashing", "eloquent", "foxy", "galactic", "humble")

_FILLER = "structure_needs_at_least_one_member"
"""The member that ROS 2 gives to empty messages, one byte on the wire."""

_BYTE = (Nodetype.BASE, ("uint8", 0))
_DTYPES = {"bool": np.bool_, "byte": np.uint8, "float32": np.float32, "float64": np.float64} | {
    f"{sign}int{bits}": np.dtype(f"{sign}int{bits}") for sign in ("", "u") for bits in (8, 16, 32, 64)
}


class Field(NamedTuple):
    """A field of a message: `base` is a basic type of ROS, or the full name of another message.

    `length` says how many values it holds: None for one, (n, n) for an array, (0, n) for a sequence, whose
    n is 0 without a bound. `text_bound` is the bound of a string, or 0.
    """

    name: str
    base: str
    is_message: bool
    length: tuple[int, int] | None
    text_bound: int


class RosTypes:
    """The messages of one distribution, those that come with AOS, and the user's.

    Names are full, `package/kind/Name`. Files are read when a type is first used. DeployError AOS806 names
    the file that is missing.
    """

    def __init__(self, distribution: str = "jazzy", interfaces: Iterable[Path] = ()) -> None:
        if distribution not in DISTRIBUTIONS:
            message = f"{distribution!r} is not a distribution of ROS 2 that is known here"
            raise DeployError(message, code="AOS106", hint=f"Known are {', '.join(DISTRIBUTIONS)}")
        self._store = get_typestore(Stores(f"ros2_{distribution}"))
        self._store.fielddefs = {
            name: (constants, [_with_uint8(field) for field in fields])
            for name, (constants, fields) in self._store.fielddefs.items()
        }
        self._hashes: dict[str, str] = {}
        self._has_hashes = distribution not in _WITHOUT_HASHES
        self._files = definitions.definitions_in((*interfaces, definitions.SHIPPED))

    def encoded(self, type_name: str, value: Mapping[str, Any]) -> bytes:
        """The value as CDR with its four bytes of encapsulation.

        Fields that are left out are zero, empty or false. SkillError AOS502 for a field that the type does
        not have, or a value that does not fit.
        """
        self._know(type_name)
        message = self._message(type_name, value, "")
        return bytes(self._store.serialize_cdr(message, type_name, little_endian=True))

    def decoded(self, type_name: str, payload: bytes) -> dict[str, Any]:
        """The value in a CDR payload; SkillError AOS508 if it is not one of this type."""
        self._know(type_name)
        try:
            message = self._store.deserialize_cdr(payload, type_name)
        except (SerdeError, IndexError) as error:
            hint = "Is the sender's definition of this type the one that is given here?"
            raise SkillError(f"what came is no {type_name}: {error}", code="AOS508", hint=hint) from error
        return self._plain(type_name, message)

    def hash(self, type_name: str) -> str:
        """ROS 2's hash of a type, `RIHS01_` and 64 digits; of a service for `package/srv/Name`.

        Distributions before Iron have none, and `NO_HASH` in its place.
        """
        if not self._has_hashes:
            self._know(type_name)
            return NO_HASH
        if type_name not in self._hashes:
            self._know(type_name)
            self._hashes[type_name] = self._store.hash_rihs01(type_name)
        return self._hashes[type_name]

    def check(self, type_name: str) -> None:
        """Raises DeployError AOS806 if the type, or one that it uses, is not known."""
        self._know(type_name)

    def fields(self, type_name: str) -> tuple[Field, ...]:
        """The fields of a message in their order, without the filler of empty ones."""
        self._know(type_name)
        return tuple(
            _field(name, description)
            for name, description in self._store.fielddefs[type_name][1]
            if name != _FILLER
        )

    # --- types ---

    def _know(self, type_name: str, used_by: str = "") -> None:
        """Reads the files that define a type and all that it uses."""
        if type_name in self._store.fielddefs:
            return
        name = definitions.interface_name(type_name, "msg")
        file_name = next((known for known in _defining(name) if known in self._files), None)
        if file_name is None:
            raise definitions.missing_interface(next(iter(_defining(name))), used_by)
        path = self._files[file_name]
        found: dict[str, Any] = {}
        for definition in definitions.messages_of(file_name, path.read_text(encoding="utf-8")):
            parsed_as = f"{definition.name.package}/msg/{definition.name.name}"
            try:
                parsed = get_types_from_msg(definition.text, parsed_as)
            except TypesysError as error:
                raise DeployError(
                    f"{path} is not an interface file of ROS: {str(error).splitlines()[-1]}", code="AOS104"
                ) from error
            constants, fields = parsed[parsed_as]
            found[str(definition.name)] = (
                constants,
                [_with_uint8(_renamed(field)) for field in fields] or [(_FILLER, _BYTE)],
            )
        # What it uses must be there before; a service's event refers to messages of the same file.
        for _, fields in found.values():
            for used in _used(fields):
                if used not in found:
                    self._know(used, used_by=str(path))
        self._store.register(found)
        if type_name not in self._store.fielddefs:
            raise definitions.missing_interface(name, used_by)

    # --- values ---

    def _message(self, type_name: str, value: Any, where: str) -> Any:
        if not isinstance(value, Mapping):
            raise _misfit(where, type_name, value)
        fields = self._store.fielddefs[type_name][1]
        unknown = value.keys() - {name for name, _ in fields}
        if unknown:
            names = ", ".join(name for name, _ in fields if name != _FILLER) or "none"
            raise SkillError(
                f"{type_name} has no field {where}{sorted(unknown)[0]}", hint=f"Its fields are {names}"
            )
        parts = [self._part(field[1], value.get(field[0]), where + field[0]) for field in fields]
        return self._store.types[type_name](*parts)

    def _part(self, description: Any, value: Any, where: str) -> Any:
        kind, rest = description
        if kind == Nodetype.BASE:
            return _scalar(rest[0], value, where)
        if kind == Nodetype.NAME:
            return self._message(rest, {} if value is None else value, f"{where}.")
        (inner_kind, inner), size = rest
        items = _items(value, where)
        if kind == Nodetype.ARRAY and value is None:
            items = [None] * size
        if (kind == Nodetype.ARRAY and len(items) != size) or (size and len(items) > size):
            bound = "exactly" if kind == Nodetype.ARRAY else "at most"
            raise SkillError(f"{where} holds {bound} {size} values, not {len(items)}")
        if inner_kind == Nodetype.BASE and inner[0] != "string":
            numbers = [_scalar(inner[0], item, f"{where}[{at}]") for at, item in enumerate(items)]
            return np.array(numbers, dtype=_DTYPES[inner[0]])
        return [self._part((inner_kind, inner), item, f"{where}[{at}]") for at, item in enumerate(items)]

    def _plain(self, type_name: str, message: Any) -> dict[str, Any]:
        return {
            name: self._plain_part(description, getattr(message, name))
            for name, description in self._store.get_msgdef(type_name).fields
            if name != _FILLER
        }

    def _plain_part(self, description: Any, value: Any) -> Any:
        kind, rest = description
        if kind == Nodetype.NAME:
            return self._plain(rest, value)
        if kind == Nodetype.BASE:
            return value
        (inner_kind, inner), _ = rest
        if inner_kind == Nodetype.NAME:
            return [self._plain(inner, item) for item in value]
        return value.tolist() if isinstance(value, np.ndarray) else list(value)


def _defining(name: definitions.InterfaceName) -> Iterator[definitions.InterfaceName]:
    """The files in which a message may be defined: `X_SendGoal_Request` is made from the action `X`."""
    short = name.name
    if name.kind == "action":
        for suffix in ("_Request", "_Response", "_Event"):
            short = short.removesuffix(suffix)
        for suffix in ("_SendGoal", "_GetResult", "_FeedbackMessage", "_Goal", "_Result", "_Feedback"):
            short = short.removesuffix(suffix)
    if name.kind == "srv":
        for suffix in ("_Request", "_Response", "_Event"):
            short = short.removesuffix(suffix)
    yield name._replace(name=short)
    if short != name.name:
        yield name


def _field(name: str, description: Any) -> Field:
    kind, rest = description
    length = None
    if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        length = (rest[1] if kind == Nodetype.ARRAY else 0, rest[1])
        kind, rest = rest[0]
    if kind == Nodetype.NAME:
        return Field(name, rest, True, length, 0)
    return Field(name, rest[0], False, length, rest[1])


def _renamed(field: Any) -> Any:
    """A field whose type, if rosbags calls it `package/srv/msg/X`, is `package/srv/X`."""
    name, description = field
    return name, _mapped(description, lambda base: base, lambda used: used.replace("/srv/msg/", "/srv/"))


def _with_uint8(field: Any) -> Any:
    """A field whose type, if it is `char`, is `uint8`, as in ROS 2."""
    name, description = field
    return name, _mapped(
        description, lambda base: ("uint8", 0) if base[0] == "char" else base, lambda used: used
    )


def _mapped(description: Any, base: Any, named: Any) -> Any:
    kind, rest = description
    if kind == Nodetype.BASE:
        return kind, base(rest)
    if kind == Nodetype.NAME:
        return kind, named(rest)
    inner, size = rest
    return kind, (_mapped(inner, base, named), size)


def _used(fields: Iterable[Any]) -> Iterator[str]:
    for _, (kind, rest) in fields:
        if kind == Nodetype.NAME:
            yield rest
        elif kind != Nodetype.BASE and rest[0][0] == Nodetype.NAME:
            yield rest[0][1]


def _items(value: Any, where: str) -> list[Any]:
    if value is None:
        return []
    if isinstance(value, (str, Mapping)) or not hasattr(value, "__iter__"):
        raise _misfit(where, "list", value)
    return list(value)


def _scalar(base: str, value: Any, where: str) -> Any:
    """A value of a basic type; SkillError AOS502 if it is none."""
    if base == "string":
        if value is None:
            return ""
        if isinstance(value, str):
            return value
    elif base == "bool":
        if value is None or isinstance(value, (bool, np.bool_)) or value in (0, 1):
            return bool(value)
    elif base.startswith("float"):
        if value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)):
            return float(value or 0)
    elif value is None or (isinstance(value, (int, float)) and math.isfinite(value) and value == int(value)):
        number = int(value or 0)
        limits = np.iinfo(_DTYPES[base])
        if limits.min <= number <= limits.max:
            return number
    raise _misfit(where, base, value)


def _misfit(where: str, type_name: str, value: Any) -> SkillError:
    place = where.rstrip(".") or "the value"
    return SkillError(f"{place} is a {type_name} and cannot be {value!r}")
