"""Bytes to messages and back: msgpack in an envelope, with a size limit and a version check.

Every failure to decode is a BusError with code AOS602 (malformed), AOS603 (another protocol version) and
names the field; nothing else escapes, whatever the bytes are.
"""

from functools import cache
from typing import Any, TypeVar

import msgspec

from aos_protocol.errors import AosError, BusError, error_from_code
from aos_protocol.messages import Envelope, Fault, Message

PROTOCOL_VERSION = "1.0"
MAX_BYTES = 16 * 1024 * 1024

UNREADABLE = (msgspec.MsgspecError, RecursionError, UnicodeDecodeError)
"""The errors of msgspec's decoders. The last two come of nested values, and of text that is no UTF-8."""

_ENVELOPE = "A payload is a MessagePack map of version, stamp_ns, sender and body: see docs/protocol.md"
_BODY = "The envelope can be read, its body cannot: docs/protocol.md names the messages with their fields"
_TOO_LARGE = "Send only what mappings read, and pictures by the names of their files"

M = TypeVar("M", bound=Message)

_encoder = msgspec.msgpack.Encoder()


class TooLargeError(BusError):
    """A message that was not sent, since it is larger than MAX_BYTES."""

    code = "AOS602"


def encode(message: Message, *, sender: str, stamp_ns: int) -> bytes:
    """The payload for the bus; TooLargeError if it is larger than MAX_BYTES."""
    body = msgspec.Raw(_encoder.encode(message))
    payload = _encoder.encode(Envelope(PROTOCOL_VERSION, stamp_ns, sender, body))
    if len(payload) > MAX_BYTES:
        text = f"a {type(message).__name__} of {len(payload)} bytes is too large for the bus"
        raise TooLargeError(text, hint=f"The limit is {MAX_BYTES} bytes")
    return payload


def open_envelope(payload: bytes) -> Envelope:
    """The envelope, its body still encoded."""
    if len(payload) > MAX_BYTES:
        text = f"a message of {len(payload)} bytes is too large: the bus carries {MAX_BYTES}"
        raise BusError(text, code="AOS602", hint=_TOO_LARGE)
    envelope = _checked_decode(payload, Envelope)
    if envelope.version.split(".")[0] != PROTOCOL_VERSION.split(".")[0]:
        message = f"{envelope.sender} speaks protocol {envelope.version}, this is {PROTOCOL_VERSION}"
        raise BusError(message, code="AOS603", hint="Install the same AOS version on both sides")
    return envelope


def decode(payload: bytes, kind: type[M]) -> M:
    """The message inside a payload."""
    return _checked_decode(open_envelope(payload).body, kind)


def encode_fault(error: AosError, *, sender: str, stamp_ns: int) -> bytes:
    """An error reply."""
    fault = Fault(error.code, error.message, error.hint, error.diagnostics)
    return encode(fault, sender=sender, stamp_ns=stamp_ns)


def decode_fault(payload: bytes) -> AosError:
    """The exception that an error reply stands for."""
    fault = decode(payload, Fault)
    return error_from_code(fault.code, fault.message, hint=fault.hint, diagnostics=fault.diagnostics)


@cache
def _decoder(kind: type[Any]) -> msgspec.msgpack.Decoder[Any]:
    return msgspec.msgpack.Decoder(kind)


def _checked_decode(payload: bytes | msgspec.Raw, kind: type[M]) -> M:
    try:
        message: M = _decoder(kind).decode(payload)
    except UNREADABLE as error:
        hint = _ENVELOPE if kind is Envelope else _BODY
        raise BusError(f"no {kind.__name__}: {error}", code="AOS602", hint=hint) from error
    return message
