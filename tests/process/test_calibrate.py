import asyncio
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest
from places import DEPLOY
from processes import finished
from projects import files_project

from aos_deploy.export.run_bundle import write_bundle
from aos_lab.calibration.calibrate import Calibration, calibrate
from aos_lab.calibration.draws import draws_of
from aos_lab.calibration.records import RecordedMission, read_missions
from aos_lab.trials.campaign import play_campaign
from aos_lab.trials.setting import Setting
from aos_protocol.errors import ModelError
from aos_protocol.messages import MissionBegun, StartMission
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import make_mission_folder, mission_folder
from aos_solver.building.compiler import find_compiler

AOS = Path(sys.executable).parent / "aos"
FINER, RETRACT = DEPLOY / "bundles" / "armadillo-finer", DEPLOY / "bundles" / "armadillo-retract"

ENVIRONMENT = b"""project: lamp
horizon: 3
discount: 0.9

state_variable: bool is_on
code:
state.is_on = false;

initial_belief:
state.is_on = AOS.Bernoulli(0.5);
"""
PRESS = b"""project: lamp

dynamic_model:
const double works = 0.8;
enum Colour { Red, Green };
if (AOS.Bernoulli(works)) state__.is_on = !state.is_on;
double wear = 0.1;
bool flickers = AOS.Bernoulli(1 - wear);
for (int turn = 0; turn < 2; ++turn) flickers = flickers && AOS.Bernoulli(0.9);
Colour colour = AOS.SampleDiscrete(Colour, {0.25, /* , */ 0.75});
__moduleResponse = state__.is_on ? on : off;
__reward = flickers + (colour == Green);
"""
MAPPING = b"""project: lamp

response: on
response_rule: True
response: off
response_rule: True

module_activation: skill
path: /press
"""


def recorded(folder: Path, deploy_file: str, first_seed: int, missions: int) -> tuple[RecordedMission, ...]:
    """Missions of the documents' own model, from the file that an experiment keeps."""
    setting = Setting(deploy=deploy_file, simulations=2000)
    seeds = range(first_seed, first_seed + missions)
    asyncio.run(play_campaign(setting, seeds, folder=DEPLOY, out=folder, on_trial=lambda: None))
    return read_missions(folder)


