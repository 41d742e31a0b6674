import pytest

from aos_solver.study.flips import places_beside, sampled_flip
from aos_solver.study.valuing import Margin, Value


def test_a_choice_changes_for_certain_between_margins_that_are_certain():
    places = [(1.0, Margin(-3.0, 0.5)), (0.0, Margin(3.0, 0.5)), (0.2, Margin(1.8, 0.5))]
    low, high, is_certain = sampled_flip(places, 0.2) or (0.0, 0.0, False)
    assert is_certain
    assert (low, high) == (pytest.approx(1 / 3), pytest.approx(2 / 3))  # 3 - 6 p is 1 and -1 there.


def test_a_choice_may_change_up_to_an_end_that_is_too_close_to_call():
    places = [(0.0, Margin(4.0, 1.0)), (0.5, Margin(2.5, 1.0)), (1.0, Margin(1.0, 1.0))]
    assert sampled_flip(places, 0.5) == (pytest.approx(2 / 3), 1.0, False)


def test_a_margin_that_is_too_close_now_leaves_both_sides_open():
    places = [(0.0, Margin(-4.0, 1.0)), (0.5, Margin(0.0, 1.0)), (1.0, Margin(4.0, 1.0))]
    assert sampled_flip(places, 0.5) == (0.25, 0.75, True)
    assert sampled_flip([(p, Margin(0.0, 1.0)) for p in (0.0, 0.5, 1.0)], 0.5) == (0.0, 1.0, False)


def test_the_nearest_of_two_changes_is_told_and_none_where_all_margins_are_certain():
    margins = {0.0: -4.0, 0.3: 4.0, 0.4: 4.0, 1.0: -4.0}
    low, high, _ = sampled_flip([(p, Margin(m, 0.5)) for p, m in margins.items()], 0.35) or (1.0, 0.0, False)
    assert 0 < low < high < 0.3
    assert sampled_flip([(p, Margin(4.0, 1.0)) for p in (*places_beside(0.3), 0.3)], 0.3) is None


def test_what_another_search_has_found_is_part_of_the_error_of_a_value():
    found = Value(1.0, 0.3, 10).beside(Value(1.4, 0.1, 5))
    assert (found.q, found.n) == (1.0, 10)
    assert found.stderr == pytest.approx(0.5)


def test_a_new_search_tells_no_more_than_what_was_proven_at_the_decision_leaves_open():
    decided = Value(11.7, 0.1, at_least=11.0, at_most=12.1)
    found = Value(15.2, 8.2, 1).within(decided)
    assert (found.q, found.stderr) == (12.1, pytest.approx(1.1))
    assert Value(11.5, 0.2).within(decided) == Value(11.5, 0.2)
    assert Value(15.2, 8.2).within(Value(11.7)) == Value(15.2, 8.2)  # Nothing was proven.
