"""The base of every message, the envelope around it, and the answer to a fault."""

import msgspec

from aos_protocol.diagnostics import Diagnostic


class Message(msgspec.Struct, frozen=True, omit_defaults=True):
    """Base of every structure on the bus."""


class Envelope(Message, frozen=True):
    """Around every payload. `version` is major.minor; another major is refused. `body` is encoded apart."""

    version: str
    stamp_ns: int
    sender: str
    body: msgspec.Raw


class Fault(Message, frozen=True):
    """An error reply."""

    code: str
    message: str
    hint: str = ""
    diagnostics: tuple[Diagnostic, ...] = ()
