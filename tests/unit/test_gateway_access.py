import asyncio
import socket

import pytest

from aos_gateway.api.access import COOKIE, Access, access_of, kept_token
from aos_gateway.server import listening
from aos_protocol.errors import GatewayError

OWN = {"host": "localhost:7480"}
BEARER = {"authorization": "Bearer secret"}


def refusal(
    access: Access, method: str, headers: dict[str, str], cookies: dict[str, str] | None = None
) -> str:
    """The code of the refusal; empty where the request may pass."""
    try:
        access.check(method, headers, cookies or {})
    except GatewayError as error:
        return error.code
    return ""


@pytest.fixture
def loopback() -> Access:
    return access_of("127.0.0.1", (), "secret", is_private=False)


@pytest.mark.parametrize("host", ["localhost:7480", "127.0.0.1:7480", "[::1]:7480", "LOCALHOST"])
def test_names_of_the_gateway_are_answered(loopback: Access, host):
    assert refusal(loopback, "GET", {"host": host}) == ""


@pytest.mark.parametrize(
    "host", ["evil.example:7480", "evil.example", "", "127.0.0.1.evil.example", "localhost.evil:80"]
)
def test_a_name_that_somebody_else_has_given_to_this_machine_is_refused(loopback: Access, host):
    assert refusal(loopback, "GET", {"host": host} | BEARER) == "AOS904"


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "null",
        "http://[",
        "localhost:7480",
        "http://localhost:8000",
        "http://127.0.0.1:7480",
    ],
)
def test_a_page_of_another_origin_is_refused_also_with_the_token(loopback: Access, origin):
    assert refusal(loopback, "POST", OWN | BEARER | {"origin": origin}) == "AOS904"
    assert refusal(loopback, "GET", OWN | {"origin": origin}) == "AOS904"


def test_the_gateways_own_page_may_ask(loopback: Access):
    assert refusal(loopback, "POST", OWN | BEARER | {"origin": "http://localhost:7480"}) == ""


def test_writing_needs_the_token_itself_and_no_cookie(loopback: Access):
    assert refusal(loopback, "POST", OWN) == "AOS903"
    assert refusal(loopback, "POST", OWN | {"authorization": "Bearer other"}) == "AOS903"
    assert refusal(loopback, "POST", OWN, {COOKIE: "secret"}) == "AOS903"
    assert refusal(loopback, "DELETE", OWN) == "AOS903"
    assert refusal(loopback, "POST", OWN | BEARER) == ""


@pytest.mark.parametrize("listen", ["0.0.0.0", "192.0.2.7", "::"])
def test_off_loopback_reading_needs_the_token_or_the_cookie(listen):
    access = access_of(listen, ("robot.lab",), "secret", is_private=False)
    there = {"host": "robot.lab:7480"}
    assert refusal(access, "GET", there) == "AOS903"
    assert refusal(access, "GET", there, {COOKIE: "wrong"}) == "AOS903"
    assert refusal(access, "GET", there, {COOKIE: "secret"}) == ""
    assert refusal(access, "GET", there | BEARER) == ""


def test_the_files_of_the_page_say_nothing_of_a_robot_and_are_open():
    access = access_of("127.0.0.1", (), "secret", is_private=True)
    access.check("GET", OWN, {}, is_open=True)
    assert refusal(access, "GET", OWN) == "AOS903"


def test_the_token_is_kept_and_nobody_else_may_read_it(tmp_path):
    path = tmp_path / "gateway" / "token"
    token = kept_token(path)
    assert len(token) >= 32
    assert kept_token(path) == token
    assert path.stat().st_mode & 0o777 == 0o600


async def test_no_answer_waits_until_the_one_before_it_is_acknowledged():
    connected: asyncio.Queue[asyncio.StreamWriter] = asyncio.Queue()
    with listening("127.0.0.1", 0) as listener:
        server = await asyncio.start_server(lambda _, writer: connected.put_nowait(writer), sock=listener)
        _, browser = await asyncio.open_connection(*listener.getsockname())
        served = await connected.get()
        delays = served.get_extra_info("socket").getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) == 0
        for end in (browser, served):
            end.close()
            await end.wait_closed()
        server.close()
    assert not delays
