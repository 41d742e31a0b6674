import math
from typing import Any

import msgspec
import pytest

from aos_deploy.places import shipped
from aos_lab.commands.experiment import verdict_line
from aos_lab.experiments.results import simulated_speed
from aos_lab.trials.claims import Around, Before, Claim, Count, When, asking_the_world, judge, matches
from aos_lab.trials.files import read_experiment, read_script_file, read_test_file
from aos_lab.trials.intervals import Interval, interval_of_mean, interval_of_share
from aos_lab.trials.junit import failed_missions, verdict_text
from aos_lab.trials.setting import deployment_of
from aos_lab.trials.trial import Trial
from aos_protocol.errors import DeployError


def trial(*steps: str, seed: int = 1, ending: str = "goal", states: tuple[str, ...] = ()) -> Trial:
    pairs = [step.split(" > ") for step in steps]
    return Trial(
        seed=seed,
        ending=ending,
        goal=ending == "goal",
        actions=tuple(action for action, _ in pairs),
        responses=tuple(response for _, response in pairs),
        states=states,
    )


def check(**asked: Any) -> Claim:
    return Claim(says="", **asked)


DELIVERED = trial("pick > ok", "sense > empty", "sense > full", "go(to=hall) > there", "serve > done")


@pytest.mark.parametrize(
    ("pattern", "names"),
    [
        ("go", True),
        ("go(to=hall)", True),
        ("go(to=*", True),
        ("go > there", True),
        ("pick | go", True),
        ("go > lost", False),
        ("go(to=attic)", False),
        ("g", False),
    ],
)
def test_a_pattern_names_an_action_with_or_without_parameters_and_response(pattern, names):
    assert matches(pattern, "go(to=hall) > there") is names


@pytest.mark.parametrize(
    ("claim", "holds"),
    [
        (check(first="pick"), True),
        (check(first="serve"), False),
        (check(last="serve"), True),
        (check(last="pick"), False),
        (check(some="sense > full"), True),
        (check(some="sense > broken"), False),
        (check(never="drop"), True),
        (check(never="sense"), False),
        (check(order=("pick", "sense > full", "serve")), True),
        (check(order=("serve", "pick")), False),
        (check(never_order=("serve", "pick")), True),
        (check(never_order=("pick", "serve")), False),
        (check(before=Before(step="serve", comes="sense > full", since="pick")), True),
        (check(before=Before(step="serve", comes="sense", times=3)), False),
        (check(before=Before(step="serve", comes="sense", since="go")), False),
        (check(count=Count(step="sense", at_least=2, at_most=2)), True),
        (check(count=Count(step="sense", at_most=1)), False),
        (check(actions=DELIVERED.actions), True),
        (check(actions=("pick",)), False),
        (check(endings=("over", "goal")), True),
        (check(endings=("failure",)), False),
        (check(goal=True), True),
        (check(goal=False), False),
    ],
)
def test_each_check_can_hold_and_can_fail(claim, holds):
    assert judge(claim, [DELIVERED]).is_seen is holds


def test_nothing_is_claimed_of_states_that_nobody_knows():
    claim = check(never_state="hurt=true | lost=true")
    unknown = judge(claim, [DELIVERED])
    assert not unknown.is_seen
    assert failed_missions(unknown, [DELIVERED])[0].endswith("; no state of the world was recorded")
    known = trial("a > b", states=("hurt=false, lost=false",))
    assert judge(claim, [known]).is_seen
    assert not judge(claim, [trial("a > b", states=("hurt=false, lost=true",))]).is_seen


WORLD = trial(
    "pick > ok",
    "go > there",
    "serve > done",
    states=('{"step": 1, "held": true}', '{"step": 3, "held": false, "served": true}'),
)


@pytest.mark.parametrize(
    ("claim", "holds"),
    [
        (check(starts=("pick", "go")), True),
        (check(starts=("pick", "serve")), False),
        (check(starts=("pick", "go", "serve", "*")), False),
        (check(first_state='"held": true'), True),
        (check(first_state='"held": false'), False),
        (check(last_state='"served": true | never'), True),
        (check(last_state='"held": true'), False),
        (check(around=Around(step="serve", before='"held": true', after='"served": true')), True),
        (check(around=Around(step="serve", before='"held": false')), False),
        (check(around=Around(step="pick", after='"held": false')), False),
        (check(around=Around(step="pick", before='"held"')), False),
        (check(around=Around(step="go", after='"held"')), False),
    ],
)
def test_the_world_is_asked_at_steps_and_knows_nothing_of_calls_that_it_has_not_seen(claim, holds):
    assert judge(claim, [WORLD]).is_seen is holds


def test_a_model_says_how_its_world_ended():
    ended = Trial(seed=1, ending="goal", goal=False, actions=("a",), responses=("b",), states=("x=1",))
    assert not judge(check(last_state="world_ending=failure"), [ended]).is_seen
    ended = msgspec.structs.replace(ended, world_ending="failure")
    assert judge(check(last_state="world_ending=failure"), [ended]).is_seen


