import hashlib
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from places import ROOT
from processes import COMMAND_S

from aos_deploy.places import cache_dir


def installed_sources() -> Path:
    """A copy of the page's sources with `node_modules`, kept for later; skips where that cannot be."""
    npm = shutil.which("npm")
    if npm is None or shutil.which("node") is None:
        pytest.skip("needs node and npm")
    sources = ROOT / "services/gateway/page"
    lock = hashlib.sha256((sources / "package-lock.json").read_bytes()).hexdigest()[:16]
    target = cache_dir() / f"page-{lock}"
    if not target.exists():
        new = cache_dir() / f".page-{lock}-{os.getpid()}"
        shutil.copytree(sources, new, ignore=shutil.ignore_patterns("node_modules"))
        command = [npm, "ci", "--silent", "--no-audit", "--no-fund"]
        done = subprocess.run(command, cwd=new, capture_output=True, timeout=COMMAND_S, check=False)
        if done.returncode != 0:
            shutil.rmtree(new)
            pytest.skip("the page's libraries cannot be fetched here")
        try:
            new.rename(target)
        except OSError:
            shutil.rmtree(new)  # Another process was quicker.
    return target
