"""The settings that an adapter's process is started with, by AOS or by a command of its user."""

import os
import stat
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

import msgspec
from msgspec.structs import replace

from aos_protocol.access import ADAPTER, Party
from aos_protocol.codec import UNREADABLE
from aos_runtime.bus.credentials import PASSWORD_FILE_VARIABLE
from aos_runtime.processes.settings import ServiceSettings


class Binding(msgspec.Struct, frozen=True, kw_only=True):
    """The binding of a path to the adapter's own terms.

    `target` is what the adapter calls it, None for the path itself. With `fields` the call has these fields,
    with `result` the answer has these; each value is an expression over the fields that come in.
    """

    target: Any = None
    fields: dict[str, str] | None = None
    result: dict[str, str] | None = None


class AdapterSettings(ServiceSettings, frozen=True, kw_only=True):
    """`adapter` is `module:Class` or `FILE.py:Class`. `options` are its own, of the deploy file in `folder`.

    With `serves_others` it serves what it can beside `bind`, but none of `elsewhere`, which others serve. A
    call that is cancelled has to end within `cancel_s`.
    """

    adapter: str
    project: str = ""
    folder: str = ""
    options: dict[str, Any] = msgspec.field(default_factory=dict)
    bind: dict[str, Binding] = msgspec.field(default_factory=dict)
    serves_others: bool = False
    elsewhere: tuple[str, ...] = ()
    seed: int = 1
    cancel_s: float = 2.0

    @property
    def class_place(self) -> tuple[str, str]:
        """The folder that the class may stand in, and its name as `module:Class`."""
        module, _, name = self.adapter.rpartition(":")
        if not module.endswith(".py"):
            return self.folder, self.adapter
        path = Path(self.folder) / module
        return str(path.parent), f"{path.stem}:{name}"

    @property
    def party(self) -> Party:
        """The adapter as the bus knows it, with the paths that it may serve."""
        return Party(
            name=self.service,
            role=ADAPTER,
            paths=tuple(self.bind),
            serves_others=self.serves_others,
            elsewhere=self.elsewhere,
        )


USAGE = """usage: python -m aos_runtime.adapters MODULE:CLASS [NAME=VALUE]...

CLASS of MODULE, or of a FILE.py, is the adapter; it finds each NAME in host.options. aos-up tells the rest
by the environment; by hand, name AOS_ENDPOINT (such as tcp/127.0.0.1:7447), AOS_ROBOT, AOS_ADAPTER, and
AOS_PASSWORD_FILE, which is RUN/credentials/ADAPTER or the `credential` of the deploy file."""

_USAGE_STATUS = 2
_MUST_BE_TOLD = ("AOS_ENDPOINT", "AOS_ROBOT", "AOS_ADAPTER")


def settings_told(
    words: Sequence[str], environment: Mapping[str, str] = os.environ
) -> AdapterSettings | None:
    """The settings of the class that the words name; None for a settings file. Mistakes end the process.

    What is bound to the adapter stands in $AOS_SETTINGS. Without that it serves whatever the class has.
    """
    if len(words) == 1 and words[0].endswith(".json"):
        return None
    module, _, name = words[0].rpartition(":") if words else ("", "", "")
    if not module or not name or any("=" not in word for word in words[1:]):
        _end(USAGE)
    missing = [variable for variable in _MUST_BE_TOLD if not environment.get(variable)]
    if missing:
        _end(f"{', '.join(missing)} is not in the environment\n{USAGE}")
    settings = _bound(environment)
    options = {word.partition("=")[0]: _value(word.partition("=")[2]) for word in words[1:]}
    settings = replace(
        settings,
        robot=environment["AOS_ROBOT"],
        service=environment["AOS_ADAPTER"],
        endpoint=environment["AOS_ENDPOINT"],
        password_file=environment.get(PASSWORD_FILE_VARIABLE, ""),
        run_dir=str(_run_dir(settings, environment)),
        adapter=words[0],
        folder=str(Path.cwd()),
        options={**settings.options, **options},
    )
    folder, adapter = settings.class_place
    return replace(settings, adapter=adapter, folder=folder)


def _bound(environment: Mapping[str, str]) -> AdapterSettings:
    path = environment.get("AOS_SETTINGS")
    if not path:
        return AdapterSettings(robot="", service="", endpoint="", run_dir="", adapter="", serves_others=True)
    try:
        return msgspec.json.decode(Path(path).read_bytes(), type=AdapterSettings)
    except (OSError, *UNREADABLE) as error:
        _end(f"{path}: {error}")


def _end(text: str) -> NoReturn:
    sys.stderr.write(f"{text}\n")
    sys.exit(_USAGE_STATUS)


def _run_dir(settings: AdapterSettings, environment: Mapping[str, str]) -> Path:
    """Returns the folder of the ledger of calls: the run's folder, or on another host a temporary one."""
    is_here = settings.endpoint == environment["AOS_ENDPOINT"]
    if is_here and settings.run_dir:
        return Path(settings.run_dir)
    name = Path(settings.run_dir).name or f"{environment['AOS_ROBOT']}-{os.getpid()}"
    folder = _own_folder() / name
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder


def _own_folder() -> Path:
    """A folder of this user's among the temporary files, which nobody else may enter.

    Its name can be guessed: another user who had made it first could change the ledger.
    """
    folder = Path(tempfile.gettempdir()) / f"aos-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid():
        _end(f"{folder} is not a folder of this user: remove it, or name another place by TMPDIR")
    folder.chmod(0o700)
    return folder


def _value(text: str) -> Any:
    """Numbers and truth values as such, all else as text."""
    try:
        return msgspec.json.decode(text)
    except UNREADABLE:
        return text
