"""The sandbox from the side of who starts commands: whether this kernel can do it, and who does without.

A machine whose kernel cannot confine runs documents only where somebody has said that they are trusted.
"""

import logging
import os
from functools import cache

import msgspec

from aos_protocol.errors import DeployError
from aos_runtime.sandbox import landlock, seccomp

_log = logging.getLogger("aos.sandbox")

TRUST_VARIABLE = "AOS_TRUST"
"""Services inherit from aos-up, and commands from the shell, that documents are trusted: `documents`."""
_TRUSTED = "documents"

_HINT = (
    "If you trust the documents as programs of your own, write trust: documents in the deploy file, or give "
    "the option --trust-documents"
)


class Support(msgspec.Struct, frozen=True):
    """The version of Landlock that the kernel has, 0 for none, and what is missing for a sandbox: no words
    where nothing is."""

    landlock: int
    missing: tuple[str, ...] = ()

    @property
    def is_whole(self) -> bool:
        return not self.missing


@cache
def sandbox_support() -> Support:
    """Asks the kernel, once in a process."""
    missing = []
    known = 0
    try:
        known = landlock.version()
    except OSError as error:
        missing.append(landlock.why_missing(error))
    if reason := seccomp.why_missing(os.uname().machine):
        missing.append(reason)
    return Support(known, tuple(missing))


def trust_documents() -> None:
    """Has this process, and what it starts, run documents also where the kernel cannot confine them."""
    os.environ[TRUST_VARIABLE] = _TRUSTED


def trusts_documents() -> bool:
    """Says whether documents may run without a whole sandbox; where there is one, they run in it."""
    return os.environ.get(TRUST_VARIABLE) == _TRUSTED


def sandbox_text() -> str:
    """Says in words what confines the code of documents here."""
    support = sandbox_support()
    if support.is_whole:
        return f"Landlock {support.landlock} and seccomp confine the documents' code"
    why = "; ".join(support.missing)
    return f"the documents' code is trusted and not wholly confined: {why}"


@cache
def _say_once(text: str) -> None:
    _log.warning("%s", text)


def require_sandbox() -> None:
    """Raises DeployError AOS805 where the kernel cannot confine documents that nobody has said to trust.

    The log of each process tells once that it goes on without.
    """
    support = sandbox_support()
    if support.is_whole:
        return
    if trusts_documents():
        _say_once(sandbox_text())
        return
    raise DeployError(
        f"code of documents cannot be confined here: {'; '.join(support.missing)}", code="AOS805", hint=_HINT
    )
