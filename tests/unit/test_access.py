import re

import pytest

from aos_protocol import keys
from aos_protocol.access import (
    ACTS,
    ADAPTER,
    OPERATOR,
    ROLES,
    SOLVER,
    TABLE,
    WATCHER,
    Party,
    grants,
    includes,
    may,
)
from aos_protocol.errors import BusError
from aos_protocol.keys import Keys, Lack, Serving
from aos_runtime.bus.access_check import Access
from aos_runtime.router.log import RefusalLog
from aos_runtime.router.routing import access_control

KEYS = Keys("r")
ARM = Party(name="arm", role=ADAPTER, paths=("/pick", "gripper/open"))
REST = Party(name="rest", role=ADAPTER, serves_others=True, elsewhere=("/pick",))


def is_allowed(party: Party, act: str, key: str) -> bool:
    assert act in ACTS
    return may("r", party, act, key)


@pytest.mark.parametrize(
    ("pattern", "key", "is_included"),
    [
        ("a/*/c", "a/b/c", True),
        ("a/*/c", "a/b/d/c", False),
        ("a/**", "a", True),
        ("a/**", "a/b/c", True),
        ("a/**/c", "a/c", True),
        ("a/*", "a/*", True),
        ("a/*", "a/**", False),
        ("a/**", "a/*/b", True),
        ("a/b", "a/*", False),
        ("a", "a/b", False),
    ],
)
def test_an_expression_includes_what_zenoh_says_it_does(pattern, key, is_included):
    zenoh = pytest.importorskip("zenoh")
    assert includes(pattern, key) is is_included
    assert zenoh.KeyExpr(pattern).includes(zenoh.KeyExpr(key)) is is_included


def test_an_adapter_has_its_own_paths_and_no_others():
    for path in ("/pick", "/gripper/open"):
        assert is_allowed(ARM, "answers", KEYS.call(path))
        assert is_allowed(ARM, "tells", KEYS.progress(path))
        assert is_allowed(ARM, "announces", KEYS.serve(Serving("arm", "1", "i", path)))
        lack = Lack("arm", "no node/service *here*?", path)
        assert is_allowed(ARM, "announces", KEYS.lack(lack))
        assert KEYS.lack_of(KEYS.lack(lack)) == lack
    assert len(KEYS.lack(Lack("arm", "é" * 99_999, "/pick"))) < 60_000
    assert not is_allowed(ARM, "announces", KEYS.lack(Lack("arm", "none", "/drive")))
    assert not is_allowed(ARM, "answers", KEYS.call("/drive"))
    assert not is_allowed(ARM, "answers", "aos/r/call/**")
    assert not is_allowed(ARM, "announces", KEYS.serve(Serving("rest", "1", "i", "/pick")))
    assert not is_allowed(ARM, "asks", KEYS.call("/pick"))


def test_an_adapter_for_everything_else_has_not_what_is_bound_elsewhere():
    assert is_allowed(REST, "answers", KEYS.call("/drive"))
    assert not is_allowed(REST, "answers", KEYS.call("/pick"))


def test_who_may_steer_is_the_operator_and_who_looks_on_may_tell_nothing():
    operator, watcher = (Party(name=role, role=role) for role in (OPERATOR, WATCHER))
    for key in (KEYS.start_mission, KEYS.stop_mission, KEYS.push_bundle, KEYS.call("/pick")):
        assert is_allowed(operator, "asks", key)
        assert not is_allowed(watcher, "asks", key)
    assert is_allowed(watcher, "hears", KEYS.decisions)
    told = [grant for grant in grants("r", watcher) if grant.act in ("tells", "answers", "announces")]
    assert told == []


def test_only_the_solver_tells_how_the_mission_is():
    assert [row.tells for row in TABLE if row.key == "mission/state"] == [(SOLVER,)]


def test_another_robot_is_none_of_ones_business():
    for role in ROLES:
        party = Party(name=role, role=role)
        assert not any(is_allowed(party, act, Keys("other").mission_state) for act in ACTS)


def test_what_the_router_would_deny_is_told():
    access = Access("r", ARM)
    access.check("answers", KEYS.call("/pick"))
    with pytest.raises(
        BusError, match=r"arm may not answer aos/r/call/drive\. Give the path to arm"
    ) as caught:
        access.check("answers", KEYS.call("/drive"))
    assert caught.value.code == "AOS608"
    with pytest.raises(BusError, match="arm may not tell anything on aos/r/mission/state"):
        access.check("tells", KEYS.mission_state)


def test_every_rule_of_the_router_has_a_name_of_its_own():
    access = access_control("r", [ARM, REST])
    names = [rule["id"] for rule in access["rules"]]
    assert len(set(names)) == len(names)
    assert [policy["subjects"] for policy in access["policies"]] == [["arm"], ["rest"]]
    assert access["default_permission"] == "deny"


DENIED = (
    b"TRACE rx-1 ThreadId(09) a: 6f on Username(arm)+Transport(Tcp)+6f is unauthorized to Put (ingress) on "
)
OVER = b"TRACE rx-1 ThreadId(09) zenoh::net::routing::interceptor: Msg intercepted!"


def test_a_flood_of_refusals_is_a_few_lines():
    told: list[str] = []
    log = RefusalLog(told.append)
    for _ in range(1500):
        log.take(DENIED + b"aos/r/mission/state")
        log.take(OVER)
    text = "refused: arm may not send put on aos/r/mission/state"
    assert told == [text, *(f"{text}, {count} times by now" for count in (10, 100, 1000))]
    for number in range(5000):
        log.take(DENIED + b"aos/r/%d" % number)
        log.take(OVER)
    assert len(told) < 1100


def test_a_permission_that_is_looked_up_is_no_refusal_and_a_session_is_known_again():
    told: list[str] = []
    log = RefusalLog(told.append)
    log.take(DENIED + b"aos/r/topic/camera")
    log.take(
        b"TRACE rx-1 ThreadId(09) a: Using cached result: 6f is unauthorized to Query (ingress) on aos/r/x"
    )
    log.take(b"TRACE rx-2 ThreadId(11) zenoh::net::routing::interceptor: Msg intercepted!")
    assert told == []
    log.take(OVER)
    assert told == ["refused: arm may not send query on aos/r/x"]
    log.take(b"DEBUG acc-0 ThreadId(05) b: UsrPwd extension - Recv OpenSyn. Invalid password. at x")
    assert told[1:] == ["refused: a connection with a wrong password"]


def test_every_key_has_a_row():
    written = re.findall(r"^    aos/<robot>/(\S+)", keys.__doc__ or "", re.MULTILINE)
    rows = [row.key.replace("<topic>", "<path>") for row in TABLE]
    assert sorted(rows) == sorted(written)
