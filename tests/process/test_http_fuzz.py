"""The gateway's answers to requests that schemathesis makes up; `python -m tests.http_fuzz` asks more."""

from gateway import Gateway
from http_fuzz import fuzz


def test_no_request_is_answered_by_a_servers_error(past: tuple[Gateway, str]):
    found = fuzz(*past, 1)
    assert found.returncode == 0, found.stdout + found.stderr
    assert "Tested: 29" in found.stdout
