"""World files of the simulated rooms, and what is wrong in them."""

from pathlib import Path

import pytest

pytest.importorskip("pybullet", reason="needs the simulator: pip install 'aos-autonomy[sim]'")

from aos_protocol.errors import DeployError
from aos_skills.pybullet.world_file import load_world_file

pytestmark = pytest.mark.physics


@pytest.mark.parametrize(
    ("world", "before", "after", "place"),
    [
        ("armadillo", "arm_stays_out: 0.2", "arm_stays_out: 2", "$.faults.arm_stays_out"),
        ("armadillo", "pose_noise_m: 0.0036", "pose_noise_m: -1", "$.faults.pose_noise_m"),
        ("armadillo", "radius: 0.033", "radius: 0", "$.tables[...].can.radius"),
        ("armadillo", "pose_noise_m: 0.0036", "pose_noise: 0", "unknown field `pose_noise`"),
        ("armadillo", "misplaced: 0.09", "misplaced: .nan", "$.tables[...].can.misplaced"),
    ],
)
def test_numbers_that_cannot_be_are_told_with_their_place(root: Path, tmp_path, world, before, after, place):
    text = (root / f"deploy/worlds/{world}.yaml").read_text()
    assert before in text
    (tmp_path / "world.yaml").write_text(text.replace(before, after))
    with pytest.raises(DeployError) as told:
        load_world_file(tmp_path / "world.yaml")
    assert place in told.value.message
    line = text[: text.index(before)].count("\n") + 1
    assert f"world.yaml:{line}: " in told.value.message
