import re

import pytest
from msgspec.structs import replace
from PIL import Image

from aos_lab.calibration.records import RecordedMission, RecordedStep
from aos_lab.experiments.optimum import Optimum, regret_of
from aos_lab.experiments.plots import draw_plots
from aos_lab.experiments.report import write_report
from aos_lab.experiments.results import PartResult, Results, Surroundings, figures_of, keep_picture, result_of
from aos_lab.experiments.statistics import steps_of
from aos_lab.trials.campaign import Played
from aos_lab.trials.claims import Claim
from aos_lab.trials.files import Experiment, Part
from aos_lab.trials.trial import Trial

SERVED = Trial(
    seed=1,
    ending="goal",
    goal=True,
    actions=("pick", "look", "look", "serve"),
    responses=("done", "empty", "full", "done"),
    states=('{"has_drink": false}', '{"has_drink": true}'),
    value=20.0,
)
GAVE_UP = Trial(
    seed=2, ending="nothing_worthwhile", goal=False, actions=("pick",), responses=("",), value=-2.0
)
BROKE = Trial(seed=3, ending="fault", goal=False, fault="the engine | has ended")
MISSIONS = (SERVED, GAVE_UP, BROKE)


def part_of(by: str, trials: tuple[Trial, ...] = MISSIONS) -> PartResult:
    part = Part(deploy="robot.yaml", claims=(Claim(says="it | picks first", first="pick", share=0.9),))
    experiment = Experiment(
        aos=1, title="T", counts={"looked": "look"}, truth='"has_drink": true', parts={"one": part}
    )
    return result_of("one", part, by, Played(trials, "digest"), experiment)


def results_of(*parts: PartResult) -> Results:
    around = Surroundings(date="2026-11-22", machine="a machine", versions={"aos": "1"}, commit="abc")
    return Results(name="t", title="T", about="A", command="aos it", surroundings=around, parts=parts)


def test_a_mission_that_broke_counts_against_the_goal_and_in_nothing_else():
    figures = figures_of(MISSIONS, {"looked": "look"}, '"has_drink": true')
    assert (figures.missions, figures.broken) == (3, 1)
    assert figures.goal.value == pytest.approx(1 / 3)
    assert figures.world_goal.value == pytest.approx(1 / 3)
    means = (figures.steps, figures.value, figures.counts["looked"])
    assert [mean.value for mean in means if mean is not None] == [2.5, 9.0, 1.0]
    assert figures.endings == {"goal": 1, "nothing_worthwhile": 1, "fault": 1}
    assert figures.first_actions == {"pick": 2}


def test_whether_the_goal_was_reached_in_the_world_is_asked_of_its_last_state():
    once = Trial(seed=1, ending="goal", goal=True, states=('{"has_drink": true}', '{"has_drink": false}'))
    figures = figures_of([once], {}, '"has_drink": true')
    assert figures.world_goal.value == 0
    assert figures_of([once], {}).world_goal is None


@pytest.mark.parametrize(("stop_value", "mean"), [(None, 9.0), (-10.0, (20.0 + -2.0 + 0.9 * -10.0) / 2)])
def test_a_mission_that_stopped_is_worth_what_stopping_is_worth(stop_value, mean):
    optimum = Optimum(lower=11.0, upper=13.0, discount=0.9, stop_value=stop_value)
    regret = regret_of(optimum, MISSIONS)
    assert regret.value.value == pytest.approx(mean)
    assert regret.share.value == pytest.approx((12.0 - mean) / regret.scale)
    assert regret.share.low < regret.share.value < regret.share.high


def test_missions_that_all_bring_the_same_have_no_range_to_compare_with():
    optimum = Optimum(lower=1.0, upper=1.0, discount=0.9, stop_value=None)
    assert regret_of(optimum, [SERVED, SERVED]) is None
    assert regret_of(optimum, [SERVED]) is None


def test_a_report_has_claims_figures_faults_and_what_it_was_made_with(tmp_path):
    results = results_of(part_of("model"), part_of("system", (SERVED,)))
    page, whole = write_report(results, draw_plots(results, tmp_path / "plots"), tmp_path)
    text = page.read_text()
    assert "| part | claim | played by model | played by system |" in text
    broken = "**not seen**: 2 of 3 [0.21, 0.94], wanted 0.90, not in seeds 3"
    assert f"| one | it \\| picks first | {broken} | " in text
    assert "| one | model | 3 (1 broke) | 0.33 [0.06, 0.79] |" in text
    assert "- one, model, seed 3: the engine | has ended" in text
    assert "`aos it`, 2026-11-22, a machine; aos 1, commit abc." in text
    assert "plots/" not in text
    assert "<svg" in whole.read_text()


