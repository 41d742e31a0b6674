"""Our armadillo bundles are the original ones under other names."""

import re
from pathlib import Path

import pytest

from aos_language.cpp.snippets import read_cpp
from aos_language.load import load_bundle
from aos_protocol.documents import Assignment, Project

OURS_BY_THEIRS = {
    # enum values
    "eCorridor": "Corridor",
    "eLocationAuditoriumSide1": "EasyTable",
    "eLocationAuditoriumSide2": "HardTable",
    "eRobotHand": "RobotHand",
    "eUnknown": "Unknown",
    # types
    "tDiscreteLocation": "Place",
    "tLocation": "Destination",
    # variables
    "cup1DiscreteLocation": "easy_can_at",
    "cup2DiscreteLocation": "hard_can_at",
    "robotGenerallocation": "robot_at",
    "drinkServed": "drink_served",
    "armOutstretched": "arm_outstretched",
    "locationCorridor": "corridor",
    "locationAuditorium_toCan1": "easy_table",
    "locationAuditorium_toCan2": "hard_table",
    # skills, parameters and responses
    "basic_pick": "pick",
    "observe_holding_can": "observe_holding",
    "serve_can_to_person": "serve",
    "oDesiredLocation": "destination",
    "eSuccess": "arrived",
    "eFailed": "failed",
    "res_pick_action_success": "pick_succeeded",
    "res_pick_action_failed": "pick_failed",
    "eHoldingCan": "holding",
    "eNotHoldingCan": "not_holding",
    "eArmOutstretched": "outstretched",
    "eArmNotOutstretched": "not_outstretched",
    "eDelivered": "delivered",
    "eNotDelivered": "not_delivered",
}
FIGURES = {
    "rough": {"0.5238", "0.0952", "0.0476", "0.4285"},
    "finer": {"0.727", "0.181", "0.09", "0.0", "0.1", "0.9"},
}


def project_in(path: Path) -> Project:
    project = load_bundle(path).project
    assert project is not None
    return project


@pytest.fixture(params=["rough", "finer"])
def pair(request: pytest.FixtureRequest, bundles: Path, corpus: Path) -> tuple[Project, Project]:
    """Ours and theirs."""
    name = f"armadillo-{request.param}"
    return project_in(bundles / name), project_in(corpus / name)


def ours(name: str) -> str:
    return OURS_BY_THEIRS.get(name, name)


def rewards(block: tuple[Assignment, ...]) -> set[str]:
    """The numbers in what is assigned to `__reward`."""
    found: set[str] = set()
    for assignment in block:
        cpp = read_cpp(assignment.code.code if assignment.code else "")
        for mention in cpp.mentions:
            if mention.path == ("__reward",) and mention.assigned is not None:
                found |= set(re.findall(r"-?\d+", cpp.code[mention.assigned.start : mention.assigned.end]))
    return found


@pytest.mark.corpus
def test_types_and_variables_are_the_same(pair: tuple[Project, Project]):
    ours_environment, theirs = (project.environment for project in pair)
    assert {v for enum in ours_environment.enums for v in enum.values} == {
        ours(v) for enum in theirs.enums for v in enum.values
    }
    assert {(v.name, v.type, v.is_parameter_value) for v in ours_environment.variables} == {
        (ours(v.name), ours(v.type), v.is_parameter_value) for v in theirs.variables
    }
    assert sum(not v.is_parameter_value for v in ours_environment.variables) == 7
    assert (ours_environment.horizon, ours_environment.discount) == (theirs.horizon, theirs.discount)


@pytest.mark.corpus
def test_skills_parameters_responses_and_penalties_are_the_same(pair: tuple[Project, Project]):
    described = [
        {
            (
                rename(skill.name),
                tuple((rename(p.name), rename(p.type)) for p in skill.model.parameters),
                frozenset(rename(rule.response) for rule in skill.mapping.rules),
                skill.model.violation_penalty,
            )
            for skill in project.skills
        }
        for project, rename in zip(pair, (str, ours), strict=True)
    ]
    assert described[0] == described[1]
    assert sum(len(responses) for _, _, responses, _ in described[0]) == 10


@pytest.mark.corpus
def test_rewards_are_the_same(pair: tuple[Project, Project]):
    mine, theirs = pair
    for skill in theirs.skills:
        model = mine.skill(ours(skill.name)).model
        assert rewards(model.dynamic_model) == rewards(skill.model.dynamic_model)
    special = [rewards(state.code) or {"0"} for state in mine.environment.special_states]
    assert special == [{f"{state.reward:g}"} for state in theirs.environment.special_states]


@pytest.mark.parametrize("name", FIGURES)
def test_the_picking_skill_has_the_figures_of_its_statistics(bundles: Path, name):
    (block,) = project_in(bundles / f"armadillo-{name}").skill("pick").model.dynamic_model
    lists = re.findall(r"SampleDiscrete\(Ending, \{(.*?)\}", block.code.code)
    assert {figure.strip() for figures in lists for figure in figures.split(",")} == FIGURES[name]


def test_without_sensing_and_with_the_enhanced_pick_the_rest_is_the_same(bundles: Path):
    whole, blind, enhanced = (
        load_bundle(bundles / f"armadillo-finer{kind}").files for kind in ("", "-blind", "-enhanced")
    )
    sensing = {file for file in whole if file.startswith("observe_")}
    assert blind == {file: text for file, text in whole.items() if file not in sensing}
    assert set(enhanced) == set(blind)
    others = {"armadillo.ef", "pick.am", "pick.sd"}  # The environment has another horizon.
    assert {file for file in enhanced if enhanced[file] != whole[file]} == others


@pytest.mark.parametrize("name", FIGURES)
def test_the_enhanced_pick_has_the_figures_of_the_plain_one(bundles: Path, name):
    """The original's enhanced finer pick gave four weights to five endings, and so other probabilities."""
    weights = [
        re.findall(r"SampleDiscrete\(Ending, \{(.*?)\}", (bundles / path / "pick.sd").read_text())
        for path in (f"armadillo-{name}", f"armadillo-{name}-enhanced")
    ]
    assert weights[0] == weights[1]


def test_the_two_bundles_differ_in_the_picking_model_only(bundles: Path):
    rough, finer = (load_bundle(bundles / f"armadillo-{name}").files for name in FIGURES)
    assert {name for name in finer if finer[name] != rough[name]} == {"pick.sd"}
    for kind in ("blind", "enhanced"):
        assert [path.name for path in (bundles / f"armadillo-rough-{kind}").iterdir()] == ["pick.sd"]
    picks = {(bundles / f"armadillo-rough{kind}" / "pick.sd").read_text() for kind in ("", "-blind")}
    assert len(picks) == 1


def test_our_bundles_say_nothing_but_that_the_rough_weights_do_not_add_up_to_one(bundles: Path):
    """The published figures of the rough bundle add up to 1.095, those of the finer one are only rounded."""
    codes = {
        name: {diagnostic.code for diagnostic in load_bundle(bundles / f"armadillo-{name}").diagnostics}
        for name in FIGURES
    }
    assert codes == {"rough": {"AOS122"}, "finer": set()}
