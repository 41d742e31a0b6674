import json
from pathlib import Path

import pytest
from commands import aos

from aos_deploy.bundles.files import files_of_bundles, planned_of, project_of
from aos_deploy.deployment.reading import read_deploy_file
from aos_deploy.events import Event, ServiceChanged
from aos_deploy.missions.mission_run import MissionRun
from aos_language.load import load_files
from aos_protocol.errors import DeployError, DocumentError
from aos_runtime.clock import SystemClock

ENVIRONMENT = "project: yard\nhorizon: 3\n\nstate_variable: bool open\n"
SKILL = "project: yard\n\ndynamic_model:\nstate__.open = true;\n__reward = -1;\n"


def bundle(folder: Path, name: str, **files: str) -> Path:
    path = folder / name
    path.mkdir()
    for file, text in files.items():
        (path / file.replace("_", ".")).write_text(text)
    return path


def test_one_may_hold_the_environment_alone(tmp_path):
    bundles = (bundle(tmp_path, "world", yard_ef=ENVIRONMENT), bundle(tmp_path, "skills", push_sd=SKILL))
    together = files_of_bundles(bundles, ())
    project = load_files(together.files, name="yard.yaml").project
    assert [skill.name for skill in project.skills] == ["push"]
    assert together.bundles == {"yard.ef": bundles[0], "push.sd": bundles[1]}


def test_a_deploy_file_stands_for_its_bundles_and_what_it_sets(tmp_path):
    bundle(tmp_path, "world", yard_ef=ENVIRONMENT + "\nmission_parameter: int laps\ndefault_value: 2\n")
    bundle(tmp_path, "skills", push_sd=SKILL)
    deploy = tmp_path / "yard.yaml"
    constraint = '{never: "state.open", probability: 0.1}'
    mission = f"{{set: {{laps: 3}}, constraints: [{constraint}]}}"
    deploy.write_text(f"aos: 1\nrobot: yard\nbundles: [world, skills]\nmission: {mission}\n")
    planned = planned_of(deploy)
    assert sorted(planned.files) == ["push.sd", "yard.ef"]
    assert [(value.name, value.text) for value in planned.values] == [("laps", "3")]
    assert [constraint.never.code for constraint in planned.constraints] == ["state.open"]
    linted = aos("lint", deploy, "--no-compile")
    assert (linted.exit_code, "0 errors" in linted.stdout) == (0, True)


def test_a_bound_path_that_no_skill_calls_is_told_with_the_one_that_is_meant(tmp_path):
    bundle(tmp_path, "yard", yard_ef=ENVIRONMENT, push_sd=SKILL)
    deploy = tmp_path / "yard.yaml"
    adapters = "adapters:\n  arm: {command: [arm]}\nbind:\n  /later: arm\n  /psuh: arm\n"
    deploy.write_text(f"aos: 1\nrobot: yard\nbundles: [yard]\n{adapters}")
    told = aos("lint", deploy, "--no-compile").stdout
    assert "yard.yaml:8:3: warning[AOS110]: no skill calls /psuh. Did you mean `/push`?" in told
    assert "/later" not in told, "a skill may come"


def test_skills_that_nobody_serves_and_long_decisions_are_told_of_a_deploy_file(tmp_path):
    bundle(tmp_path, "yard", yard_ef=ENVIRONMENT, push_sd=SKILL)
    deploy = tmp_path / "yard.yaml"
    for text, told in (
        ("bind: {/pull: model}\n", ["4:1: warning[AOS807]: no adapter serves /push. "]),
        (
            "bind: {'*': model}\nsolver: {time_s: 200}\n",
            ["5:10: warning[AOS801]: each decision takes 200 s. "],
        ),
        ("bind: {'*': model}\nsolver: {time_s: 0.2}\n", []),
    ):
        deploy.write_text(f"aos: 1\nrobot: yard\nbundles: [yard]\n{text}")
        lines = aos("lint", deploy, "--no-compile").stdout.splitlines()
        found = [line.split("yard.yaml:")[1] for line in lines if "warning[" in line]
        assert [line[: len(start)] for line, start in zip(found, told, strict=True)] == told


def test_mistakes_in_what_a_deploy_file_sets_for_its_documents_are_told_by_lint(tmp_path):
    bundle(tmp_path, "yard", yard_ef=ENVIRONMENT, push_sd=SKILL)
    deploy = tmp_path / "yard.yaml"
    mission = "mission:\n  set: {laps: 3}\n  constraints: [{never: opne, probability: 0.1}]\n"
    deploy.write_text(f"aos: 1\nrobot: yard\nbundles: [yard]\n{mission}")
    told = aos("lint", deploy, "--no-compile", "--json")
    places = {(one["code"], one["span"]["line"]) for one in json.loads(told.stdout)["diagnostics"]}
    assert (told.exit_code, places) == (1, {("AOS146", 5), ("AOS110", 6), ("AOS139", 1)})


