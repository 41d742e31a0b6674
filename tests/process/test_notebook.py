"""The notebook, which is the code of docs/python.md, runs as it is."""

import json
import re
import sys

import pytest
from gateway import environment
from places import DEPLOY, ROOT
from processes import finished, until_ended

from aos_deploy.started_system import started_system
from aos_protocol.errors import DeployError

RUN_CELLS = """\
import ast, asyncio, inspect, json, sys

import matplotlib

matplotlib.use("Agg")
cells = json.load(open(sys.argv[1]))["cells"]
names = {"__name__": "__main__"}
with asyncio.Runner() as runner:
    for cell in cells:
        if cell["cell_type"] == "code":
            source = "".join(cell["source"])
            code = compile(source, cell["id"], "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
            made = eval(code, names)
            if inspect.iscoroutine(made):
                runner.run(made)
print(json.dumps([len(names["behind_left"]), names["state"].held_by != "", names["why"].action,
                  names["without"].action, names["sure"].action]))
"""
"""Runs each cell as a task of its own in one loop, as IPython does."""


def test_the_notebook_starts_follows_steers_studies_and_plots(tmp_path):
    (tmp_path / "deploy").symlink_to(DEPLOY)
    (tmp_path / "docs").mkdir()
    done = finished(
        sys.executable,
        "-W",
        "ignore::UserWarning",
        "-c",
        RUN_CELLS,
        ROOT / "docs/notebook.ipynb",
        cwd=tmp_path / "docs",
        env=environment(tmp_path),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    steps, is_held, action, without, sure = json.loads(done.stdout.splitlines()[-1])
    assert (steps, is_held, action) == (12, True, "listen")
    assert without.startswith("open")
    assert sure == "open(door=right_door)"
    assert re.search(r"step 1: listen, then tiger_(left|right)", done.stdout)
    (summary,) = tmp_path.glob("docs/runs/2*/summary.json")
    assert json.loads(summary.read_text())["ending"] == "cancelled"


async def test_a_deploy_file_that_is_wrong_is_refused_with_its_place(tmp_path):
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text("aos: 1\nrobot: r\nbundles: [nothing]\n")
    with pytest.raises(DeployError, match=r"wrong\.yaml:3:") as raised:
        async with started_system(wrong, runs=tmp_path / "runs"):
            pass
    assert raised.value.code == "AOS801"


async def test_a_system_that_was_started_can_be_asked_for_its_mission_at_once(tmp_path):
    async with started_system(_tiger(tmp_path, "model"), runs=tmp_path / "runs") as aos:
        state = await aos.mission_state()
        entry = await aos.until_ended(state.mission)
    assert (entry.ending, entry.steps) == ("step_limit", 2)


async def test_a_system_that_comes_to_no_mission_says_why_and_nobody_waits_for_it(tmp_path):
    with pytest.raises(DeployError, match=r"robot\.py has no lissen") as raised:
        await _watch_the_end(tmp_path, _tiger(tmp_path, "{python: robot.py:lissen}"))
    assert raised.value.code == "AOS801"


async def test_a_system_whose_skills_nobody_serves_says_so_at_the_end_of_the_block(tmp_path):
    with pytest.raises(DeployError, match="no adapter answers calls of /open") as raised:
        await _watch_the_end(tmp_path, _tiger(tmp_path, "{python: robot.py:listen}", others=""))
    assert raised.value.code == "AOS807"


async def _watch_the_end(folder, deploy):
    """Starts a system, and does nothing until its aos-up has ended."""
    async with started_system(deploy, runs=folder / "runs"):
        (run,) = folder.glob("runs/2*/run.json")
        await until_ended([json.loads(run.read_bytes())["pid"]])


def _tiger(folder, served, others='"*": model'):
    """The deploy file of the tiger problem, whose listening is `served` so."""
    (folder / "robot.py").write_text("def listen(call):\n    return {}\n")
    deploy = folder / "tiger.yaml"
    deploy.write_text(
        f"aos: 1\nrobot: tiger\nbundles: [{DEPLOY / 'bundles/bench/tiger'}]\n"
        f"mission: {{step_limit: 2}}\nbind: {{/listen: {served}, {others}}}\n"
    )
    return deploy
