import pytest
from places import DEPLOY

pytest.importorskip("pybullet", reason="needs the simulator: pip install 'aos-autonomy[sim]'")

from aos_protocol.errors import DeployError
from aos_skills.pybullet.world_file import load_world_file

pytestmark = pytest.mark.physics


WORLD = DEPLOY / "worlds" / "armadillo.yaml"


def test_the_hard_can_of_the_shipped_world_is_perceived_as_the_easy_one():
    easy, hard = (load_world_file(WORLD).room.tables[name].can for name in ("easy", "hard"))
    assert hard.radius * hard.perceived_scale == pytest.approx(easy.radius)


@pytest.mark.parametrize(
    ("before", "after", "place"),
    [
        ("arm_stays_out: 0.2", "arm_stays_out: 2", "$.faults.arm_stays_out"),
        ("pose_noise_m: 0.0036", "pose_noise_m: -1", "$.faults.pose_noise_m"),
        ("radius: 0.033", "radius: 0", "$.tables[...].can.radius"),
        ("pose_noise_m: 0.0036", "pose_noise: 0", "unknown field `pose_noise`"),
        ("misplaced: 0.09", "misplaced: .nan", "$.tables[...].can.misplaced"),
        ("x: 0.0, y: -2.0", "x: zero, y: -2.0", "$.robot.x"),
        ("kind: armadillo", "kind: armadilo", "no world of the kind armadilo. Did you mean `armadillo`"),
        ("kind: armadillo", "", "has no `kind`. Give one of armadillo"),
    ],
)
def test_a_mistake_is_told_with_its_place(tmp_path, before, after, place):
    text = WORLD.read_text()
    assert before in text
    (tmp_path / "world.yaml").write_text(text.replace(before, after))
    with pytest.raises(DeployError) as told:
        load_world_file(tmp_path / "world.yaml")
    assert place in str(told.value)
    line = text[: text.index(before)].count("\n") + 1
    assert ("world.yaml" if "kind" in before else f"world.yaml:{line}: ") in told.value.message


def test_a_missing_world_is_named(tmp_path):
    with pytest.raises(DeployError, match=r"nowhere\.yaml"):
        load_world_file(tmp_path / "nowhere.yaml")
