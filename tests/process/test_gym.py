import subprocess
import sys
import traceback
from pathlib import Path

import pytest
from places import BUNDLES
from processes import COMMAND_S, finished

pytest.importorskip("gymnasium", reason="needs gymnasium: pip install 'aos-autonomy[gym]'")

import numpy as np
from gymnasium.error import ClosedEnvironmentError, InvalidAction
from gymnasium.utils.env_checker import check_env
from texts import write_texts

from aos_lab.gym import AosEnv, AosVectorEnv
from aos_protocol.errors import DeployError

KETTLE = {
    "kettle.ef": """project: kettle
horizon: 5
discount: 0.9
state_variable: int degrees
reward_code:
if (state.degrees > 3) {
    __reward = 10;
    __isGoalState = true;
}
""",
    "heat.sd": """project: kettle
dynamic_model:
if (AOS.Bernoulli(0.5)) state__.degrees++;
__moduleResponse = state__.degrees < 2 ? cold : warm;
__reward = -1;
""",
}
READING = {
    "read.sd": """project: kettle
dynamic_model:
__moduleResponseStr = state.degrees > 1 ? "warm" : "cold";
"""
}
SENSING = {
    "sense.sd": """project: kettle
dynamic_model:
__moduleResponse = sensed;
__observed.weight = AOS.SampleNormal(7, 0.5);
for (int i = 1; i < 3; i++) __observed.echoes.push_back(AOS.SampleUniform(i, i + 1));
"""
}


@pytest.fixture
def kettle(tmp_path) -> Path:
    write_texts(KETTLE, tmp_path)
    return tmp_path


def add_reading(folder: Path) -> Path:
    write_texts(READING, folder)
    return folder


def test_gymnasiums_own_checks_pass(kettle: Path):
    environment = AosEnv(kettle, max_episode_steps=20)
    check_env(environment, skip_render_check=True)
    environment.close()


def test_an_episode_ends_at_the_goal_and_tells_it_in_words(kettle: Path):
    environment = AosEnv(kettle)
    observation, _ = environment.reset(seed=1)
    assert observation == 0
    total = steps = 0.0
    is_over = False
    while not is_over:
        observation, reward, is_over, is_cut, info = environment.step(0)
        total, steps = total + reward, steps + 1
    assert total == 10 - steps
    assert not is_cut
    assert info == {"action": "heat", "response": "warm", "ending": "goal"}
    assert environment.response_names[int(observation)] == "warm"
    environment.close()


def test_many_worlds_start_anew_when_they_are_over_and_repeat_with_their_seed(kettle: Path):
    def story(seed: int) -> list[np.ndarray]:
        first, _ = worlds.reset(seed=seed)
        values_of_story = [first]
        was_over = np.zeros(32, bool)
        for _ in range(30):
            observations, rewards, terminated, truncated, _ = worlds.step(worlds.action_space.sample())
            assert (observations[was_over] == 0).all()
            assert (rewards[was_over] == 0).all()
            assert (terminated == (rewards == 9)).all()
            was_over = terminated | truncated
            values_of_story += [observations, rewards, terminated, truncated]
        assert any(values.any() for values in values_of_story[3::4])
        return values_of_story

    worlds = AosVectorEnv(kettle, 32, max_episode_steps=6)
    first, again, other = story(1), story(1), story(2)
    assert all((left == right).all() for left, right in zip(first, again, strict=True))
    assert any((left != right).any() for left, right in zip(first, other, strict=True))
    worlds.close()


def test_text_observations_are_bytes(kettle: Path):
    environment = AosEnv(add_reading(kettle), max_episode_steps=20)
    check_env(environment, skip_render_check=True)
    environment.reset(seed=1)
    observation, *_ = environment.step(environment.action_names.index("read"))
    assert bytes(observation).rstrip(b"\0") == b"cold"
    environment.close()


