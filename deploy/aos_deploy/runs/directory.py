"""The directory of one run: where every service writes, and what remains of a mission.

runs/20260105T101500Z-armadillo/
  run.json         what runs here: endpoint, robot, deploy file, seed, process ids
  deploy.json      the deploy file, with what it leaves to defaults
  solver.policy    the policy file, where decisions come from one
  bus              the socket of the bus, where the path is short enough for one
  settings/        what each service was started with
  credentials/     the passwords for the bus, one file for each who may be on it
  logs/            what each service said
  faults/          why a service ended, if it ended by a fault
  journal.db       the mission: decisions and outcomes
  summary.json     how it ended; its absence means that it runs, was killed, or found no space for it
  missions/3/      journal and summary of the third mission, in a system that stays
"""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, BinaryIO

import msgspec

from aos_deploy.runs.bus_socket import place_of_socket, remove_socket
from aos_deploy.runs.record import RunRecord, Summary
from aos_protocol.codec import UNREADABLE
from aos_protocol.errors import BusError, DeployError, StorageError
from aos_protocol.messages import Fault
from aos_protocol.spelling import did_you_mean_path
from aos_runtime.disk.folder_lock import locked_folder
from aos_runtime.disk.mission_folders import mission_folder, mission_folders
from aos_runtime.failpoints import reach
from aos_runtime.processes.settings import fault_path
from aos_runtime.whole_file import PRIVATE, write_whole

LATEST = "latest"
"""The link to the newest run, in the folder of runs."""

_TOLD_LOG_LINES = 8

_ANEW = ("endpoint", "password_file", "dictionary", "parties", "ros2")
"""The settings that a run which goes on does not keep."""


