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


def test_what_one_adapter_says_of_several_paths_is_told_once():
    of_a, of_b, of_c = (f"no adapter answers calls of /{path}: arm says: it is off" for path in "abc")
    together = "no adapter answers calls of /b, /c"
    assert by_reason({"b": of_b, "c": of_c}) == {f"{together}: arm says: it is off": ["b", "c"]}
    assert told_together([of_a, of_b, of_c], after=f"left out: {of_a}") == f"{together}: for the same reason"
