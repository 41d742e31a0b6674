import asyncio
import json
import os
import signal
import subprocess
from pathlib import Path

import msgspec
import pytest
from commands import aos
from models import built_bundle, built_project, built_text, engine_of, engine_of_bundle
from places import BIN, BUNDLES, DEPLOY, ROOT
from processes import COMMAND_S, HANG_S, finished
from projects import files_project, text_project

from aos_deploy.history_check.files import check_run
from aos_deploy.places import cache_dir
from aos_deploy.runs.directory import RunDirectory
from aos_language.mission_parameters import mission_value_of_option
from aos_protocol.documents import Project
from aos_protocol.errors import DeployError, DocumentError, PlanningError
from aos_protocol.messages import MissionBegun, ProjectRevision
from aos_runtime.disk.journal import Journal
from aos_solver.building.build import BuiltModel
from aos_solver.child.engine import Engine
from aos_solver.mission.models.model_shelf import ModelShelf
from aos_solver.mission.models.past import Evidence, Past, updated


async def exact_values(engine: Engine) -> dict[str, float]:
    return {value.action: value.q for value in (await engine.exact_values()).actions}


def with_constant(bundle: Path, person: str) -> dict[str, str]:
    files = {}
    for path in sorted(bundle.iterdir()):
        text = path.read_text().replace("mission_parameter: Person target\ndefault_value: alice\n", "")
        for copy in ("state", "state_"):
            text = text.replace(f"{copy}.target", person)
        assert "target" not in text.replace("--set target", "")
        files[path.name] = text
    return files


async def test_one_compiled_model_has_the_exact_values_of_each_value():
    async with engine_of_bundle(BUNDLES / "errand") as engine:
        pids = set()
        for person in ("alice", "bob", "alice"):
            await engine.start_with({"target": person})
            pids.add(engine.pid)
            assert engine.description.mission_parameters == {"target": person}
            constant = await built_text(with_constant(BUNDLES / "errand", person))
            async with engine_of(constant) as written:
                truth = await exact_values(written)
                assert [a.name for a in engine.description.actions] == list(truth)
                assert await exact_values(engine) == pytest.approx(truth, abs=1e-12)
                for other in (written, engine):
                    await other.update("look", "nobody", refuted_below=0.0)
                assert await exact_values(engine) == pytest.approx(await exact_values(written), abs=1e-12)
        assert len(pids) == 3


async def test_an_engine_that_is_killed_comes_back_with_its_values_and_its_belief():
    built = await built_bundle(BUNDLES / "errand")
    async with engine_of(msgspec.structs.replace(built, mission_values={"target": "bob"})) as engine:
        await engine.update("look", "nobody")
        before = await engine.export_belief()
        assert engine.pid is not None
        os.kill(engine.pid, signal.SIGKILL)
        assert (await engine.export_belief()).particles == before.particles
        assert engine.description.mission_parameters == {"target": "bob"}


PARTS = {
    "parts.ef": """project: test
horizon: 1

define_type: Item
enum_members: soda, chips

define_type: Spot
variable: float x_m 1.5
variable: Item near chips
variable: int log []

mission_parameter: Spot dock

mission_parameter: double far_m
code:
state.far_m = state.dock.x_m + 1;

mission_parameter: bool wanted [Item]
default_value: true

mission_parameter: string word
default_value: "so"

state_variable: int count
default_value: state.wanted[soda] ? 10 : 20

state_variable: bool is_lucky
code:
state.is_lucky = AOS.Bernoulli(0.5);
""",
    "act.sd": """project: test

dynamic_model:
__reward = state.count + state.far_m + (state.word == "so" ? 100 : 200);
if (state.dock.near == soda) __reward += 1000;
""",
}


@pytest.mark.parametrize(
    ("options", "value"),
    [
        ([], 10 + 2.5 + 100),
        (["dock.x_m=0.25", "wanted.soda=false"], 20 + 1.25 + 100),
        (["far_m=7", "word=ßo", "dock.near=soda"], 10 + 7 + 200 + 1000),
    ],
)
async def test_defaults_and_initial_values_follow_from_what_is_set(options, value):
    values = tuple(map(mission_value_of_option, options))
    project = msgspec.structs.replace(text_project(PARTS), mission_values=values)
    built = await built_project(project)
    async with engine_of(built) as engine:
        assert await exact_values(engine) == {"act": value}


