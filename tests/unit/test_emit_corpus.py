from pathlib import Path

import pytest
from places import BUNDLES
from projects import bundle_project
from scripted_models import ScriptedModel, scripted

ACTIONS = {
    "armadillo-finer": 7,
    "armadillo-rough": 7,
    "paper-example-json": 3,
    "paper-example-sdl": 3,
    "sampling-rate": 18,
    "sarsop-simple": 2,
    "tic-tac-toe-json": 10,
    "tic-tac-toe-sdl": 10,
    "turtlebot-visit": 7,
    "wildfire": 18,
}

pytestmark = pytest.mark.corpus


@pytest.mark.parametrize("bundle", sorted(ACTIONS))
def test_every_bundle_emits_compiles_and_runs(corpus: Path, bundle):
    model = model_of(corpus / bundle)
    assert len(model.describe()) == ACTIONS[bundle]
    assert model.walk(1000)["steps"] == 1000


def test_our_armadillo_moves_as_the_original_does(corpus: Path):
    ours = model_of(BUNDLES / "armadillo-finer")
    original = model_of(corpus / "armadillo-finer")
    mine = ours.play("pick|3", "navigate(destination=easy_table)|1", "pick|1", "serve|1")
    theirs = original.play(
        "basic_pick|3",
        "navigate(oDesiredLocation=locationAuditorium_toCan1)|0",
        "basic_pick|1",
        "serve_can_to_person|1",
    )
    assert mine.rewards == theirs.rewards == [-2, -5, -2, -12 - 20 - 10]
    assert [step["ending"] for step in mine.steps] == [step["ending"] for step in theirs.steps]


def test_a_full_board_ends_the_game_without_a_fault(corpus: Path):
    game = model_of(corpus / "tic-tac-toe-sdl")
    # The human marks cells by the script's draws; after nine marks no cell is left to draw from.
    moves = ["draw(oCellP=0)", "detect|1", "draw(oCellP=2)", "detect|4", "draw(oCellP=7)", "detect|5"]
    played = game.play(*moves, "draw(oCellP=3)", "detect|6", "draw(oCellP=8)", "detect", "detect")
    assert played.observations[1] == "OX???????"
    assert [step["ending"] for step in played.steps[-3:]] == [3, 3, 3], "a draw is neither"


def test_the_wild_fire_sees_the_chosen_action(corpus: Path):
    fire = model_of(corpus / "wildfire")
    extinguished = fire.play("put_out(x=l1, y=l3)|0 0 0")
    assert extinguished.values("burningTable[6]") == ["true", "false"]
    assert fire.play("put_out(x=l2, y=l2)|0 0 0").values("burningTable[6]") == ["true", "true"]


def test_the_true_previous_state_gives_the_turtlebot_its_distance(corpus: Path):
    robot = model_of(corpus / "turtlebot-visit")
    reward = robot.play("navigate(oDesiredLocation=l1)").rewards[0]
    distance = (
        (-2.01710748672 + 1.5516752004623413) ** 2 + (0.570648550987 - 1.4216153621673584) ** 2
    ) ** 0.5
    assert reward == pytest.approx(100 - 10 * distance, abs=1e-4)


def model_of(bundle: Path) -> ScriptedModel:
    return scripted(bundle_project(bundle))
