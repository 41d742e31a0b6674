from pathlib import Path

import pytest
from places import BUNDLES

from aos_deploy.bundles.files import project_of
from aos_deploy.deployment.mission_values import constraint_of_option
from aos_deploy.deployment.reading import read_deploy_file
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.errors import DeployError
from aos_solver.building.project_build import lowered
from aos_solver.emission.program import Program

HEAD = "aos: 1\nrobot: armadillo\nbundles: [{bundle}]\nmission:\n  constraints:\n"


@pytest.fixture
def write(tmp_path) -> Path:
    path = tmp_path / "deploy.yaml"
    path.write_text(HEAD.format(bundle=BUNDLES / "armadillo-finer"))
    return path


def found_in(path: Path, text: str) -> Diagnostic:
    path.write_text(path.read_text() + text)
    with pytest.raises(DeployError) as caught:
        project_of(read_deploy_file(path))
    (found,) = caught.value.diagnostics
    return found


@pytest.mark.parametrize(
    ("never", "code", "at", "text"),
    [
        ("serv && state.arm_outstretched", "AOS110", 0, "`serv`. Did you mean `serve`?"),
        ("serve && state.arm_outstreched", "AOS110", 15, "Did you mean `arm_outstretched`?"),
        ("serve && stat.holding_can", "AOS110", 9, "Did you mean `state`?"),
        ("navigate && navigate->destination.plac == Corridor", "AOS110", 34, "Did you mean `place`?"),
        ("navigate && navigate->goal.place == Corridor", "AOS110", 22, "has no parameter `goal`"),
        ("navigate && state.robot_at == Coridor", "AOS110", 30, "Did you mean `Corridor`?"),
        ("state_.holding_can", "AOS123", 0, "Only `state`, `state__` can be read there"),
        ("serve && (state.holding_can = true)", "AOS123", 10, "It may only be read"),
        ("serve && AOS.Bernoulli(0.5)", "AOS142", 9, "draws at random"),
        ("3 > 2", "AOS142", 0, "neither a state nor an action"),
        ("state.holding_can; state.arm_outstretched", "AOS108", 17, "one expression"),
    ],
)
@pytest.mark.parametrize(("before", "after"), [("", ""), ('"', '"')])
def test_a_mistake_is_told_at_its_place(write: Path, never, code, at, text, before, after):
    found = found_in(write, f"    - never: {before}{never}{after}\n      probability: 0.01\n")
    assert found.code == code
    assert text in f"{found.message}. {found.hint}"
    assert (found.span.file, found.span.line) == (str(write), 6)
    assert found.span.column == 14 + len(before) + at
    assert never in found.excerpt


def test_the_text_of_a_block_begins_in_the_line_below(write: Path):
    never = "    - never: |\n        serve &&\n        stat.holding_can\n      probability: 0.01\n"
    assert found_in(write, never).span.line == 8


@pytest.mark.parametrize("probability", ["1", "-0.1", "often"])
def test_a_bound_is_a_probability_below_one(write: Path, probability):
    found = found_in(write, f"    - {{never: serve, probability: {probability}}}\n")
    assert (found.code, found.span.line) == ("AOS106", 6)
    assert "mission.constraints[0].probability" in found.message


def test_constraints_become_part_of_the_model(write: Path):
    write.write_text(write.read_text() + "    - {never: serve && state.holding_can, probability: 0.01}\n")
    program = lowered(project_of(read_deploy_file(write)))[0]
    assert isinstance(program, Program)
    (constraint,) = program.constraints
    assert (constraint.skills, constraint.looks_ahead) == (("serve",), False)
    assert constraint.never.locate(1, 1).line == 6


@pytest.mark.parametrize("text", ["serve", "often: serve", "1: serve", "0.1:", ": serve"])
def test_an_option_that_is_no_constraint_says_how_to_write_one(text):
    with pytest.raises(DeployError) as caught:
        constraint_of_option(text)
    assert caught.value.hint.startswith("Write it as --never '0.01: serve")
