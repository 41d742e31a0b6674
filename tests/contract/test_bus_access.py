from collections.abc import Iterator

import pytest
from hostile.bus.matrix import PARTIES, attempts, wrong
from hostile.bus.routed import ROBOT, Routed, routed

from aos_protocol.access import OPERATOR, WATCHER
from aos_protocol.errors import BusError
from aos_protocol.keys import Keys
from aos_runtime.bus.bus import Bus
from aos_runtime.bus.credentials import Credential

KEYS = Keys(ROBOT)


@pytest.fixture(scope="module")
def router(tmp_path_factory) -> Iterator[Routed]:
    with routed(tmp_path_factory.mktemp("runs"), PARTIES) as made:
        yield made


def test_what_the_table_allows_passes_and_nothing_else(router: Routed):
    assert list(wrong(router, attempts(share=0.05))) == []


def test_the_passwords_are_read_by_their_user_alone_and_the_routers_file_is_gone(router: Routed):
    router.session(OPERATOR)  # Now the router has read it.
    assert not router.passes.dictionary.exists()
    files = list(router.passes.dictionary.parent.iterdir())
    assert {file.name for file in files} == {*(party.name for party in PARTIES), OPERATOR, WATCHER}
    assert {file.stat().st_mode & 0o777 for file in files} == {0o600}


@pytest.mark.parametrize("credential", [None, Credential("operator", "guessed"), Credential("nobody", "x")])
async def test_a_stranger_gets_no_connection(router: Routed, credential: Credential | None):
    with pytest.raises(BusError, match="no bus router answers") as caught:
        await Bus.open(router.endpoint, sender="x", connect_timeout_s=0.2, credential=credential)
    assert caught.value.code == "AOS605"
