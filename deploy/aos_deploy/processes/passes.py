"""The names and passwords on the bus of a run, made when it starts and for this run alone."""

import os
import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from aos_deploy.runs.directory import RunDirectory
from aos_protocol.access import OPERATOR, WATCHER, Party
from aos_protocol.errors import DeployError, StorageError
from aos_runtime.bus.credentials import Credential, read_password, write_password

DICTIONARY = "router"
"""The name of the router's file: names and passwords of all, there until the router has read it."""


class Outsider(NamedTuple):
    """Somebody whom `aos-up` does not start. A `file` of the user's has the password, run after run."""

    party: Party
    file: Path | None = None


class Passes:
    """The parties of a run with their credentials, in the run directory's folder `credentials`.

    StorageError AOS701 if a file cannot be written, DeployError AOS801 if an outsider's is not his alone.
    """

    def __init__(
        self, run: RunDirectory, parties: Iterable[Party], outsiders: Iterable[Outsider] = ()
    ) -> None:
        self._folder = run.path / "credentials"
        outsiders = tuple(outsiders)
        own = [Party(name=role, role=role) for role in (OPERATOR, WATCHER)]
        self.parties = (*parties, *own, *(outsider.party for outsider in outsiders))
        lasting = {outsider.party.name: outsider.file for outsider in outsiders if outsider.file}
        self._passwords: dict[str, str] = {}
        try:
            self._folder.mkdir(mode=0o700, exist_ok=True)
            for party in self.parties:
                password = _lasting(lasting[party.name]) if party.name in lasting else secrets.token_hex(16)
                self._passwords[party.name] = write_password(self.file(party.name), password)
        except OSError as error:
            raise StorageError(f"{self._folder}: {error.strerror}") from error

    def file(self, name: str) -> Path:
        """The file with a party's password."""
        return self._folder / name

    def credential(self, name: str) -> Credential:
        """A party's name and password."""
        return Credential(name, self._passwords[name])

    @property
    def dictionary(self) -> Path:
        """The router's file, which is there only while a router starts."""
        return self._folder / DICTIONARY

    def write_dictionary(self) -> None:
        """Writes the router's file, for each start of one."""
        lines = "\n".join(f"{name}:{password}" for name, password in self._passwords.items())
        try:
            write_password(self.dictionary, lines)
        except OSError as error:
            raise StorageError(f"{self.dictionary}: {error.strerror}") from error


def _lasting(path: Path) -> str:
    """The password of an outsider: made once, and read from then on."""
    if not path.exists():
        return write_password(path)
    status = path.stat()
    if status.st_mode & 0o077 or status.st_uid != os.getuid():
        hint = f"Run chmod 600 {path}, or remove it: aos-up makes a new one"
        raise DeployError(f"others can read the credential {path}", hint=hint)
    return read_password(path)
