import numpy as np
import pytest

from aos_lab.calibration.calibrate import Calibration, patch_of, proposed_numbers
from aos_lab.calibration.draws import Draw
from aos_lab.calibration.estimation import DrawEstimate, estimate
from aos_lab.calibration.lattice import Lattice
from aos_lab.commands.calibrate import print_calibration
from aos_protocol.diagnostics import Span


def discrete(*weights: float, is_initial: bool = False) -> Draw:
    outcomes = tuple(f"outcome {number}" for number in range(1, len(weights) + 1))
    places = tuple(Span("pick.sd", 1, 1 + 4 * number) for number in range(len(weights)))
    texts = tuple(f"{weight:.1f}" for weight in weights)
    return Draw(
        "d1", "pick", "SampleDiscrete", Span("pick.sd", 1, 1), outcomes, weights, places, texts, is_initial
    )


def counted(draw: Draw, *counts: int) -> DrawEstimate:
    lattices = [
        Lattice(np.ones(1), (), (np.array([[outcome]], dtype=np.int64),))
        for outcome, times in enumerate(counts, 1)
        for _ in range(times)
    ]
    (only,) = estimate([draw], lattices)
    return only


@pytest.mark.parametrize("counts", [(4, 0, 0), (2, 1, 1), (1, 1, 2), (3, 0, 1), (0, 2, 2)])
def test_four_records_that_may_well_come_are_no_reason_to_change_a_number(counts):
    assert not counted(discrete(0.6, 0.2, 0.2), *counts).is_contradicted
    assert not counted(discrete(0.5, 0.5), 4, 0).is_contradicted


def test_what_is_inside_keeps_its_proportions_and_what_is_excluded_stays_so():
    found = counted(discrete(0.6, 0.2, 0.2, 0.0), 10, 70, 20, 0)
    assert [outcome.is_inside for outcome in found.outcomes] == [False, False, True, True]
    assert found.is_contradicted
    assert proposed_numbers(found) == (0.1, 0.7, 0.2, 0.0)
    inside = counted(discrete(0.5, 0.3, 0.2), 200, 75, 45)
    assert [outcome.is_inside for outcome in inside.outcomes] == [False, False, False]
    one = counted(discrete(0.2, 0.4, 0.4), 80, 10, 10)
    assert sum(proposed_numbers(one)) == pytest.approx(1)


def test_an_outcome_with_weight_0_is_never_proposed_even_where_it_came():
    found = counted(discrete(0.5, 0.5, 0.0), 10, 10, 20)
    assert not found.outcomes[2].is_inside
    assert not found.is_contradicted or proposed_numbers(found)[2] == 0.0
    certain = counted(discrete(1.0, 0.0), 5, 5)
    assert not certain.is_contradicted


def test_what_the_documents_exclude_explains_nothing_that_is_open():
    open_one = Lattice(np.ones(2), (), (np.array([[1], [2]], dtype=np.int64),))
    (found,) = estimate([discrete(1.0, 0.0)], [open_one] * 4)
    assert [outcome.count for outcome in found.outcomes] == [4.0, 0.0]
    assert not found.is_contradicted


def test_a_draw_that_decides_what_there_is_at_the_start_is_never_proposed():
    assert counted(discrete(0.9, 0.1), 0, 40).is_contradicted
    assert not counted(discrete(0.9, 0.1, is_initial=True), 0, 40).is_contradicted


def test_numbers_that_stay_are_not_in_the_patch():
    found = counted(discrete(0.6, 0.2, 0.2), 10, 70, 20)
    patch, by_hand = patch_of([found], {"pick.sd": b"0.6 0.2 0.2\n"}, {"pick.sd": "pick.sd"})
    assert "+0.1 0.7 0.2" in patch
    assert by_hand == ()
    (same,) = {counted(discrete(0.5, 0.5), 50, 50).is_contradicted}
    assert not same


def test_how_many_records_would_tell_falls_with_how_far_they_are_off():
    near, far = counted(discrete(0.5, 0.5), 2, 2), counted(discrete(0.5, 0.5), 4, 0)
    assert near.records_to_tell == 97
    assert 4 < far.records_to_tell < near.records_to_tell
    assert counted(discrete(1.0, 0.0), 4, 0).records_to_tell == 0


def test_few_records_outside_of_the_number_are_told_as_what_may_be_chance(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    for hits, verdict in ((2, "outside, and may be chance"), (3, "OUTSIDE")):
        found = counted(discrete(0.9, 0.1), 3 - hits, hits)
        print_calibration(Calibration(3, 3, (), (found,), (), "", "", ()))
        assert (found.is_contradicted, verdict in capsys.readouterr().out) == (hits == 3, True)


def test_a_terminal_of_any_width_shows_the_whole_table(capsys, monkeypatch):
    result = Calibration(9, 9, (), (counted(discrete(0.5, 0.5), 5, 4),), (), "", "", ())
    shown = {}
    for width in ("30", "80", "300"):
        monkeypatch.setenv("COLUMNS", width)
        print_calibration(result)
        shown[width] = capsys.readouterr().out
    assert len({"".join(sorted(filter(str.isalnum, text))) for text in shown.values()}) == 1
    assert "0.556 [0.255, 0.827]" in shown["80"]