def test_a_part_whose_optimum_cannot_be_worked_out_says_why_beside_the_others(tmp_path):
    part = replace(part_of("model"), no_optimum="what is observed are numbers")
    page, _ = write_report(results_of(part), {}, tmp_path)
    assert "| one | 3 |  |  | what is observed are numbers |  |  |" in page.read_text()


def test_one_mission_has_figures_without_intervals_in_the_page(tmp_path):
    results = results_of(part_of("system", (SERVED,)))
    page, _ = write_report(results, draw_plots(results, tmp_path / "plots"), tmp_path)
    text = page.read_text()
    assert "| one | system | 1 | 1.00 [0.21, 1.00] | 1.00 [0.21, 1.00] | 20.00 | 4.00 |  |" in text
    assert "| one | system | 2.00 | goal 1 | pick 1 |" in text


def test_less_and_greater_in_a_text_are_text_in_the_page(tmp_path):
    results = replace(results_of(part_of("model")), about="value <b of it> is small")
    _, whole = write_report(results, {}, tmp_path)
    assert "value &lt;b of it&gt; is small" in whole.read_text()


def test_the_same_figures_give_the_same_drawings_with_a_row_for_each_part(tmp_path):
    results = results_of(part_of("model"), part_of("system", (SERVED, GAVE_UP)))
    first, again = (draw_plots(results, tmp_path / name) for name in ("first", "again"))
    assert set(first) == {
        "share of missions that reach the goal",
        "discounted return",
        "steps",
        "looked, times in a mission",
    }
    for title, path in first.items():
        assert path.read_bytes() == again[title].read_bytes()
    drawn = first["steps"].read_text()
    assert ">one (model, 3)<" in drawn
    assert ">one (system, 2)<" in drawn


def test_the_picture_is_the_last_one_of_the_first_mission_that_has_some(tmp_path):
    for seed, steps in ((2, 2), (3, 1)):
        pictures = tmp_path / "runs" / f"seed-{seed}" / "a-run" / "pictures"
        pictures.mkdir(parents=True)
        for step in range(1, steps + 1):
            Image.new("RGB", (2, 1), (seed, step, 9)).save(pictures / f"step-{step:03}.png")
    kept = keep_picture(tmp_path / "runs", (1, 2, 3), tmp_path / "kept" / "one.webp")
    assert Image.open(kept).getpixel((1, 0)) == (2, 2, 9)
    assert keep_picture(tmp_path / "runs", (1,), tmp_path / "other.webp") is None


def test_statistics_tell_what_came_back_and_what_each_step_changed():
    def mission(response: str, place: str) -> RecordedMission:
        steps = (
            RecordedStep("go", "there", (("at", "table"), ("can", "table"))),
            RecordedStep("pick", response, (("at", "table"), ("can", place))),
        )
        return RecordedMission("m", steps)

    missions = [mission("done", "hand"), mission("done", "floor"), mission("failed", "table")]
    first, second = steps_of("script", missions)
    assert (first.number, first.action, first.became) == (1, "go", {"nothing": 3})
    assert {name: round(share.value, 2) for name, share in second.responses.items()} == {
        "done": 0.67,
        "failed": 0.33,
    }
    assert second.became == {"can=hand": 1, "can=floor": 1, "nothing": 1}
    assert list(steps_of("script", [])) == []


def test_a_dot_stands_at_its_share_between_the_ticks(tmp_path):
    results = results_of(part_of("model", (SERVED, GAVE_UP)))
    drawn = draw_plots(results, tmp_path)["share of missions that reach the goal"].read_text()
    (dot,) = (float(x) for x in re.findall(r'"M([\d.]+) \d+h0"', drawn))
    ticks = {label: float(x) for x, label in re.findall(r'<text x="([\d.]+)"[^>]*>([\d.]+)<', drawn)}
    assert set(ticks) == {"0", "0.2", "0.4", "0.6", "0.8", "1"}
    assert dot == pytest.approx((ticks["0"] + ticks["1"]) / 2, abs=0.2)
