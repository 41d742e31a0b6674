"""The settings of a service process, and the place of its last word."""

from pathlib import Path

import msgspec

from aos_protocol.access import ROLES, SERVER, Party
from aos_runtime.bus.credentials import Credential

ROUTER_S = 10.0
"""The router may take this time to listen. Services start at the same time, and wait for it as long."""


class ServiceSettings(msgspec.Struct, frozen=True, kw_only=True):
    """The settings that every service has; each adds its own. `run_dir` is absolute.

    The password for the bus stands in `password_file`; without one the router is open to everybody. The
    router is waited for `router_s`; whoever supervises both may end the service before that.
    """

    robot: str
    service: str
    endpoint: str
    run_dir: str
    password_file: str = ""
    router_s: float = ROUTER_S

    @property
    def party(self) -> Party:
        """The service as the bus knows it."""
        return Party(name=self.service, role=self.service if self.service in ROLES else SERVER)

    @property
    def credential(self) -> Credential | None:
        """Its name and password; BusError AOS605 if the file cannot be read."""
        return Credential.read(self.service, self.password_file) if self.password_file else None


def fault_path(run_dir: str | Path, service: str) -> Path:
    """Returns the path where a service leaves the fault that ended it, a JSON `Fault`."""
    return Path(run_dir) / "faults" / f"{service}.json"