@pytest.mark.parametrize("form", ["json", "sarif"])
def test_mistakes_of_a_deploy_file_are_data_where_data_are_asked_for(tmp_path, form):
    bundle(tmp_path, "yard", yard_ef=ENVIRONMENT, push_sd=SKILL)
    deploy = tmp_path / "yard.yaml"
    deploy.write_text("aos: 1\nrobot: yard\nbundles: [yard]\nmisson: {}\n")
    told = aos("lint", deploy, "--no-compile", "--format", form)
    assert told.exit_code == 1
    data = json.loads(told.stdout)
    found = data["diagnostics"] if form == "json" else data["runs"][0]["results"]
    assert "misson" in json.dumps(found)


def test_a_folder_with_one_deploy_file_stands_for_it(tmp_path):
    bundle(tmp_path, "yard", yard_ef=ENVIRONMENT, push_sd=SKILL)
    (tmp_path / "yard.yaml").write_text("aos: 1\nrobot: yard\nbundles: [yard]\n")
    assert sorted(planned_of(tmp_path).files) == ["push.sd", "yard.ef"]


def test_commands_on_documents_take_the_bundles_of_a_deploy_file_as_one(tmp_path):
    bundle(tmp_path, "world", yard_ef=ENVIRONMENT)
    bundle(tmp_path, "skills", push_sd=SKILL)
    deploy = tmp_path / "yard.yaml"
    deploy.write_text("aos: 1\nrobot: yard\nbundles: [world, skills]\n")
    shown = aos("inspect", deploy, "--stage", "model")
    assert (shown.exit_code, '"push"' in shown.stdout, '"open"' in shown.stdout) == (0, True, True)
    out = tmp_path / "json"
    converted = aos("convert", deploy, "--to", "json", "--out", out)
    assert (converted.exit_code, len(list(out.iterdir()))) == (0, 2)


def test_a_changed_document_with_a_version_that_is_not_higher_is_told_in_its_bundle(tmp_path):
    first = bundle(tmp_path, "first", yard_ef=ENVIRONMENT.replace("\nhorizon", "\nversion: 2\nhorizon"))
    second = bundle(tmp_path, "second", yard_ef=ENVIRONMENT.replace("\nhorizon", "\nversion: 1\nhorizon"))
    with pytest.raises(DocumentError, match="second is refused") as refused:
        files_of_bundles((first, second), ())
    (found,) = refused.value.diagnostics
    assert (found.code, Path(found.span.file).parts[-2:]) == ("AOS129", ("second", "yard.ef"))


async def test_documents_with_mistakes_are_refused_before_a_service_starts(tmp_path):
    wrong = SKILL.replace("state__.open", "state__.opn").replace("-1", "minus_one")
    bundle(tmp_path, "world", yard_ef=ENVIRONMENT.replace("horizon", "horzon"))
    bundle(tmp_path, "skills", push_sd=wrong)
    deploy = tmp_path / "yard.yaml"
    deploy.write_text("aos: 1\nrobot: yard\nbundles: [world, skills]\nbind: {/push: model}\n")
    events: list[Event] = []
    run = MissionRun(read_deploy_file(deploy), events.append, SystemClock())
    summary = await run.run()
    assert (summary.ending, summary.exit_code) == ("not_started", 1)
    assert not [event for event in events if isinstance(event, ServiceChanged)]
    assert isinstance(run.error, DocumentError)
    places = {f"{Path(found.span.file).parent.name}/{found.span.line}" for found in run.error.diagnostics}
    assert {"world/2", "skills/4"} <= places


@pytest.mark.parametrize(("named", "column"), [("robot: barn", 8), ("robot: yard\nproject: barn", 10)])
async def test_another_project_than_the_documents_is_refused_before_a_service_starts(tmp_path, named, column):
    bundle(tmp_path, "yard", yard_ef=ENVIRONMENT, push_sd=SKILL)
    deploy = tmp_path / "yard.yaml"
    deploy.write_text(f"aos: 1\n{named}\nbundles: [yard]\nbind: {{/push: model}}\n")
    events: list[Event] = []
    run = MissionRun(read_deploy_file(deploy), events.append, SystemClock())
    await run.run()
    assert not [event for event in events if isinstance(event, ServiceChanged)]
    assert isinstance(run.error, DeployError)
    (found,) = run.error.diagnostics
    assert (found.span.line, found.span.column) == (named.count("\n") + 2, column)
    assert found.message == "the documents are of the project yard, not barn"


def test_mistakes_in_constraints_and_in_what_is_set_are_told_together(tmp_path):
    bundle(tmp_path, "yard", yard_ef=ENVIRONMENT, push_sd=SKILL)
    deploy = tmp_path / "yard.yaml"
    mission = '{set: {laps: 3}, constraints: [{never: "state.opn", probability: 0.1}]}'
    deploy.write_text(f"aos: 1\nrobot: yard\nbundles: [yard]\nmission: {mission}\n")
    with pytest.raises(DeployError, match="constraints and what is set") as refused:
        project_of(read_deploy_file(deploy))
    assert [found.code for found in refused.value.diagnostics] == ["AOS110", "AOS146"]
