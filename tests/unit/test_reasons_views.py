from msgspec.structs import replace

from aos_deploy.views.reasons import why_lines
from aos_protocol.messages import BeliefSummary, Consequence, Flip, ValueTerm, Why

WHY = Why(
    mission="m",
    step=3,
    action="look",
    value=1.46,
    stderr=0.0,
    other="pick",
    other_value=0.63,
    other_stderr=0.0,
    margin=0.83,
    margin_stderr=0.0,
    is_exact=True,
    is_close=False,
    simulations_to_tell=0,
    horizon=10,
    planner="exact",
    chosen_by="planner",
    belief=BeliefSummary((), 0.0, 0.0, 0.0, 1, True),
    expected=tuple(Consequence(f"r{n}", 0.25, n == 1, 0.1, "pick", 1.0) for n in range(4)),
    terms=tuple(ValueTerm(f"pick.sd:{n}", 1.0 / n, 0.0) for n in range(1, 8)),
    flips=(Flip("holding", "true", 0.17, 0.0356, 0.0357, True),),
    remark="something",
)


def test_a_decision_is_explained_in_eight_lines_at_most():
    lines = why_lines(WHY)
    assert len(lines) <= 8
    assert lines[0] == "step 3: look is worth exactly +1.46, pick +0.63: margin +0.83"
    assert lines[1].endswith("; r1 was seen")
    assert "+1 from pick.sd:1" in lines[-3]
    assert "from 3 other lines" in lines[-3]
    assert lines[-2] == "  pick is better where P(holding=true) is below 0.0356, now 0.17"


def test_a_long_belief_update_is_told_with_what_it_took():
    long = replace(WHY, update_s=1.734, update_effort="3000 steps of the model")
    assert why_lines(long)[1].endswith("; r1 was seen; the belief update took 1.7 s: 3000 steps of the model")
    assert len(why_lines(long)) <= 8
    assert why_lines(replace(long, update_s=0.09)) == why_lines(WHY)


def test_a_close_decision_says_how_many_simulations_would_tell():
    close = replace(
        WHY, is_exact=False, is_close=True, margin_stderr=0.6, simulations_to_tell=12000, flips=(), remark=""
    )
    lines = why_lines(close)
    assert "too close to call, about 12,000 simulations would tell" in lines[0]
    assert not any("better where" in line or "no probability" in line for line in lines)


def test_a_change_at_certainty_and_one_known_as_an_interval_are_told_apart():
    certain = Flip("holding", "true", 0.5, 0.9999, 1.0, True)
    assert "P(holding=true) is 1, now 0.5" in why_lines(replace(WHY, flips=(certain,)))[-2]
    for flip, words in (
        (
            Flip("holding", "true", 0.5, 0.1, 0.3, True),
            "changes where P(holding=true) is within 0.1-0.3, now 0.5",
        ),
        (Flip("holding", "true", 0.5, 0.1, 1.0), "may change where P(holding=true) is within 0.1-1, now 0.5"),
        (Flip("holding", "true", 0.5, 0.0, 1.0), "too close to call whatever P(holding=true) is, now 0.5"),
    ):
        lines = why_lines(replace(WHY, flips=(flip,), is_exact=False))
        assert lines[-2].endswith(words)


def test_what_an_operator_asked_for_may_be_the_worse_action_and_says_who_chose():
    asked = replace(WHY, chosen_by="operator", margin=-0.83, value=0.63, other_value=1.46)
    lines = why_lines(asked)
    assert lines[0] == (
        "step 3: look, asked for by an operator, is worth exactly +0.63, pick +1.46: margin -0.83"
    )
    assert lines[-2] == "  look is better where P(holding=true) is below 0.0356, now 0.17"
