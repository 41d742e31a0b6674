"""Has a real systemd carry out the unit of `aos new unit`: a mission to its end, and one that is stopped.

    python -m tests.hostile.unit

systemd is process 1 of namespaces of its own, and reads no units but those that are made here: nothing of
this machine changes. It needs root, systemd and its `nsenter` and `unshare`.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.kept_cache import link_engines

from aos_deploy.places import cache_dir

_SYSTEMD = Path("/lib/systemd/systemd")
_UNIT = "aos-fetch.service"
_PATIENCE_S = 600.0
_LOOKS_S = 0.2
_TARGETS = ("sysinit", "basic", "network", "shutdown", "multi-user", "umount", "final")

# /etc and the kernel's settings are read-only, everything that systemd writes is the namespace's own.
_INIT = """
set -e
mount --make-rprivate /
mount -t proc proc /proc
for place in /proc/sys /etc; do mount --bind $place $place && mount -o remount,bind,ro $place; done
for place in /run /srv /var/cache; do mount -t tmpfs none $place; done
umount -R /sys/fs/cgroup
mount -t cgroup2 none /sys/fs/cgroup
cp -r "$1"/. /srv
mkdir -p /var/cache/aos-fetch
cp -P "$1"/engines/* /var/cache/aos-fetch 2>/dev/null || true
cd /srv
"$2" new project fetch >/dev/null
"$2" new adapter command --in fetch >/dev/null
"$2" new unit fetch.yaml --to /srv/units >/dev/null
export container=aos SYSTEMD_UNIT_PATH=/srv/units
export SYSTEMD_GENERATOR_PATH=/srv/none SYSTEMD_ENVIRONMENT_GENERATOR_PATH=/srv/none
exec "$3" --system --log-level=warning
"""


class Machine:
    """A systemd, by the number of its process here."""

    def __init__(self, pid: int, said: Path):
        self._pid = pid
        self._said = said

    def inside(self, *words: str) -> str:
        command = ["nsenter", "-t", str(self._pid), "-m", "-p", *words]
        return subprocess.run(command, capture_output=True, text=True, check=False).stdout

    def shown(self, name: str) -> str:
        return self.inside("systemctl", "show", "--value", "-p", name, _UNIT).strip()

    def until(self, *, state: str = "", said: str = "") -> bool:
        ends_s = time.monotonic() + _PATIENCE_S
        while time.monotonic() < ends_s:
            if said and self._said.exists() and said in self._said.read_text():
                return True
            now = self.shown("ActiveState")
            if now == state:
                return True
            if said and now in ("failed", "inactive"):
                return False
            time.sleep(_LOOKS_S)
        return False

    @property
    def left_running(self) -> list[str]:
        """The processes beside systemd's own and the one that looks."""
        lines = self.inside("ps", "-eo", "pid=,args=").splitlines()
        return [line for line in lines if "aos" in line and "systemd" not in line]


@contextmanager
def machine(folder: Path) -> Iterator[Machine]:
    """A systemd that starts the unit, in namespaces that end with the block."""
    units = folder / "units"
    (units / f"{_UNIT}.d").mkdir(parents=True)
    link_engines(cache_dir(), folder / "engines")
    for name in _TARGETS:
        (units / f"{name}.target").write_text("[Unit]\nDefaultDependencies=no\n")
    (units / "default.target").write_text(f"[Unit]\nDefaultDependencies=no\nWants={_UNIT}\n")
    said = folder / "said"
    output = f"[Service]\nStandardOutput=append:{said}\nStandardError=append:{said}\n"
    (units / f"{_UNIT}.d" / "output.conf").write_text(output)
    aos = Path(sys.executable).with_name("aos")
    spaces = ["--fork", "--pid", "--mount", "--uts", "--ipc", "--net", "--cgroup", "--kill-child"]
    words = ["unshare", *spaces, "sh", "-c", _INIT, "sh", str(folder), str(aos), str(_SYSTEMD)]
    with (folder / "console").open("wb") as console:
        process = subprocess.Popen(words, stdout=console, stderr=console)
    try:
        yield Machine(_first_process(process, folder), said)
    finally:
        process.kill()
        process.wait()


def _first_process(process: subprocess.Popen[bytes], folder: Path) -> int:
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    ends_s = time.monotonic() + _PATIENCE_S
    while time.monotonic() < ends_s and process.poll() is None:
        for pid in children.read_text().split():
            if Path(f"/proc/{pid}/exe").resolve() == _SYSTEMD.resolve():
                return int(pid)
        time.sleep(_LOOKS_S)
    raise RuntimeError((folder / "console").read_text())


def is_possible() -> bool:
    """Says whether there is a systemd, and somebody who may start it."""
    programs = all(shutil.which(name) for name in ("unshare", "nsenter", "systemctl"))
    return programs and _SYSTEMD.exists() and os.getuid() == 0


def main() -> int:
    if not is_possible():
        print("needs systemd, unshare and nsenter, and to be root")
        return 0
    with tempfile.TemporaryDirectory(prefix="aos-unit-") as folder, machine(Path(folder)) as system:
        said = Path(folder) / "said"
        has_ended = system.until(state="inactive")
        is_good = has_ended and "mission ended: the goal is reached" in said.read_text()
        print(f"a mission at the start: {system.shown('Result')}, exit {system.shown('ExecMainStatus')}")
        said.unlink(missing_ok=True)
        system.inside("systemctl", "start", _UNIT)
        is_running = system.until(said="robot ready")
        started_s = time.monotonic()
        system.inside("systemctl", "stop", _UNIT)
        stopped_s = time.monotonic() - started_s
        left, result = system.left_running, system.shown("Result")
        is_good = is_good and is_running and result == "success" and not left
        print(f"one that is stopped: {result} after {stopped_s:.1f} s, {len(left)} processes run on")
        if not is_good:
            print(said.read_text() if said.exists() else "", *left, sep="\n")
    return int(not is_good)


if __name__ == "__main__":
    sys.exit(main())
