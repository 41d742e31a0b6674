import json
import shutil
from pathlib import Path

import pytest
from commands import aos
from places import BUNDLES

from aos_protocol.errors import DocumentError


@pytest.fixture
def broken(tmp_path) -> Path:
    folder = shutil.copytree(BUNDLES / "armadillo-finer", tmp_path / "broken")
    path = folder / "serve.sd"
    path.write_text(path.read_text().replace("delivered : not_delivered", "deliverd : not_delivered"))
    (folder / "armadillo.ef").unlink()
    return folder


def test_lint_of_a_good_bundle_ends_with_zero():
    result = aos("lint", BUNDLES / "armadillo-rough", "--also", BUNDLES / "armadillo-finer", "--no-compile")
    assert result.exit_code == 0
    assert result.output.endswith("0 errors, 1 warning\n")


def test_lint_asks_the_compiler_and_tells_its_errors_at_the_document(tmp_path):
    folder = shutil.copytree(BUNDLES / "armadillo-finer", tmp_path / "broken")
    path = folder / "pick.sd"
    path.write_text(path.read_text().replace("bool in_hand =", "bool in_hand = in_the_hand &&"))
    line = next(n for n, text in enumerate(path.read_text().split("\n"), 1) if "in_the_hand" in text)
    assert aos("lint", folder, "--no-compile").exit_code == 0
    result = aos("lint", folder)
    assert result.exit_code == 1
    assert f"pick.sd:{line}:16: error[AOS201]" in result.output
    assert "bool in_hand = in_the_hand &&" in result.output
    # A mistake of a mapping, and one that is told without the compiler, leave the others' mistakes visible.
    (folder / "look.am").write_text("project: armadillo\nmodule_activation: nothing\n")
    path.write_text(path.read_text().replace("__reward =", "__reward = state.nowhere +", 1))
    together = aos("lint", folder).output
    assert f"pick.sd:{line}:16: error[AOS201]" in together
    assert "look.am:2:" in together
    assert "unknown state variable `nowhere`" in together
    assert "no member named `nowhere`" not in together


@pytest.mark.parametrize(
    ("command", "meant"),
    [
        ("plan fecth", "fetch"),
        ("lint ./fetch/tkae.sd", "fetch/take.sd"),
        ("inspect fetch/take.ds", "fetch/take.sd"),
        ("up fecth.yaml", "fetch.yaml"),
        ("up misspelt.yaml", "{here}/fetch"),
        ("test fecth.yaml", "fetch.yaml"),
        ("check runs/lates", "runs/latest"),
    ],
)
def test_a_path_that_leads_nowhere_is_told_with_the_one_beside_it_that_was_meant(
    tmp_path, monkeypatch, command, meant
):
    monkeypatch.chdir(tmp_path)
    assert aos("new", "project", "fetch").exit_code == 0
    assert aos("new", "adapter", "python", "--in", "fetch").exit_code == 0
    Path("misspelt.yaml").write_text(Path("fetch.yaml").read_text().replace("[fetch]", "[fecth]"))
    Path("runs/latest").mkdir(parents=True)
    done = aos(*command.split())
    assert done.exit_code == 1
    told = f"{done.output}{done.exception}{getattr(done.exception, 'diagnostics', '')}"
    assert f"Did you mean `{meant.format(here=tmp_path)}`?" in told


def test_lint_gives_sarif_with_rules_and_regions(broken: Path):
    result = aos("lint", broken, "--format", "sarif")
    log = json.loads(result.output)
    assert log["version"] == "2.1.0"
    (run,) = log["runs"]
    ids = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    assert ids == ["AOS115", "AOS116"]
    found = next(result for result in run["results"] if result["ruleId"] == "AOS116")
    assert found["level"] == "error"
    assert ids[found["ruleIndex"]] == "AOS116"
    place = found["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == f"{broken}/serve.sd"
    assert place["region"]["startLine"] == 12
    assert place["region"]["startColumn"] == 41
    (fix,) = found["fixes"]
    assert fix["description"]["text"] == "Did you mean `delivered`?"
    (change,) = fix["artifactChanges"]
    assert change["artifactLocation"] == place["artifactLocation"]
    (replacement,) = change["replacements"]
    assert replacement["insertedContent"] == {"text": "delivered"}
    assert replacement["deletedRegion"] == {"startLine": 12, "startColumn": 41, "endColumn": 49}


def test_lint_of_a_broken_bundle_names_all_places_and_ends_with_one(broken: Path):
    result = aos("lint", broken)
    assert result.exit_code == 1
    assert "serve.sd:12:41: error[AOS116]" in result.output
    assert "broken: error[AOS115]: there is no environment document" in result.output


def test_lint_checks_a_bundle_that_adds_skills_with_the_one_that_it_adds_to():
    alone = aos("lint", BUNDLES / "armadillo-retract", "--no-compile")
    assert alone.exit_code == 1
    assert "armadillo-retract --also BUNDLE" in alone.output
    arguments = ["lint", str(BUNDLES / "armadillo-retract"), "--also", str(BUNDLES / "armadillo-finer")]
    together = aos(*arguments, "--no-compile")
    assert together.exit_code == 0
    assert "armadillo-retract: 0 errors" in together.output


@pytest.mark.parametrize("option", [("--json",), ("--format", "json")])
def test_lint_gives_the_same_as_json(broken: Path, option):
    result = aos("lint", broken, *option)
    found = json.loads(result.output)
    assert (found["errors"], found["bundle"]) == (2, str(broken))
    (error,) = [d for d in found["diagnostics"] if d["code"] == "AOS116"]
    assert error["span"] == {"file": "serve.sd", "line": 12, "column": 41}
    assert error["hint"] == "Did you mean `delivered`?"


def test_inspect_prints_the_documents_with_their_places():
    result = aos("inspect", BUNDLES / "armadillo-finer")
    assert result.exit_code == 0
    assert "project armadillo: horizon 10, discount 0.99" in result.output
    assert "variable bool holding_can" in result.output
    assert "    | __moduleResponse = is_there ? arrived : failed;" in result.output
    assert "pick.am:3:11" in result.output


@pytest.mark.parametrize("stage", ["documents", "model", "cpp", "python"])
def test_inspect_prints_each_stage_as_json(stage):
    result = aos("inspect", BUNDLES / "armadillo-finer", "--stage", stage, "--json")
    assert "pick" in str(json.loads(result.output)[stage])


def test_inspect_prints_the_python_of_one_skill():
    arguments = ["inspect", str(BUNDLES / "armadillo-finer"), "--stage", "python", "--skill", "pick"]
    result = aos(*arguments)
    assert "skill pick, project armadillo" in result.output
    assert "navigate" not in result.output


def test_inspect_of_a_broken_bundle_raises_with_all_findings(broken: Path):
    result = aos("inspect", broken)
    assert isinstance(result.exception, DocumentError)
    assert {d.code for d in result.exception.diagnostics if d.is_error} == {"AOS115", "AOS116"}


def test_a_push_without_a_running_system_says_so(tmp_path):
    arguments = ["bundle", "push", str(BUNDLES / "armadillo-finer"), "--runs", str(tmp_path)]
    result = aos(*arguments)
    assert "there is no run in" in str(result.exception)
