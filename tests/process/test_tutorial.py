"""docs/tutorial.md does what it says. `python -m tests.walk` does it with an installed wheel."""

import sys
from pathlib import Path

import pytest
from walk import Walk, steps_of


@pytest.fixture(scope="module")
def walk(cache_dir: Path, tmp_path_factory) -> Walk:
    with Walk(Path(sys.executable).parent, tmp_path_factory.mktemp("empty"), cache_dir) as walk:
        for step in steps_of():
            walk.do(step)
    return walk


def test_the_page_has_all_of_the_way():
    kinds = [step.kind for step in steps_of()]
    assert {kind for kind in kinds if not kind.startswith("file: ")} == {
        "run", "run in the background", "run while it looks", "run when the mission has ended",
    }  # fmt: skip
    commands = " ".join(step.text for step in steps_of() if step.kind.startswith("run"))
    names = "new project", "lint", "plan", "simulate", "new skill", "decisions", "runs", "bundle push"
    assert [name for name in (*names, "mission start") if f"aos {name}" not in commands] == []


def test_the_project_is_clean_and_to_ask_comes_first(walk: Walk):
    assert "fetch: 0 errors, 0 warnings" in walk.said["aos lint fetch"]
    rows = [line for line in walk.said["aos plan fetch"].splitlines() if line.startswith("│")]
    assert rows[0].split()[1] == "ask"


def test_the_mission_without_a_robot_reaches_its_goal_and_can_be_read(walk: Walk):
    assert "mission ended: the goal is reached" in walk.said["aos-up fetch.yaml"]
    assert walk.said["aos decisions"].startswith("step  1: ask  [")
    assert walk.said["aos runs"].startswith("goal")


def test_the_skill_that_was_pushed_is_used_at_the_next_decision(walk: Walk):
    assert "fetch revision 1, added look, take" in walk.said["aos-up fetch-robot.yaml --stay"]
    assert "revision 2, added ask" in walk.said["aos bundle push fetch"]
    assert "step  2: ask  [ask " in walk.said["aos-up fetch-robot.yaml --stay"]


def test_the_robot_has_a_second_task_without_a_restart(walk: Walk):
    assert ": goal after " in walk.said["aos mission start --wait"]
    first, second = walk.said["aos mission list"].splitlines()
    assert first.startswith("goal")
    assert second.startswith("goal")