class RunDirectory:
    """Paths of one run, and what aos-up itself keeps there."""

    def __init__(self, path: Path, named: Path | None = None) -> None:
        self.path = path
        self.named = named or path
        """The name that a user gives it: the file of `aos export` that it is from, else its path."""
        self.keeps_settings = False
        """True where services have the settings that they had when the run was started."""
        self._lock: int | None = None
        self._socket: Path | None = None

    @classmethod
    def create(cls, runs: Path, robot: str, now_ns: int) -> RunDirectory:
        """A new directory below `runs`, locked while it is used; DeployError AOS805 if that cannot be."""
        stamp = datetime.fromtimestamp(now_ns / 1e9, UTC).strftime("%Y%m%dT%H%M%SZ")
        try:
            path = _made(runs, f"{stamp}-{robot}")
            for folder in ("settings", "credentials", "logs", "faults"):
                (path / folder).mkdir(mode=0o700)
            created = cls(path)
            created._lock = locked_folder(path, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            message = f"no run directory can be made in {runs}: {error.strerror}"
            raise DeployError(message, code="AOS805", hint="Name another folder with --runs") from error
        return created

    def hold(self) -> bool:
        """Takes the lock until `close`; False while somebody else has it, since the run goes on."""
        try:
            self._lock = locked_folder(self.path, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
        return True

    def close(self) -> None:
        """The run is over. A process that is killed lets go of the lock as well."""
        if self._socket is not None:
            remove_socket(self._socket)
            self._socket = None
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def make_endpoint(self) -> str:
        """The endpoint of a socket that nobody else can reach; DeployError AOS805 if it has no place.

        What it needs is removed by `close`.
        """
        try:
            self._socket = place_of_socket(self.path)
        except OSError as error:
            hint = "Name a folder with a shorter path with --runs"
            raise DeployError(f"the bus has no place: {error.strerror}", code="AOS805", hint=hint) from error
        return f"unixsock-stream/{self._socket}"

    @classmethod
    def latest(cls, runs: Path) -> RunDirectory:
        """The newest run below `runs`; BusError AOS605 if there is none."""
        if not (runs / LATEST / "run.json").is_file():
            hint = "Start one with aos-up, or name a run directory or an endpoint"
            raise BusError(f"there is no run in {runs}", code="AOS605", hint=hint)
        return cls((runs / LATEST).resolve())

    def write_settings(self, service: str, settings: dict[str, Any]) -> Path:
        """Writes the settings of a service, and returns their path; StorageError AOS701 if that cannot be.

        In a run that goes on a service keeps its settings, but for where the bus is and who it is there.
        """
        path = self.path / "settings" / f"{service}.json"
        with _kept(path):
            if self.keeps_settings and path.exists():
                before = msgspec.json.decode(path.read_bytes())
                settings = before | {name: settings[name] for name in _ANEW if name in settings}
            write_whole(path, _pretty(settings), mode=PRIVATE)
        return path

    def keep_inputs(self, deploy_file: Any, policy: Path | None) -> None:
        """Keeps what may change outside: the deploy file as it was read, and the policy file.

        StorageError AOS701 if they cannot be written, or the policy file cannot be read.
        """
        with _kept(self.path / "deploy.json"):
            write_whole(self.path / "deploy.json", _pretty(deploy_file), mode=PRIVATE)
        if policy is not None:
            with _kept(self.policy):
                shutil.copyfile(policy, self.policy)

    @property
    def policy(self) -> Path:
        """The copy of the policy file; there is none where decisions are searched for."""
        return self.path / "solver.policy"

    def log(self, service: str) -> Path:
        return self.path / "logs" / f"{service}.log"

    def open_log(self, service: str) -> BinaryIO:
        """The log, for a process to write to its end; StorageError AOS701 if it cannot be opened."""
        path = self.log(service)
        with _kept(path):
            return path.open("ab")

    def last_log_lines(self, service: str) -> list[str]:
        try:
            text = self.log(service).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return []
        return text.splitlines()[-_TOLD_LOG_LINES:]

    def fault(self, service: str) -> Fault | None:
        """The fault a service has left, if it has."""
        try:
            return msgspec.json.decode(fault_path(self.path, service).read_bytes(), type=Fault)
        except (OSError, *UNREADABLE):
            return None

    def forget_fault(self, service: str) -> None:
        """Puts the fault aside of a service that is started again: its log has it."""
        with suppress(OSError):
            fault_path(self.path, service).unlink()

    def write_record(self, record: RunRecord) -> None:
        """Writes the record by which the run can be found from now on, and lets `latest` name it.

        The record may be written anew. StorageError AOS701 if it cannot be; an older one stays as it is.
        """
        path = self.path / "run.json"
        is_known = path.exists()
        _write_whole(path, _pretty(record), "up.record")
        if is_known:
            return
        link = self.path.with_name(f".{LATEST}-{self.path.name}")
        with _kept(link):
            link.symlink_to(self.path.name)
            link.replace(self.path.with_name(LATEST))

    def read_record(self) -> RunRecord:
        """Returns the record; DeployError AOS901 if this is not a run directory."""
        path = self.path / "run.json"
        try:
            return msgspec.json.decode(path.read_bytes(), type=RunRecord)
        except OSError as error:
            run, hint = self.path.parent.parent, did_you_mean_path(self.path) or "`aos runs` lists the runs"
            if (self.path / "runs").is_dir():
                hint = f"Its runs are in {self.path / 'runs'}"
            if self.path in mission_folders(run).values():
                hint = f"Name {run} instead, and --mission {self.path.name} where the command takes it"
            raise DeployError(
                f"{self.path} is not a run directory: {path.name} cannot be read, {error.strerror}",
                code="AOS901",
                hint=hint,
            ) from error
        except UNREADABLE as error:
            raise DeployError(f"{path}: {error}", code="AOS901") from error

    def write_summary(self, summary: Summary, number: int = 0) -> None:
        """Writes the summary of the run, or of a mission in a system that stays.

        All of it, or nothing and StorageError AOS701.
        """
        _write_whole(mission_folder(self.path, number) / "summary.json", _pretty(summary), "up.summary")

    def read_summary(self, number: int = 0) -> Summary | None:
        """Returns the summary of the run, or of the mission of this number in a system that stays.

        None while the mission runs, or if aos-up was killed.
        """
        path = mission_folder(self.path, number) / "summary.json"
        try:
            return msgspec.json.decode(path.read_bytes(), type=Summary)
        except (OSError, *UNREADABLE):
            return None

    @property
    def is_running(self) -> bool:
        """True while its aos-up is still there and others can talk to its services.

        A process id would not tell: in a new container, say, it may be that of another program.
        """
        if not (self.path / "run.json").is_file() or self.read_summary() is not None:
            return False
        return self.is_held

    @property
    def is_held(self) -> bool:
        """True while a process uses the directory: also of a run that begins, and cannot be found yet."""
        try:
            os.close(locked_folder(self.path, fcntl.LOCK_SH | fcntl.LOCK_NB))
        except OSError:
            return True
        return False

    def interrupt(self, pid: int) -> bool:
        """Ends the run in order, as Ctrl-C does. False where no process of this number uses the directory."""
        try:
            handle = os.pidfd_open(pid)
        except OSError:
            return False
        try:
            files = Path(f"/proc/{pid}/fd").iterdir()
            if not any(each.exists() and each.samefile(self.path) for each in files):
                return False
            signal.pidfd_send_signal(handle, signal.SIGINT)
        except OSError:
            return False
        finally:
            os.close(handle)
        return True


def _write_whole(path: Path, content: bytes, place: str) -> None:
    """Writes a file of the run that others read. `place` is a failpoint."""
    with _kept(path):
        write_whole(path, content, before_rename=lambda: reach(f"{place}.before"))
    reach(f"{place}.after")


@contextmanager
def _kept(path: Path) -> Iterator[None]:
    """Turns the system's refusal to write a file of the run into StorageError AOS701."""
    try:
        yield
    except OSError as error:
        hint = "Make space there, or name another folder with --runs"
        raise StorageError(f"{path} cannot be written: {error.strerror}", hint=hint) from error


def _made(runs: Path, name: str) -> Path:
    runs.mkdir(parents=True, exist_ok=True)
    for number in range(1, 1000):
        path = runs / (name if number == 1 else f"{name}-{number}")
        try:
            path.mkdir(mode=0o700)
        except FileExistsError:
            continue
        return path
    raise FileExistsError(17, f"too many runs named {name}")


def _pretty(structure: Any) -> bytes:
    return msgspec.json.format(msgspec.json.encode(structure), indent=2) + b"\n"