def test_the_goal_of_a_system_is_asked_of_the_world_where_somebody_knows_it():
    claim = check(goal=True)
    asked = asking_the_world(claim, "system", '"served": true')
    lies = trial("pick > ok", states=('{"step": 1, "served": false}',))
    assert judge(claim, [lies]).is_seen
    assert not judge(asked, [lies]).is_seen
    assert judge(asked, [WORLD]).is_seen
    assert asking_the_world(claim, "model", '"served": true') == claim
    assert asking_the_world(claim, "system", "") == claim


def test_a_claim_about_some_missions_leaves_the_others_out():
    claim = check(when=When(some="serve"), first="pick")
    verdict = judge(claim, [DELIVERED, trial("wait > ok", seed=2)])
    assert (verdict.held, verdict.missions, verdict.is_seen) == (1, 1, True)
    assert not judge(claim, [trial("wait > ok")]).is_seen, "no mission shows it"


def test_a_mission_that_broke_counts_against_every_claim():
    broken = Trial(seed=3, ending="fault", goal=False, fault="the engine has ended")
    verdict = judge(check(never="drop", share=0.5), [DELIVERED, broken])
    assert verdict.failed_seeds == (3,)
    assert verdict.share.value == 0.5


def test_surely_asks_the_lower_end_of_the_interval():
    ten = [trial("a > b", seed=seed) for seed in range(10)]
    assert judge(check(goal=True, share=0.8), ten).is_seen
    assert not judge(check(goal=True, share=0.8, surely=True), ten).is_seen
    assert judge(check(goal=True, share=0.7, surely=True), ten).is_seen


def test_a_claim_that_fails_though_it_held_is_told_with_its_reason():
    unsure = judge(check(goal=True, share=0.9, surely=True), [DELIVERED])
    assert verdict_text(unsure).endswith("; wanted 0.90 at the lower end; more missions may tell)")
    assert verdict_line("part", unsure).endswith("more missions may tell)")
    about_none = judge(check(goal=True, when=When(some="fly")), [DELIVERED])
    assert (about_none.is_seen, verdict_text(about_none)) == (False, "no mission was one that it is about")


def test_intervals_are_those_of_the_tables():
    share = interval_of_share(18, 20)
    assert (share.low, share.high) == pytest.approx((0.699, 0.972), abs=0.001)
    mean = interval_of_mean([1.0, 2.0, 3.0, 4.0, 5.0])
    assert mean.high - mean.value == pytest.approx(2.776 * (2.5 / 5) ** 0.5, abs=0.01)
    assert interval_of_mean([1.0]) == Interval(1.0, -math.inf, math.inf)
    assert interval_of_mean([]) is None


def test_everything_wrong_with_a_test_file_is_found_at_its_place(tmp_path):
    path = tmp_path / "missions.yaml"
    path.write_text(
        "aos: 1\ntests:\n  one:\n    deploy: x.yaml\n    seeds: 0\n    claims:\n"
        "      - says: nothing\n      - {says: much, frist: pick}\n      - nobody\n"
        f"  two: {{deploy: {shipped('deploy/armadillo.yaml')}, by: system-model,\n"
        "    faults: {pik.no_answer: 1}}\n"
    )
    with pytest.raises(DeployError) as caught:
        read_test_file(path)
    found = [f"{finding.code} {finding.span.line}" for finding in caught.value.diagnostics]
    assert caught.value.code == "AOS808"
    assert found == ["AOS106 5", "AOS105 7", "AOS102 8", "AOS106 9", "AOS105 10", "AOS106 11"]


@pytest.mark.parametrize(
    "path", sorted(shipped("deploy/experiments").glob("*.yaml")), ids=lambda path: path.stem
)
def test_shipped_experiments_name_what_is_there(path, tmp_path):
    for part in read_experiment(path).parts.values():
        deployment_of(part, path.parent, tmp_path)


@pytest.mark.parametrize(
    "path", sorted(shipped("deploy/experiments/statistics").glob("*.yaml")), ids=lambda path: path.stem
)
def test_shipped_scripts_name_what_is_there(path, tmp_path):
    file = read_script_file(path)
    for part in file.parts.values():
        assert deployment_of(part, path.parent, tmp_path).world is not None
    for bundles in file.calibrates.values():
        assert all((path.parent / bundle).is_dir() for bundle in bundles)


def test_a_part_without_a_script_is_told_with_its_place(tmp_path):
    path = tmp_path / "scripts.yaml"
    path.write_text("aos: 1\ntitle: T\nparts:\n  one: {deploy: x.yaml, missions: 2}\n")
    with pytest.raises(DeployError) as caught:
        read_script_file(path)
    assert [(finding.code, finding.span.line) for finding in caught.value.diagnostics] == [("AOS105", 4)]


def test_speed_is_simulated_time_for_processor_time():
    line = '{"time_s": %g, "processor_s": %g}'
    whole = Trial(seed=1, ending="goal", goal=True, states=(line % (10.0, 1.0), line % (30.0, 2.0)))
    assert simulated_speed([whole]) == 10.0
    assert simulated_speed([Trial(seed=2, ending="goal", goal=True, states=("at=Home",))]) is None


def test_a_claim_about_none_of_the_missions_is_said_to_have_no_case():
    claim = check(first="pick", when=When(some="drop"))
    assert (judge(claim, [DELIVERED]).is_seen, judge(claim, [DELIVERED]).word) == (False, "no case")
    assert judge(check(first="serve"), [DELIVERED]).word == "not seen"