class Shelf(ModelShelf):
    """A shelf for a mission with these values, on a middleware that runs every revision."""

    def __init__(self, *options: str):
        async def start(built: BuiltModel) -> Engine:
            return await Engine.start(built, seed=1)

        values = tuple(map(mission_value_of_option, options))
        super().__init__(cache_dir(), lambda remark: None, start, lambda revision: True, (), values)


def errand(**replaced: str) -> Project:
    files = {
        path.name: path.read_text().replace(replaced.get("before", "\0"), replaced.get("after", "")).encode()
        for path in sorted((BUNDLES / "errand").iterdir())
    }
    return files_project(files)


async def test_documents_that_come_while_a_mission_runs_do_not_change_its_values():
    shelf = Shelf()
    await shelf.make(ProjectRevision(1, "", errand()))
    running = await shelf.first()
    # Nobody has set the parameter: the mission has the default that the documents had at its start.
    await shelf.make(
        ProjectRevision(2, "", errand(before="default_value: alice", after="default_value: bob"))
    )
    newest = await shelf.newest(running, Past())
    try:
        assert newest is not None
        assert newest.model.revision == 2
        assert newest.model.engine.description.mission_parameters == {"target": "alice"}
        assert "give(to=alice)" in [action.name for action in newest.model.engine.description.actions]
    finally:
        await shelf.close()


async def test_an_errand_whose_documents_gain_a_variable_goes_on_with_what_was_seen():
    shelf = Shelf("target=bob")
    await shelf.make(ProjectRevision(1, "", errand()))
    running = await shelf.first()
    past = Past(steps=[Evidence("look", "look", "nobody")])
    for step in past.steps:
        believed_before = (await updated(running.engine, step, past.refuted_below)).summary
    gained = "state_variable: bool is_raining\n\ninitial_belief:\nstate.is_raining = AOS.Bernoulli(0.25);"
    is_replayed = asyncio.Event()
    shelf.on_ready = is_replayed.set
    assert await shelf.newest(running, past) is None
    await shelf.make(ProjectRevision(2, "", errand(before="initial_belief:", after=gained)))
    async with asyncio.timeout(HANG_S):
        while (newest := await shelf.newest(running, past)) is None:
            await is_replayed.wait()
            is_replayed.clear()
    await shelf.close()
    believed = {marginal.variable: dict(marginal.values) for marginal in newest.belief.marginals}
    assert (newest.row.by, newest.row.steps, newest.row.foreign) == ("replay", 1, 0)
    assert believed.pop("is_raining")["true"] == pytest.approx(0.25)
    before = {marginal.variable: dict(marginal.values) for marginal in believed_before.marginals}
    assert believed == {variable: pytest.approx(values) for variable, values in before.items()}
    assert newest.model.engine.description.mission_parameters == {"target": "bob"}


async def test_documents_without_the_value_that_was_set_are_refused():
    shelf = Shelf("target=bob")
    await shelf.make(ProjectRevision(1, "", errand()))
    running = await shelf.first()
    (found,) = await shelf.check(errand(before="target", after="whom"), running)
    assert (found.code, found.span.file) == ("AOS146", "errand.ef")
    assert found.message == "unknown mission parameter `target`"
    await shelf.close()


async def test_values_are_for_all_bundles_of_a_start_together():
    shelf = Shelf("whom=bob")
    try:
        assert await shelf.check(errand(), None) == ()
        await shelf.make(ProjectRevision(1, "", errand()))
        with pytest.raises(DocumentError, match="unknown mission parameter `whom`"):
            await shelf.first()
        await shelf.make(ProjectRevision(2, "", errand(before="target", after="whom")))
        assert (await shelf.first()).engine.description.mission_parameters == {"whom": "bob"}
    finally:
        await shelf.close()


