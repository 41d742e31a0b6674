import re

import pytest
from places import BUNDLES
from projects import bundle_project

from aos_language.load import load_bundle

FIGURES = {
    "rough": {"0.5238", "0.0952", "0.0476", "0.4285"},
    "finer": {"0.727", "0.181", "0.09", "0.0", "0.1", "0.9"},
}


@pytest.mark.parametrize("name", FIGURES)
def test_the_picking_skill_has_the_figures_of_its_statistics(name):
    (block,) = bundle_project(BUNDLES / f"armadillo-{name}").skill("pick").model.dynamic_model
    lists = re.findall(r"SampleDiscrete\(Ending, \{(.*?)\}", block.code.code)
    assert {figure.strip() for figures in lists for figure in figures.split(",")} == FIGURES[name]


def test_without_sensing_and_with_the_enhanced_pick_the_rest_is_the_same():
    whole, blind, enhanced = (
        load_bundle(BUNDLES / f"armadillo-finer{kind}").files for kind in ("", "-blind", "-enhanced")
    )
    sensing = {file for file in whole if file.startswith("observe_")}
    assert blind == {file: text for file, text in whole.items() if file not in sensing}
    assert set(enhanced) == set(blind)
    others = {"armadillo.ef", "pick.am", "pick.sd"}  # The environment has another horizon.
    assert {file for file in enhanced if enhanced[file] != whole[file]} == others


@pytest.mark.parametrize("name", FIGURES)
def test_the_enhanced_pick_has_the_figures_of_the_plain_one(name):
    """The original's enhanced finer pick gave four weights to five endings, and so other probabilities."""
    weights = [
        re.findall(r"SampleDiscrete\(Ending, \{(.*?)\}", (BUNDLES / path / "pick.sd").read_text())
        for path in (f"armadillo-{name}", f"armadillo-{name}-enhanced")
    ]
    assert weights[0] == weights[1]


def test_the_two_bundles_differ_in_the_picking_model_only():
    rough, finer = (load_bundle(BUNDLES / f"armadillo-{name}").files for name in FIGURES)
    assert {name for name in finer if finer[name] != rough[name]} == {"pick.sd"}
    for kind in ("blind", "enhanced"):
        assert [path.name for path in (BUNDLES / f"armadillo-rough-{kind}").iterdir()] == ["pick.sd"]
    picks = {(BUNDLES / f"armadillo-rough{kind}" / "pick.sd").read_text() for kind in ("", "-blind")}
    assert len(picks) == 1


def test_our_bundles_say_nothing_but_that_the_rough_weights_do_not_add_up_to_one():
    """The published figures of the rough bundle add up to 1.095, those of the finer one are only rounded."""
    codes = {
        name: {diagnostic.code for diagnostic in load_bundle(BUNDLES / f"armadillo-{name}").diagnostics}
        for name in FIGURES
    }
    assert codes == {"rough": {"AOS122"}, "finer": set()}
