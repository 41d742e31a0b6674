"""Runs a command as a user who is not root, or as root where no user namespace can be made.

    python -m tests.hostile.placed user python -m tests.hostile --ways push mission
    python -m tests.hostile.placed closed python -m pytest tests/process/test_sandbox.py

It is started by root. The user has a home, a temporary folder and a cache of his own, with the engines that
root has; where Python stands in a folder that he may not enter, he sees of that folder Python alone.
"""

import asyncio
import os
import pwd
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from aos_deploy.places import cache_dir
from aos_solver.building.engine_build import ANY_SIZE, STATE_BYTES, build_engine

_USER = "nobody"

_AS_USER = """
set -e
python=$1 closed=$2 user=$3 group=$4
shift 4
if [ -n "$closed" ]; then
    kept=$(mktemp -d)
    mount --bind "$python" "$kept"
    mount -t tmpfs -o mode=755 none "$closed"
    mkdir -p "$python"
    mount --bind "$kept" "$python"
fi
exec setpriv --reuid "$user" --regid "$group" --clear-groups --no-new-privs -- "$@"
"""
_CLOSED = 'echo 0 >/proc/sys/user/max_user_namespaces && exec "$@"'


def placed(place: str, command: list[str], folder: Path) -> subprocess.CompletedProcess[bytes]:
    """The command, carried out in one of the `PLACES`; `folder` is his who carries it out."""
    environment = dict(os.environ)
    if place == "closed":
        words = ["unshare", "--user", "--map-root-user", "sh", "-c", _CLOSED, "sh"]
        return subprocess.run([*words, *command], env=environment, check=False)
    user = pwd.getpwnam(_USER)
    for path in (folder, *folder.rglob("*")):
        os.chown(path, user.pw_uid, user.pw_gid)
    environment |= {"HOME": str(folder), "TMPDIR": str(folder), "AOS_CACHE_DIR": str(folder / "cache")}
    environment |= {"PYTHONDONTWRITEBYTECODE": "1", "AOS_TEST_CACHE": str(folder / "compiled")}
    words = ["unshare", "--mount", "--propagation", "private", "sh", "-c", _AS_USER, "sh"]
    python = Path(sys.base_prefix)
    places = [str(python), _closed_to_others(python), str(user.pw_uid), str(user.pw_gid)]
    return subprocess.run([*words, *places, *command], env=environment, check=False)


def is_possible(place: str) -> bool:
    if os.getuid() != 0:
        return False
    with tempfile.TemporaryDirectory() as folder:
        return placed(place, [sys.executable, "-c", ""], Path(folder)).returncode == 0


def _copy_engines(cache: Path):
    """Saves the user minutes of compiling: what root has compiled he cannot reach."""
    for state_bytes in (STATE_BYTES[0], ANY_SIZE):
        engine = asyncio.run(build_engine(cache_dir(), state_bytes=state_bytes))
        shutil.copytree(engine, cache / engine.name)


def _closed_to_others(path: Path) -> str:
    """The uppermost folder above the path that others may not enter; empty where they may enter all."""
    closed = [folder for folder in path.parents if not folder.stat().st_mode & 0o001]
    return str(closed[-1]) if closed else ""


PLACES = ("user", "closed")


def main() -> int:
    if len(sys.argv) < 3 or sys.argv[1] not in PLACES:
        sys.exit(__doc__)
    place, *command = sys.argv[1:]
    if not is_possible(place):
        print(f"{place}: needs root, unshare and setpriv")
        return 0
    with tempfile.TemporaryDirectory(prefix="aos-placed-", ignore_cleanup_errors=True) as folder:
        _copy_engines(Path(folder) / "cache")
        return placed(place, command, Path(folder)).returncode


if __name__ == "__main__":
    sys.exit(main())
