"""The notebook, which is the code of docs/python.md, runs as it is."""

import json
import re
import sys

import pytest
from gateway import environment
from places import DEPLOY, ROOT
from processes import finished

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
