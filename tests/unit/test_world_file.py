"""The world file: read whole, or refused with its name and the place."""

from pathlib import Path

import pytest

from aos_protocol.errors import DeployError
from aos_skills.pybullet.world_file import load_world_file


def test_the_shipped_world_has_an_easy_and_a_hard_can(root: Path):
    world = load_world_file(root / "deploy/worlds/armadillo.yaml").room
    hard = world.tables["hard"].can
    easy = world.tables["easy"].can
    assert hard.radius * hard.perceived_scale == pytest.approx(easy.radius)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("pose_noise_m", "pose_noise", "pose_noise"),
        ("x: 0.0, y: -2.0", "x: zero, y: -2.0", "robot.x"),
        ("kind: armadillo", "kind: armadilo", "no world of the kind armadilo. Did you mean `armadillo`"),
        ("kind: armadillo", "", "has no `kind`. Give one of armadillo"),
    ],
)
def test_a_mistake_is_named(root: Path, tmp_path, old, new, complaint):
    text = (root / "deploy/worlds/armadillo.yaml").read_text()
    assert old in text
    path = tmp_path / "world.yaml"
    path.write_text(text.replace(old, new))
    with pytest.raises(DeployError, match=complaint) as error:
        load_world_file(path)
    assert "world.yaml" in str(error.value)


def test_a_missing_world_is_named(tmp_path):
    with pytest.raises(DeployError, match=r"nowhere\.yaml"):
        load_world_file(tmp_path / "nowhere.yaml")
