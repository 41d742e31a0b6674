"""Reasons why skills cannot be run: what several have in common is told once."""

from aos_protocol.unavailable import by_reason, told_together


def test_the_paths_that_nobody_serves_are_one_reason_and_all_others_stay_apart():
    nobody, lacks = (
        "no adapter answers calls of /",
        "no adapter answers calls of /look: eye says: AOS509: other",
    )
    away = {"refill": f"{nobody}refill", "look": lacks, "spray": f"{nobody}spray", "dig": "it may be moving"}
    both = "no adapter answers calls of /refill, /spray"
    assert by_reason(away) == {both: ["refill", "spray"], lacks: ["look"], "it may be moving": ["dig"]}
    assert told_together([*away.values(), *away.values()]) == f"{both}; {lacks}; it may be moving"
    assert by_reason({"dig": f"{nobody}dig"}) == {f"{nobody}dig": ["dig"]}
    assert told_together([]) == ""
