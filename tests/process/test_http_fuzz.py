"""The gateway's answers to requests that schemathesis makes up; `python -m tests.http_fuzz` asks more."""

from pathlib import Path

from gateway import gateway, played
from http_fuzz import fuzz


def test_no_request_is_answered_by_a_servers_error(tmp_path: Path, cache_dir: Path):
    run = played(tmp_path, cache_dir)
    with gateway(tmp_path, cache_dir) as served:
        found = fuzz(served, run.name, 1)
    assert found.returncode == 0, found.stdout + found.stderr
    assert "Tested: 28" in found.stdout