@pytest.fixture(scope="module")
def missions_of_finer(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("finer")
    recorded(folder, "armadillo.yaml", 1, 40)
    return folder


def covered(result: Calibration) -> list[bool]:
    """Returns for each probability that was drawn whether the interval holds the number that it was drawn
    with."""
    return [
        outcome.is_inside
        for estimate in result.estimates
        if estimate.count
        for outcome in (estimate.outcomes[1:] if estimate.draw.kind == "Bernoulli" else estimate.outcomes)
    ]


def test_intervals_cover_the_numbers_that_missions_were_drawn_with(missions_of_finer: Path):
    result = calibrate(read_missions(missions_of_finer), [FINER, RETRACT])
    assert not result.remarks
    assert all(estimate.is_counted for estimate in result.estimates)
    held = covered(result)
    # Of intervals that hold 95 % of the time, one of eight may well miss.
    assert len(held) == 8
    assert held.count(False) <= 1


def test_a_model_that_is_compiled_first_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    compiler = tmp_path / "c++"
    real = shlex.join(asyncio.run(find_compiler()).command)
    compiler.write_text(f'#!/bin/sh\ncase "$*" in *version*) exec {real} "$@";; esac\nexit 1\n')
    compiler.chmod(0o755)
    monkeypatch.setenv("CXX", str(compiler))
    monkeypatch.setenv("AOS_CACHE_DIR", str(tmp_path))
    told: list[str] = []
    with pytest.raises(ModelError):
        calibrate((), [FINER, RETRACT], on_build=told.append)
    assert told[0].startswith("compiling armadillo with")


def test_what_nobody_recorded_is_left_open_and_the_intervals_are_wider(tmp_path):
    recorded_missions = recorded(tmp_path, "armadillo-rough-blind.yaml", 1, 15)
    unseen = tuple(
        msgspec.structs.replace(
            mission, steps=tuple(msgspec.structs.replace(step, truth=()) for step in mission.steps)
        )
        for mission in recorded_missions
    )
    bundles = [FINER, FINER.with_name("armadillo-rough"), RETRACT]
    results = [calibrate(missions, bundles) for missions in (recorded_missions, unseen)]
    picks = [next(e for e in result.estimates if e.draw.skill == "pick") for result in results]
    widths = [pick.outcomes[0].probability.high - pick.outcomes[0].probability.low for pick in picks]
    assert picks[0].is_counted
    assert not picks[1].is_counted
    assert widths[1] > widths[0]
    assert all(covered(results[0]))
    assert all(covered(results[1]))


def test_a_wrong_number_is_told_with_a_patch_that_mends_it(missions_of_finer: Path, tmp_path):
    shutil.copytree(FINER, tmp_path / "bundle")
    pick = tmp_path / "bundle" / "pick.sd"
    wrong = pick.read_text().replace("{0.727, 0.181, 0.09, 0.0}", "{0.2, 0.181, 0.619, 0.0}")
    pick.write_text(wrong)

    (tmp_path / "beside").mkdir()

    def run(*options: str) -> subprocess.CompletedProcess[str]:
        return finished(
            AOS,
            "calibrate",
            missions_of_finer,
            "../bundle",
            "--also",
            RETRACT,
            *options,
            cwd=tmp_path / "beside",
            env={**os.environ, "COLUMNS": "120"},
        )

    done = run("--write", "changes.patch")
    assert done.returncode == 0, done.stderr
    assert "pick.sd:13" in done.stdout
    assert "OUTSIDE" in done.stdout
    assert "no record" in done.stdout  # of the hard table, where the robot never picks
    assert pick.read_text() == wrong
    by = re.findall("`(git .*)`", done.stdout)[-1].split()
    patched = subprocess.run(by, cwd=tmp_path / "beside", capture_output=True, check=False)
    assert patched.returncode == 0, patched.stderr
    result = json.loads(run("--json").stdout)
    assert result["patch"] == ""


def test_a_folder_without_missions_is_refused(tmp_path):
    run = finished(AOS, "calibrate", tmp_path, FINER)
    assert run.returncode == 1
    assert "AOS801" in run.stderr
    assert "holds no recorded missions" in run.stderr


def test_a_mission_that_began_with_a_kept_belief_is_not_explained_from_the_initial_one(tmp_path):
    starts = [StartMission(), StartMission(belief="keep"), StartMission(idle=2), None]
    for number, start in enumerate(starts, 1):
        make_mission_folder(tmp_path, number)
        with Journal.open(mission_folder(tmp_path, number) / "journal.db") as journal:
            journal.append("begun", MissionBegun(f"lamp-{number}", 1, number, 1, "", start=start))
    missions = read_missions(tmp_path)
    assert [bool(mission.ends_early) for mission in missions] == [False, True, True, False]
    assert "did not begin with the initial belief" in missions[1].ends_early
    (tmp_path / "run.json").touch()
    inbox = tmp_path.with_name("inbox")
    inbox.mkdir()
    sent = inbox / "sent.aosrun"
    write_bundle([tmp_path], sent)
    assert read_missions(sent) == read_missions(inbox)
    assert read_missions(inbox)[0].name == f"{sent}/{tmp_path.name}/missions/1"
    shutil.copytree(tmp_path / "missions", inbox / tmp_path.name / "missions")
    assert len(read_missions(inbox)) == len(starts), "a run in both is read once"


def test_the_draws_of_documents_are_found_with_their_numbers():
    files = {"lamp.ef": ENVIRONMENT, "press.sd": PRESS, "press.am": MAPPING}
    draws = draws_of(files_project(files))
    assert [(draw.kind, draw.texts, draw.outcomes) for draw in draws.draws] == [
        ("Bernoulli", ("0.8",), ("false", "true")),
        ("SampleDiscrete", ("0.25", "0.75"), ("Red", "Green")),
        ("Bernoulli", ("0.5",), ("false", "true")),
    ]
    # A constant stands where it is declared.
    assert str(draws.draws[0].places[0]).startswith("press.sd:4:")
    assert [(skipped.span.line, skipped.why) for skipped in draws.skipped] == [
        (8, "its probability is computed, and no number of the document"),
        (9, "it is drawn in a loop"),
    ]


def test_missions_are_explained_with_the_values_that_they_had(tmp_path):
    missions: list[RecordedMission] = []
    for person in ("alice", "bob"):
        setting = Setting(deploy="errand.yaml", simulations=500, set={"target": person})
        out = tmp_path / person
        asyncio.run(play_campaign(setting, range(1, 5), folder=DEPLOY, out=out, on_trial=lambda: None))
        missions += read_missions(out)
    assert {mission.mission_parameters["target"] for mission in missions} == {"alice", "bob"}
    result = calibrate(missions, [DEPLOY / "bundles" / "errand"])
    assert (result.missions, result.remarks) == (8, ())
    assert result.steps == sum(len(mission.steps) for mission in missions)


def test_a_deploy_file_stands_for_its_bundles_without_the_skills_that_it_leaves_out():
    left_out = calibrate([], [DEPLOY / "armadillo-hotplug.yaml"])
    whole = calibrate([], [FINER])
    places = [{estimate.draw.span.file for estimate in each.estimates} for each in (left_out, whole)]
    assert "pick.sd" in places[0]
    assert places[1] - places[0] == {"observe_holding.sd"}