@pytest.mark.filterwarnings("ignore:.*A Box observation space m.* value is -?infinity")
def test_numbers_beside_a_response_have_columns(kettle: Path):
    """An array has as many columns as there is room for; what a response does not report is marked."""
    write_texts(SENSING, kettle)
    environment = AosEnv(kettle, max_episode_steps=20, array_room=3)
    check_env(environment, skip_render_check=True)
    assert environment.number_names == ("echoes[0]", "echoes[1]", "echoes[2]", "weight")
    environment.close()
    worlds = AosVectorEnv(kettle, 200, array_room=3)
    assert worlds.action_names == ("heat", "sense")
    worlds.reset(seed=1)
    actions = np.arange(200) % 2
    observed, *_ = worlds.step(actions)
    assert observed["numbers"].shape == observed["reported"].shape == (200, 4)
    assert worlds.observation_space.contains(observed)
    is_sensed = actions == 1
    assert (observed["reported"][is_sensed] == [1, 1, 0, 1]).all()
    assert not observed["reported"][~is_sensed].any()
    assert not observed["numbers"][~is_sensed].any()
    weights = observed["numbers"][is_sensed, 3]
    assert abs(weights.mean() - 7) < 0.2
    assert ((observed["numbers"][is_sensed, 0] >= 1) & (observed["numbers"][is_sensed, 0] <= 2)).all()
    worlds.close()


def test_the_command_prints_the_spaces_and_a_program_that_runs(kettle: Path):
    command = [Path(sys.executable).parent / "aos", "gym", str(kettle), "--steps", "100", "--worlds", "10"]
    text = subprocess.run(command, check=True, capture_output=True, text=True, timeout=COMMAND_S).stdout
    assert "actions       Discrete(1): heat" in text
    assert "observations  Discrete(3): DefaultObservation, cold, warm" in text
    program = text[text.index("from aos_lab") :]
    subprocess.run([sys.executable, "-c", program], check=True, timeout=COMMAND_S)


def test_a_world_has_the_values_that_are_given_and_those_of_a_deploy_file(tmp_path):
    deploy, bundle = tmp_path / "errand.yaml", BUNDLES / "errand"
    deploy.write_text(f"aos: 1\nrobot: errand\nbundles: [{bundle}]\nmission: {{set: {{target: bob}}}}\n")
    for environment in (AosEnv(bundle, mission_values={"target": "bob"}), AosEnv(deploy)):
        assert "give(to=bob)" in environment.action_names
        assert "give(to=alice)" not in environment.action_names
        environment.close()


@pytest.mark.parametrize(
    ("action", "message"),
    [(-1, "no action -1: they are numbered from 0 to 0"), (1, "no action 1"), (0.5, "1 whole numbers")],
)
def test_an_action_that_there_is_not_is_refused(kettle: Path, action, message):
    world = AosEnv(kettle)
    world.reset(seed=1)
    with pytest.raises(InvalidAction, match=message):
        world.step(action)
    world.close()
    with pytest.raises(ClosedEnvironmentError):
        world.step(0)


def test_a_vector_takes_an_action_and_a_seed_for_each_world(kettle: Path):
    worlds = AosVectorEnv(kettle, num_envs=2, max_episode_steps=1)
    with pytest.raises(ValueError, match="2 seeds are needed, one for each world, and not 3"):
        worlds.reset(seed=[1, 2, 3])
    worlds.reset(seed=[1, 2])
    for actions in (np.zeros(3, np.int64), np.array([0, 1]), 0):
        with pytest.raises(InvalidAction):
            worlds.step(actions)
    worlds.step(np.zeros(2, np.int64))
    # Both episodes are cut here, and a world that starts anew needs no action.
    worlds.step(np.array([-1, 7]))
    worlds.close()


def test_no_worlds_and_no_steps_are_refused(kettle: Path):
    with pytest.raises(ValueError, match="num_envs needs to be at least 1"):
        AosVectorEnv(kettle, num_envs=0)
    with pytest.raises(ValueError, match="max_episode_steps needs to be at least 1"):
        AosEnv(kettle, max_episode_steps=0)


def test_a_traceback_tells_every_mistake_of_what_was_set():
    with pytest.raises(DeployError) as told:
        AosEnv(BUNDLES / "bench" / "tiger", mission_values={"drnik": 1})
    shown = "".join(traceback.format_exception(told.value))
    assert "AOS801: what is set for the mission has errors" in shown
    assert "drnik" in shown


def test_what_the_option_sets_wrongly_is_told_at_the_option():
    command = [
        Path(sys.executable).parent / "aos",
        "gym",
        str(BUNDLES / "bench" / "tiger"),
        "--set",
        "drnik=1",
    ]
    told = finished(*command).stderr
    assert told.startswith("--set drnik=1: error[AOS146]")
    assert "drnik" in told
