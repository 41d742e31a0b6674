from collections import Counter

import pytest

from aos_deploy.places import shipped
from aos_deploy.played.faults import PlayedFaults
from aos_lab.trials.setting import Setting, deployment_of
from aos_protocol.errors import DeployError

SKILLS = ("pick", "serve")


@pytest.mark.parametrize(
    ("chances", "message", "hint"),
    [
        ({"lost_results": 0.1}, "`lost_results` is no fault", "Did you mean `lost_result`?"),
        ({"pikc.lost_result": 0.1}, "`pikc.lost_result` is of no skill", "Did you mean `pick`?"),
        ({"no_answer": 1.5}, "no probability but 1.5", "from 0 to 1"),
        ({"no_answer": 0.6, "pick.lost_result": 0.6}, "faults of pick have the probability 1.2", "sum is 1"),
    ],
)
def test_what_cannot_be_is_refused_with_what_was_meant(chances, message, hint):
    with pytest.raises(DeployError) as caught:
        PlayedFaults(chances).check(SKILLS)
    assert message in caught.value.message
    assert hint in caught.value.hint


def test_faults_come_as_often_as_wanted_and_one_skill_may_have_its_own():
    faults = PlayedFaults({"failed_call": 0.1, "lost_result": 0.2, "no_answer": 0.3, "pick.lost_result": 0})
    faults.check(SKILLS)
    drawn = {
        skill: Counter(faults.drawn(skill, seed, step) for seed in range(200) for step in range(20))
        for skill in SKILLS
    }
    shares = {
        skill: {fault: count / 4000 for fault, count in counts.items()} for skill, counts in drawn.items()
    }
    expected = {"failed_call": 0.1, "lost_result": 0.2, "no_answer": 0.3, "": 0.4}
    assert shares["serve"] == pytest.approx(expected, abs=0.03)
    assert shares["pick"] == pytest.approx({"failed_call": 0.1, "no_answer": 0.3, "": 0.6}, abs=0.03)


def test_a_mission_has_the_same_faults_whenever_it_is_run():
    faults = PlayedFaults({"lost_result": 0.5})
    first, again = ([faults.drawn("pick", 7, step) for step in range(40)] for _ in range(2))
    assert first == again
    assert len(set(first)) == 2


def test_a_mission_of_the_model_in_this_process_has_no_faults_and_says_which_has(tmp_path):
    setting = Setting(deploy="armadillo.yaml", faults={"lost_result": 0.1})
    with pytest.raises(DeployError) as caught:
        deployment_of(setting, shipped("deploy"), tmp_path)
    assert "by: system-model" in caught.value.hint
