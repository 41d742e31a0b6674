"""The values that an adapter gives, made ready for the bus."""

from collections.abc import Mapping
from typing import Any

import msgspec

from aos_protocol.codec import MAX_BYTES
from aos_protocol.errors import SkillError
from aos_runtime.plain_data import plain_from

_encoder = msgspec.msgpack.Encoder()


def sendable(fields: Mapping[str, Any], what: str) -> dict[str, Any]:
    """The fields as plain data, such as a list for a numpy array.

    SkillError AOS510 names the field that the bus cannot carry; `what` says of what it is.
    """
    plain: dict[str, Any] = {}
    size_bytes = 0
    for name, value in fields.items():
        try:
            plain[str(name)] = plain_from(value)
            size_bytes += len(_encoder.encode(plain[str(name)]))
        except Exception as error:  # Whatever a property of somebody's class raises.
            raise SkillError(
                f"the field {name} of {what} cannot be sent: {error}",
                code="AOS510",
                hint="Give numbers, texts, bytes, lists and dicts of them, or numpy's arrays",
            ) from error
    if size_bytes > MAX_BYTES:
        hint = "Give less, such as a smaller picture"
        message = f"{what} has {size_bytes} bytes, and the bus carries {MAX_BYTES}"
        raise SkillError(message, code="AOS510", hint=hint)
    return plain
