from pathlib import Path

import pytest
from places import DATA

from aos_lab.trials.files import read_test_file
from aos_protocol.errors import DeployError


@pytest.fixture
def folder(tmp_path) -> Path:
    bundle = DATA / "bundles" / "fetch"
    deploy = f"aos: 1\nrobot: fetch\nbundles: [{bundle}]\nleave_out: [look]\nbind: {{'*': model}}\n"
    (tmp_path / "fetch.yaml").write_text(deploy)
    (tmp_path / "watching.yaml").write_text(f"{deploy}watch: drop\n")
    return tmp_path


def found(folder: Path, claim: str, deploy: str = "fetch.yaml") -> list[str]:
    test = f"aos: 1\ntests:\n  t:\n    deploy: {deploy}\n    claims:\n      - says: so\n        {claim}\n"
    (folder / "tests.yaml").write_text(test)
    try:
        read_test_file(folder / "tests.yaml")
    except DeployError as error:
        return [f"{each.span.line} {each.message}. {each.hint}" for each in error.diagnostics]
    return []


@pytest.mark.parametrize(
    ("claim", "mistake"),
    [
        ("never: tkae", "the skill tkae, which no document describes. Did you mean `take`?"),
        ("never: 'look | tkae*'", "the skill tkae*, which"),
        ("never: take(sid=left_side)", "the parameter sid of take, which has none of that name. Did"),
        ("never: take(side=left)", "the value left of side, which it never has. Did you mean `Left`?"),
        ("never: take > mised", "the response mised of take, which never gives it. Did you mean `missed`?"),
        ("never_state: is_takn=true", "the state variable is_takn, which no document declares. Did you"),
        ("never_state: thing_at=left", "the value left of thing_at, which it never has"),
        ("goal: true\n        when: {some: tkae}", "the skill tkae, which"),
    ],
)
def test_a_name_that_no_mission_can_have_is_a_mistake_at_its_claim(folder: Path, claim, mistake):
    (only,) = found(folder, claim)
    assert only.startswith(f"6 a claim names {mistake}")


@pytest.mark.parametrize(
    "claim",
    [
        "never: take(side=*_side) > no observation",
        "never: 't* | take*left* | *(side=Left) | look > seen_* | look > Default*'",
        "never_state: thing_at=Left, is_t | taken=t | world_ending=goal | anything else",
    ],
)
def test_what_a_mission_can_have_is_none(folder: Path, claim):
    assert found(folder, claim) == []


def test_where_documents_may_come_into_a_folder_their_names_are_not_known(folder: Path):
    assert found(folder, "never: tkae", "watching.yaml") == []
