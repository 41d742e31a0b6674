import asyncio
import json
import shutil
import sys
from collections.abc import AsyncIterator, Awaitable, Callable

import msgspec
import pytest_asyncio
from commands import aos as called
from mappings import mapping_text
from places import BUNDLES
from starting import until_present
from typer.testing import Result

from aos_protocol.keys import Keys
from aos_protocol.messages import MappingQuery, MappingState
from aos_registry.settings import Settings
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.children import Child

Aos = Callable[..., Awaitable[Result]]


@pytest_asyncio.fixture
async def aos(tmp_path, endpoint: str, bus: Bus, keys: Keys) -> AsyncIterator[Aos]:
    settings = Settings(robot="test", service="registry", endpoint=endpoint, run_dir=str(tmp_path))
    path = tmp_path / "registry.json"
    path.write_bytes(msgspec.json.encode(settings))
    async with until_present(bus, keys.live("registry")):
        child = await Child.start(
            [sys.executable, "-m", "aos_registry", str(path)], env={"AOS_LOG": "CRITICAL"}
        )

    async def run(*arguments: str) -> Result:
        where = ["--connect", endpoint, "--robot", "test"]
        return await asyncio.to_thread(called, *arguments, *where)

    yield run
    await child.stop(5.0)


async def test_a_bundle_is_pushed_listed_and_shown(aos: Aos):
    assert (await aos("bundle", "list")).output == "The registry holds no projects.\n"
    pushed = await aos("bundle", "push", str(BUNDLES / "armadillo-finer"))
    assert pushed.exit_code == 0, pushed.output
    skills = "navigate, observe_arm_outstretched, observe_holding, pick, serve"
    assert pushed.output.endswith(f"project armadillo, revision 1, added {skills}\n")
    again = await aos("bundle", "push", str(BUNDLES / "armadillo-finer"))
    assert again.output.endswith("project armadillo, revision 1, nothing new\n")
    listed = json.loads((await aos("bundle", "list", "--json")).output)
    assert [(e["project"], e["revision"], len(e["skills"])) for e in listed["entries"]] == [
        ("armadillo", 1, 5)
    ]
    shown = (await aos("bundle", "show")).output
    assert shown.startswith("revision 1, digest ")
    assert "skill pick()" in shown


async def test_a_refused_bundle_ends_with_one_and_leaves_the_revision(aos: Aos, tmp_path):
    await aos("bundle", "push", str(BUNDLES / "armadillo-finer"))
    folder = shutil.copytree(BUNDLES / "armadillo-finer", tmp_path / "worse")
    (folder / "pick.am").write_text("project: armadillo\nresponse: pick_succeeded\nresponse_rule: True +\n")
    refused = await aos("bundle", "push", str(folder))
    assert refused.exit_code == 1
    assert "pick.am:1:1: error[AOS105]: the mapping pick lacks `module_activation:`" in refused.output
    assert refused.output.endswith("refused; the project stays at revision 1\n")


async def test_a_skill_and_a_project_are_removed_and_the_history_keeps_them(aos: Aos):
    await aos("bundle", "push", str(BUNDLES / "armadillo-finer"))
    removed = await aos("bundle", "rm", "armadillo", "observe_holding")
    assert (
        removed.output
        == "armadillo observe_holding: project armadillo, revision 2, removed observe_holding\n"
    )
    assert "observe_holding" not in (await aos("bundle", "show")).output
    assert "skill observe_holding" in (await aos("bundle", "show", "--revision", "1")).output
    await aos("bundle", "rm", "armadillo")
    assert (await aos("bundle", "list")).output == "The registry holds no projects.\n"
    history = json.loads((await aos("bundle", "history", "armadillo", "--json")).output)["entries"]
    assert [entry["revision"] for entry in history] == [1, 2, 3]
    assert history[1]["removed"] == ["observe_holding.am", "observe_holding.sd"]
    assert history[2]["skills"] == []
    await aos("bundle", "push", str(BUNDLES / "armadillo-finer"))
    assert "revision 4" in (await aos("bundle", "list")).output


async def test_a_skill_document_alone_is_a_skill_until_its_mapping_comes(aos: Aos, tmp_path):
    await aos("bundle", "push", str(BUNDLES / "armadillo-finer"))
    skill = tmp_path / "ask"
    skill.mkdir()
    (skill / "ask.sd").write_text("project: armadillo\ndynamic_model:\n__moduleResponse = told;\n")
    assert "added ask" in (await aos("bundle", "push", str(skill))).output
    assert "activation: skill /ask()" in (await aos("bundle", "show")).output
    mapping = mapping_text("told: True", project="armadillo", skill="say")
    (skill / "ask.am").write_text(mapping)
    assert "changed ask" in (await aos("bundle", "push", str(skill))).output
    assert "activation: skill /say()" in (await aos("bundle", "show")).output
    assert "removed ask" in (await aos("bundle", "rm", "armadillo", "ask")).output


async def test_a_pushed_skill_that_nobody_serves_is_told(aos: Aos, bus: Bus, keys: Keys):
    async def state(_: MappingQuery, __: str) -> MappingState:
        return MappingState(1, ("pick",), unavailable={"pick": "no adapter answers calls of /pick"})

    await bus.answer(keys.mapping_state, MappingQuery, state)
    await bus.announce(keys.live("middleware"))
    pushed = await aos("bundle", "push", str(BUNDLES / "armadillo-finer"))
    assert pushed.exit_code == 0
    assert "pick: warning[AOS505]: nobody can run it now: no adapter answers calls of /pick" in pushed.output


async def test_what_is_not_there_is_told_with_the_nearest(aos: Aos):
    await aos("bundle", "push", str(BUNDLES / "armadillo-finer"))
    for arguments, told in (
        (("show", "armadilo"), "Did you mean `armadillo`?"),
        (("rm", "armadillo", "pik"), "Did you mean `pick`?"),
        (("rm", "armadilo"), "no project armadilo"),
        (("rm", "pick"), "It is a skill of armadillo: `aos bundle rm armadillo pick`"),
    ):
        assert told in str((await aos("bundle", *arguments)).exception)
