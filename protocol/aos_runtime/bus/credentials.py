"""Names and passwords on the bus, in files that only their user can read."""

from __future__ import annotations

import os
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from aos_protocol.errors import BusError
from aos_runtime.whole_file import PRIVATE, write_whole

FOLDER = "credentials"
"""The folder in a run directory with one file for each party, named like it."""

USER_VARIABLE, PASSWORD_FILE_VARIABLE = "AOS_USER", "AOS_PASSWORD_FILE"


class Credential(NamedTuple):
    """A party's name on the bus, and its password."""

    user: str
    password: str

    def __repr__(self) -> str:
        return f"Credential({self.user!r}, ...)"

    @classmethod
    def read(cls, user: str, path: str | Path) -> Credential:
        """The credential whose password stands in a file; BusError AOS605 if it cannot be read."""
        return cls(user, read_password(Path(path)))


def credential_of_environment(environment: Mapping[str, str] = os.environ) -> Credential | None:
    """The credential that AOS_USER and AOS_PASSWORD_FILE name, None where they name none."""
    user, path = environment.get(USER_VARIABLE), environment.get(PASSWORD_FILE_VARIABLE)
    return Credential.read(user, path) if user and path else None


def credential_of_run(run: Path, user: str) -> Credential | None:
    """The credential of a party of a run; None where the run has none."""
    path = run / FOLDER / user
    return Credential.read(user, path) if path.exists() else None


def read_password(path: Path) -> str:
    """The password in a file; BusError AOS605 if there is none."""
    try:
        password = path.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        message = f"the password file {path} cannot be read: {error}"
        hint = "It is made when the system starts, for the user who starts it"
        raise BusError(message, code="AOS605", hint=hint) from error
    if not password:
        raise BusError(f"the password file {path} is empty", code="AOS605")
    return password


def write_password(path: Path, password: str = "") -> str:
    """Writes a password, by default a new one, into a file that nobody else can read, and returns it."""
    password = password or secrets.token_hex(16)
    write_whole(path, f"{password}\n".encode(), mode=PRIVATE)
    return password