def test_commands_take_values_and_a_policy_is_for_its_own(tmp_path):
    bundle, policy = str(BUNDLES / "errand"), str(tmp_path / "bob.policy")

    def run(*arguments: str) -> object:
        done = aos(*arguments, "--json")
        if done.exception is not None:
            raise done.exception
        return json.loads(done.stdout)

    solved = run("solve", bundle, "--set", "target=bob", "--out", policy, "--time", "5", "--precision", "0.1")
    planned = run("plan", bundle, "--set", "target=bob", "--policy", policy)
    assert isinstance(solved, dict)
    assert isinstance(planned, dict)
    assert planned["action"] == "give(to=bob)"
    assert solved["lower"] <= planned["value"] + 0.2
    with pytest.raises(PlanningError, match="solved for target = bob, and this mission has target = alice"):
        run("plan", bundle, "--policy", policy)
    with pytest.raises(DocumentError, match="sets no mission parameter"):
        run("simulate", bundle, "--set", "target")
    with pytest.raises(DeployError) as unknown:
        run("plan", bundle, "--set", "targt=bob")
    assert str(unknown.value.diagnostics[0].span) == "--set targt=bob"
    simulated = run("simulate", bundle, "--set", "target=bob", "--runs", "2", "--simulations", "500")
    assert isinstance(simulated, dict)
    assert all("give(to=bob)" in mission["actions"] for mission in simulated["runs"])


MISSIONS = """aos: 1
tests:
  given:
    deploy: {deploy}
    seeds: 2
    simulations: 2000
    set: {{target: bob}}
    claims: [{{says: it is given at once, first: give(to={person})}}]
"""


@pytest.mark.parametrize(("options", "person", "status"), [
    ((), "bob", 0),
    ((), "alice", 4),
    (("--set", "target=alice"), "bob", 4),
])  # fmt: skip
def test_missions_of_a_test_file_have_its_values_or_the_commands(
    tmp_path,
    options, person, status,
):  # fmt: skip
    file = tmp_path / "missions.yaml"
    file.write_text(MISSIONS.format(deploy=DEPLOY / "errand.yaml", person=person))
    assert aos("test", file, *options).exit_code == status


SLOW_GIVE = """
import time
from pathlib import Path

def give(call, to):
    while not Path(__file__).with_name("may_give").exists():
        time.sleep(0.02)
    return {"response": "given"}
"""


def test_a_run_whose_aos_up_was_killed_goes_on_where_it_was_with_the_values_of_its_command(tmp_path):
    (tmp_path / "robot.py").write_text(SLOW_GIVE)
    text = (DEPLOY / "errand.yaml").read_text()
    text = text.replace("[bundles/errand]", f"[{ROOT}/deploy/bundles/errand]")
    text = text.replace("bind: {", "bus: {listen: tcp/127.0.0.1:0}\nbind: {/give: {python: robot.py:give}, ")
    deploy_file = tmp_path / "errand.yaml"
    deploy_file.write_text(text)
    command = [BIN / "aos-up", deploy_file, "--json", "--set", "target=bob", "--runs", tmp_path / "runs"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as up:
        assert up.stdout is not None
        skills = (json.loads(line).get("skill") for line in up.stdout)
        assert "give" in skills  # It runs, and does not end before it may.
        up.kill()
    (tmp_path / "may_give").touch()
    run = (tmp_path / "runs" / "latest").resolve()
    resume = [BIN / "aos-up", "--resume", run, "--json"]
    resumed, refused = (finished(*resume) for _ in range(2))
    assert resumed.returncode == 0, resumed.stderr
    steps = [event["step"] for event in map(json.loads, resumed.stdout.splitlines()) if "action" in event]
    assert steps == sorted(steps)
    assert steps[0] == 1
    assert (refused.returncode, "AOS810" in refused.stderr) == (1, True)
    assert check_run(run).violations == []
    with Journal.read(run / "journal.db") as journal:
        begun = [msgspec.json.decode(row.payload, type=MissionBegun) for row in journal.rows("begun")]
    assert [(row.epoch, row.mission_parameters) for row in begun] == [(n, {"target": "bob"}) for n in (1, 2)]
    summary = RunDirectory(run).read_summary()
    assert summary is not None
    assert summary.mission_parameters == {"target": "bob"}
    listed = subprocess.run(
        [BIN / "aos", "runs", "--runs", run.parent],
        check=True,
        capture_output=True,
        text=True,
        timeout=COMMAND_S,
    )
    assert "target=bob" in listed.stdout
