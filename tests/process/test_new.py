import json
from pathlib import Path
from typing import Any

import msgspec
import pytest
import typer
from commands import aos
from projects import bundle_project
from typer.testing import Result

from aos_deploy.deployment.reading import read_deploy_file
from aos_deploy.places import deploy_files
from aos_language.convert import without_origins
from aos_language.load import load_bundle


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def run(line: str) -> Result:
    return aos(*line.split())


def test_a_new_project_with_a_new_skill_lints_clean_plans_and_reaches_its_goal():
    made = run("new project fetch")
    assert made.exit_code == 0
    assert "wrote fetch/fetch.ef\n" in made.output
    assert "aos plan fetch" in made.output
    assert run("new skill wipe --in fetch").exit_code == 0
    linted = run("lint fetch")
    assert linted.exit_code == 0
    assert linted.output.endswith("fetch: 0 errors, 0 warnings\n")
    planned = run("plan fetch --simulations 20000 --json")
    assert json.loads(planned.stdout)["action"] == "look"
    assert "exact: all 2 states can be listed" in run("plan fetch --simulations 20000").output
    played = run("simulate fetch --runs 5 --simulations 20000 --json")
    assert json.loads(played.stdout)["summary"]["goal_rate"] == 1.0


def test_a_project_in_json_says_the_same_as_one_in_sdl():
    assert run("new project fetch").exit_code == 0
    assert run("new project fetch --dialect json --in json").exit_code == 0
    assert run("new skill wipe --in fetch").exit_code == 0
    assert run("new skill wipe --in json/fetch").exit_code == 0
    assert {path.suffix for path in Path("json/fetch").iterdir()} == {".json"}
    sdl, json_bundle = load_bundle(Path("fetch")), load_bundle(Path("json/fetch"))
    assert json_bundle.diagnostics == ()
    assert without_origins(json_bundle.project) == without_origins(sdl.project)


def test_nothing_is_overwritten():
    run("new project fetch")
    Path("fetch/look.sd").write_text("mine")
    again = run("new project fetch")
    assert "already" in str(again.exception)
    assert Path("fetch/look.sd").read_text() == "mine"


@pytest.mark.parametrize("name", ["Fetch", "../fetch", "2do", "a-b", 65 * "n"])
def test_a_name_that_documents_cannot_have_is_refused(name):
    assert "is no name for a project" in str(run(f"new project {name}").exception)
    assert not list(Path().iterdir())


def test_a_skill_has_no_name_of_cpp():
    run("new project fetch")
    assert "means something else in C++" in str(run("new skill double --in fetch").exception)
    assert not Path("fetch/double.sd").exists()


def test_a_reader_that_has_gone_leaves_a_whole_project(monkeypatch):
    monkeypatch.setattr(typer, "echo", lambda text: 1 / 0)
    run("new project fetch")
    assert len(list(Path("fetch").iterdir())) == 5


def test_a_skill_needs_a_bundle():
    assert "aos new project" in str(run("new skill wipe").exception)


def test_a_new_skill_belongs_to_the_bundles_project():
    run("new project fetch")
    run("new skill wipe --in fetch")
    assert [skill.name for skill in bundle_project(Path("fetch")).skills] == ["look", "take", "wipe"]


@pytest.mark.parametrize("name", deploy_files())
def test_every_example_is_whole_where_it_is_written(name):
    written = run(f"new example {name}")
    assert written.exit_code == 0, written.output
    assert f"aos plan {name}/{name}.yaml --exact" in written.output  # A bundle may be a part of the whole.
    here = Path(name).resolve()
    deployment = read_deploy_file(Path(name, f"{name}.yaml"))
    assert all(bundle.is_relative_to(here) for bundle in deployment.bundles)
    assert deployment.world is None or deployment.world.resolve().is_relative_to(here)


def test_an_example_is_written_once():
    run("new example errand --in once")
    assert "once is not empty. Nothing was written" in str(run("new example errand --in once").exception)


def test_an_unknown_example_is_told_with_the_nearest():
    assert "Did you mean `armadillo`?" in str(getattr(run("new example armadilo").exception, "hint", ""))


@pytest.mark.parametrize(("kind", "plans_in_time"), [("class", True), ("command", True), ("model", False)])
def test_a_robot_plans_in_time_and_its_model_in_simulations(kind, plans_in_time):
    run("new project fetch")
    written = run(f"new adapter {kind} --in fetch")
    assert written.exit_code == 0, written.output
    solver = read_deploy_file(next(Path().glob("*.yaml"))).file.solver
    assert (solver.time_s is not None) == plans_in_time
    assert (solver.simulations is not None) != plans_in_time


def test_a_written_program_tells_a_late_skill_and_a_result_that_cannot_be_sent_from_a_failure(monkeypatch):
    run("new project fetch")
    run("new adapter command --in fetch")
    monkeypatch.setenv("AOS_ROBOT", "fetch")
    monkeypatch.setenv("AOS_ADAPTER", "robot")
    names: dict[str, Any] = {}
    exec(Path("fetch_robot.py").read_text().split("\nwith open(")[0], names)
    names["tell"] = lambda *_: None

    def code(deadline_s: float) -> str:
        request = {"id": {"mission": "m", "step": 1}, "fields": {}, "deadline_s": deadline_s}
        return str(msgspec.msgpack.decode(names["answer"]("/look", request)[1])["body"].get("code"))

    assert code(60.0) == "None"
    names["RESULTS"]["/look"] = {"bearing_rad": 10**30}
    assert code(60.0) == "AOS504"

    def is_cancelled(path: str, fields: object):
        names["STOP"].wait()
        raise names["Failure"]("AOS507", "cancelled")

    names["run"] = is_cancelled
    assert code(0.0) == "AOS503"
