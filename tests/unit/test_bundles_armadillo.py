import re

import pytest
from places import BUNDLES
from projects import files_project

from aos_language.load import load_files, read_bundle_files

FIGURES = {
    "rough": {"0.5238", "0.0952", "0.0476", "0.4285"},
    "finer": {"0.727", "0.181", "0.09", "0.0", "0.1", "0.9"},
}


def files_of(*names: str) -> dict[str, bytes]:
    """The documents of several bundles, a later one's in place of those with the same name."""
    return {file: text for name in names for file, text in read_bundle_files(BUNDLES / name)[0].items()}


@pytest.mark.parametrize("name", FIGURES)
def test_the_picking_skill_has_the_figures_of_its_statistics(name):
    project = files_project(files_of("armadillo-finer", f"armadillo-{name}"))
    (block,) = project.skill("pick").model.dynamic_model
    lists = re.findall(r"SampleDiscrete\(Ending, \{(.*?)\}", block.code.code)
    assert {figure.strip() for figures in lists for figure in figures.split(",")} == FIGURES[name]


def test_the_other_bundles_have_what_differs_alone():
    assert set(files_of("armadillo-finer-enhanced")) == {"pick.am", "pick.sd"}
    for name in ("armadillo-rough", "armadillo-rough-enhanced"):
        assert set(files_of(name)) == {"pick.sd"}


@pytest.mark.parametrize("name", FIGURES)
def test_the_enhanced_pick_has_the_figures_of_the_plain_one(name):
    """The original's enhanced finer pick gave four weights to five endings, and so other probabilities."""
    weights = [
        re.findall(r"SampleDiscrete\(Ending, \{(.*?)\}", (BUNDLES / path / "pick.sd").read_text())
        for path in (f"armadillo-{name}", f"armadillo-{name}-enhanced")
    ]
    assert weights[0] == weights[1]


def test_our_bundles_say_nothing_but_that_the_rough_weights_do_not_add_up_to_one():
    """The published figures of the rough bundle add up to 1.095, those of the finer one are only rounded."""
    codes = {
        name: {
            found.code for found in load_files(files_of("armadillo-finer", f"armadillo-{name}")).diagnostics
        }
        for name in FIGURES
    }
    assert codes == {"rough": {"AOS122"}, "finer": set()}
