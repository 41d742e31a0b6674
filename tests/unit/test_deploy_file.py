import shutil
from pathlib import Path

import pytest
from deploy_files import HEAD, findings, read
from places import DEPLOY

from aos_deploy.bundles.files import files_of_bundle
from aos_deploy.deployment.own_programs import ReadyPart
from aos_deploy.deployment.parts import MAX_SEED
from aos_deploy.deployment.reading import check_endpoint, read_deploy_file, without_a_robot
from aos_deploy.missions.readiness import misspelt_paths, unbound_adapters
from aos_deploy.processes.needed_here import check_needed_here
from aos_deploy.processes.program import programs_of_deployment
from aos_protocol.errors import DeployError
from aos_solver.child.search import Search


def test_what_is_not_said_has_its_default(folder: Path):
    deployment = read(folder, HEAD)
    assert deployment.project == "rover"
    assert deployment.bundles == (folder / "bundle",)
    assert deployment.runs == folder / "runs"
    assert deployment.file.mission.goal_probability == 0.9
    assert deployment.file.bus.listen == "", "the bus is a socket in the run directory"
    assert deployment.world is None


@pytest.mark.parametrize("seed", [1, MAX_SEED])
def test_every_seed_of_a_deploy_file_gives_decisions_seeds_of_64_bits(seed):
    of_steps = [Search(simulations=1, seed=seed).seed_of(step) for step in (1, 2)]
    assert len(set(of_steps)) == 2
    assert all(0 < each < 2**64 for each in of_steps)


def test_a_bundle_may_be_an_archive(folder: Path):
    archive = Path(shutil.make_archive(str(folder / "packed"), "zip", folder / "bundle"))
    deployment = read(folder, HEAD.replace("bundle]", "packed.zip]") + "leave_out: [look]\n")
    assert deployment.bundles == (archive,)
    assert sorted(files_of_bundle(archive, ("look",))) == ["drive.am", "drive.sd", "rover.ef"]


@pytest.mark.parametrize("text", ["leave_out: [look]\n", "watch: drop\n"])
def test_settings_of_a_skill_that_comes_later_are_taken(folder: Path, text):
    name = "look" if "look" in text else "new_skill"
    assert set(read(folder, HEAD + text + f"skills: {{{name}: {{retries: 2}}}}\n").file.skills) == {name}


def test_everything_that_can_be_said_arrives(folder: Path):
    deployment = read(
        folder,
        HEAD
        + """\
project: garden
leave_out: [look]
watch: drop
bus: {listen: tcp/127.0.0.1:0}
mission: {goal_probability: 1, step_limit: 7, stop_below_value: -2.5, activation_timeout_s: 9}
solver: {time_s: 0.5, horizon: 12, seed: 0x10, impossible_observation: reset}
world: room.yaml
bind: {/drive: pybullet}
runs: ../elsewhere
""",
    )
    file = deployment.file
    assert (deployment.project, file.leave_out, deployment.watch) == ("garden", ("look",), folder / "drop")
    assert (file.mission.goal_probability, file.mission.step_limit) == (1.0, 7)
    assert (file.solver.time_s, file.solver.horizon, file.solver.seed) == (0.5, 12, 16)
    assert (deployment.world, file.bind) == (folder / "room.yaml", {"/drive": "pybullet"})
    assert [adapter.name for adapter in deployment.adapters] == ["pybullet"]
    assert deployment.runs == folder.parent / "elsewhere"


@pytest.mark.parametrize("name", ["armadillo", "armadillo-rough", "armadillo-hotplug"])
def test_the_shipped_deploy_files_are_good(name):
    assert read_deploy_file(DEPLOY / f"{name}.yaml").file.robot == "armadillo"


def test_programs_stand_between_the_services_and_the_adapters(folder: Path):
    deployment = read(
        folder,
        HEAD
        + """\
adapters: {arm: {command: [./arm]}}
bind: {/drive: arm}
programs:
  sim: {command: [python, sim.py], ready: {port: 5555}, start_s: 5, stop_s: 7, on_exit: restart}
  nav: {command: [./nav], host: robot@arm, folder: /opt/nav, ready: {line: up}}
""",
    )
    programs = programs_of_deployment(deployment)
    assert [program.name for program in programs] == ["registry", "middleware", "sim", "nav", "arm", "solver"]
    sim, nav = programs[2:4]
    assert (sim.command, sim.folder, sim.ready) == (("python", "sim.py"), str(folder), ReadyPart(port=5555))
    assert (sim.start_s, sim.stop_s, sim.on_exit, sim.is_restarted) == (5, 7, "restart", True)
    assert (nav.host, nav.folder, nav.on_exit, nav.is_restarted) == ("robot@arm", "/opt/nav", "fault", False)
    assert [program.name for program in programs_of_deployment(without_a_robot(deployment))] == [
        "registry",
        "middleware",
        "model",
        "solver",
    ]


@pytest.mark.parametrize(
    ("part", "found"),
    [
        ("{ready: {port: 1}}", "AOS105 the key programs.nav.command is missing"),
        ("{command: []}", "AOS106 programs.nav.command names no program"),
        ("{command: ./nav}", "AOS106 programs.nav.command is not a list"),
        ("{command: [a], wait: 3}", "AOS102 unknown key programs.nav.wait"),
        (
            "{command: [a], on_exit: stop}",
            "AOS106 programs.nav.on_exit is stop; it must be fault, restart or ignore",
        ),
        ("{command: [a], ready: up}", "AOS106 programs.nav.ready is not a mapping of keys to values"),
        ("{command: [a], ready: {prot: 1}}", "AOS102 unknown key programs.nav.ready.prot. Did you mean"),
        ("{command: [a], ready: {port: 0}}", "AOS106 programs.nav.ready.port is 0"),
        ("{command: [a], ready: {}}", "AOS106 programs.nav.ready says nothing. Give it one of port, line,"),
        ("{command: [a], ready: {port: 1, line: up}}", "AOS106 programs.nav.ready says port and line."),
        ("{command: [a], ready: {line: '(up'}}", "AOS106 programs.nav.ready.line is no regular expression"),
        ("{command: [a], ready: {exit: 0}, on_exit: ignore}", "AOS106 programs.nav is to end, and on_exit"),
        ("{command: [a], host: -oProxy}", "AOS106 programs.nav.host is no host"),
        ("{command: [a], folder: x}", "AOS106 programs.nav.folder is given without a host"),
        ("{command: [a], host: arm, ready: {file: x}}", "AOS106 programs.nav.ready.file is looked for"),
        ("{command: [a], host: arm, ready: {port: 1}}", "AOS106 programs.nav.ready.port is looked for"),
    ],
)
def test_mistakes_about_programs_are_told_at_their_place(folder: Path, part, found):
    (finding,) = findings(folder, f"{HEAD}programs:\n  nav: {part}\n")
    line, _, said = finding.partition(" ")
    assert line.startswith("5:")
    assert said.startswith(found)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("solver", "AOS has these names for itself: router, registry"),
        ("watcher", "AOS has these names for itself: router, registry"),
        ("arm", "An adapter has this name"),
        ("two words", "Use letters, digits, - and _"),
    ],
)
def test_a_program_has_a_name_of_its_own(folder: Path, name, hint):
    text = f"{HEAD}adapters: {{arm: {{command: [./arm]}}}}\nbind: {{/drive: arm}}\n"
    (finding,) = findings(folder, f"{text}programs: {{{name}: {{command: [a]}}}}\n")
    assert f"AOS126 {name!r} is no name for a program. {hint}" in finding


def test_what_a_deploy_file_starts_is_looked_for_before_it_is_started(folder: Path):
    def missing(command: str) -> str:
        with pytest.raises(DeployError) as caught:
            check_needed_here(read(folder, f"{HEAD}programs: {{nav: {{command: {command}}}}}\n"))
        assert caught.value.code == "AOS802"
        return str(caught.value)

    (folder / "nav").write_text("#!/bin/sh\n")
    assert f"there is no program ./nac in {folder}" in missing("[./nac]")
    assert f"there is no file nav.py in {folder}" in missing("[python, nav.py]")
    assert f"Write ./nav for the one in {folder}" in missing("[nav]")
    assert f"Run chmod +x {folder / 'nav'}" in missing("[./nav]")
    (folder / "nav").chmod(0o755)
    for command in ("[./nav]", "[python, -m, x]", "[sh, -c, ls]", f"[{folder / 'nav'}]"):
        check_needed_here(read(folder, f"{HEAD}programs: {{nav: {{command: {command}}}}}\n"))


def test_the_hot_plug_file_leaves_out_the_sensing_skills():
    deployment = read_deploy_file(DEPLOY / "armadillo-hotplug.yaml")
    assert deployment.file.leave_out == ("observe_holding", "observe_arm_outstretched")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("bundels: [x]", "4:1 AOS102 unknown key bundels. Did you mean `bundles`?"),
        ("solver:\n  simulation: 5", "5:3 AOS102 unknown key solver.simulation. Did you mean `simulations`?"),
        ("zebra: 1", "4:1 AOS102 unknown key zebra. Known are adapters, aos, bind, bundles"),
        ("solver: {seed: many}", "4:16 AOS106 solver.seed is many; it must be a whole number"),
        ("solver: {seed: -1}", "4:16 AOS106 solver.seed is -1; it must be a whole number of at least 0"),
        ("solver: {seed: true}", "4:16 AOS106 solver.seed is true; it must be a whole number"),
        ("solver: {time_s: 0}", "4:18 AOS106 solver.time_s is 0; it must be a number above 0"),
        (
            "mission: {stop_below_value: .nan}",
            "4:29 AOS106 mission.stop_below_value is nan; it must be a finite",
        ),
        ("solver: {time_s: .inf}", "4:18 AOS106 solver.time_s is inf; it must be a finite number"),
        ("bind: {/drive: model, drive: pybullet}", "4:23 AOS103 the path /drive is bound twice"),
        ("solver: 3", "4:9 AOS106 solver is not a mapping of keys to values"),
        (
            "solver: {impossible_observation: dance}",
            "4:34 AOS106 solver.impossible_observation is dance; it must be hold, widen or reset",
        ),
        (
            "mission: {goal_probability: 1.5}",
            "4:29 AOS106 mission.goal_probability is 1.5; it must be a number of at most 1",
        ),
        (
            "solver: {planner: pompc}",
            "4:19 AOS106 solver.planner is pompc; it must be pomcp, despot, sarsop or auto. Did you",
        ),
        ("leave_out: look", "4:12 AOS106 leave_out is not a list"),
        ("leave_out: [drive, loook]", "4:20 AOS110 no bundle has a skill loook. Did you mean `look`?"),
        ("skills: {loook: {timeout_s: 1}}", "4:10 AOS110 no bundle has a skill loook. Did you mean `look`?"),
        ("watch: bundle/rover.ef", "4:8 AOS106 watch: "),
        ("leave_out: [zzz]", "4:13 AOS110 no bundle has a skill zzz. Known are drive, look"),
        ("bind: {/drive: 3}", "4:16 AOS106 bind./drive is not an adapter's name, and no mapping"),
        (
            "bind: {/drive: pybulet}",
            "4:16 AOS110 bind./drive names an unknown adapter, pybulet. Did you mean `p",
        ),
        ("bind: {'/dr*': pybullet}", "4:8 AOS106 '/dr*' is not an activation path"),
        ("bind: {/drive: {arm: go}}", "4:17 AOS110 bind./drive names an unknown adapter, arm"),
        ("bind: {/drive: {fields: {}}}", "4:16 AOS106 bind./drive does not name one adapter"),
        (
            "bind: {/drive: {pybullet: /go, fields: {x: 'goal.'}}}",
            "4:44 AOS106 bind./drive.fields.x is no expression",
        ),
        ("adapters: {arm: {port: 1}}", "4:12 AOS106 adapters.arm has no one kind but port"),
        ("adapters: {arm: {command: ./arm}}", "4:12 AOS106 adapters.arm.command is not a list of texts"),
        (
            "adapters: {arm: {command: [./arm], host: -oProxyCommand=x}}",
            "4:12 AOS106 adapters.arm.host is no host: '-oProxyCommand=x'",
        ),
        (
            "adapters: {arm: {command: [./arm], folder: /opt}}",
            "4:12 AOS106 adapters.arm.folder is given without a host",
        ),
        (
            "adapters: {arm: {python: arm.py}}\nbind: {'*': arm}",
            "5:13 AOS106 bind.* names arm, whose paths are bound one by one to functions. Write it as /pick:",
        ),
        (
            "bind: {'*': python}",
            "4:13 AOS106 bind.* names python, whose paths are bound one by one to functions. "
            "Write it as /pick: {python: FILE.py:pick}",
        ),
        (
            "bind: {'*': {pybullet: /go, fields: {}}}",
            '4:13 AOS106 bind.* says more than an adapter\'s name. Write it as "*": pybullet',
        ),
        ("adapters: {solver: external}", "4:12 AOS126 'solver' is no name for an adapter. AOS has"),
        ("adapters: {sim: {pybullet: a.yaml, wrld: b}}", "4:36 AOS102 unknown key adapters.sim.wrld"),
        ("bind: {/drive: command}", "1:1 AOS105 the adapter command has no command"),
        ("world: nowhere.yaml", "4:8 AOS101 there is no world file"),
        ("bus: {listen: tcp/0.0.0.0:7447}", "4:15 AOS106 'tcp/0.0.0.0:7447' is not an endpoint of this"),
        ("robot: twice", "4:1 AOS103 the key robot is given twice. First in line 2"),
        ("runs: &here x", "4:7 AOS104 anchors and aliases are not used here"),
        ("runs: !secret x", "4:7 AOS104 the tag !secret is not used here"),
        ("runs: [", "5:1 AOS104 not well-formed YAML"),
        ("solver: {simulations: 9, time_s: 1}", "4:34 AOS106 solver has both simulations and time_s"),
    ],
)
def test_a_mistake_is_named_with_its_place(folder: Path, text, found):
    assert findings(folder, f"{HEAD}{text}\n")[0].startswith(found)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", "1:0 AOS104 this file is empty"),
        ("- aos\n", "1:0 AOS104 not a mapping of keys to values"),
        ("aos: 1\nrobot: rover\n", "1:1 AOS105 the key bundles is missing"),
        (HEAD.replace("aos: 1", "aos: 2"), "1:6 AOS106 aos is 2; it must be 1"),
        (HEAD.replace("1", '"1"'), '1:6 AOS106 aos is the text "1"; it must be 1. Write it without quotes'),
        (HEAD.replace("rover", "my rover"), "2:8 AOS106 'my rover' is not a robot name. Use letters"),
        (HEAD.replace("[bundle]", "[]"), "3:10 AOS105 bundles names none. Name a bundle's folder"),
        (HEAD.replace("[bundle]", "[bundle, gone]"), "3:19 AOS101 there is no bundle folder"),
    ],
)
def test_what_a_file_must_have(folder: Path, text, found):
    assert findings(folder, text)[0].startswith(found)


def test_all_mistakes_are_found_in_one_run(folder: Path):
    text = f"{HEAD}leave_out: [lok]\nworld: gone.yaml\nsolver: {{sed: 1, seed: x}}\nmission: 3\n"
    assert [found.split()[0] for found in findings(folder, text)] == ["4:13", "5:8", "6:10", "6:24", "7:10"]


def test_a_path_of_an_adapter_with_a_mistake_is_none_as_well(folder: Path):
    text = f"{HEAD}adapters: {{arm: {{command: ./arm}}}}\nbind: {{'*': arm, /drive: {{arm: go}}}}\n"
    assert [found.split(".command")[0] for found in findings(folder, text)] == ["4:12 AOS106 adapters.arm"]


def test_a_path_that_is_nearly_one_of_a_skill_is_remarked_where_another_adapter_moves(folder: Path):
    deployment = read(
        folder, f"{HEAD}bind: {{/drvie: pybullet, /pick: pybullet, '*': model}}\nworld: room.yaml\n"
    )
    assert misspelt_paths(deployment, ["/drive", "/look"]) == (
        "`bind:` names /drvie, which no skill calls. Did you mean /drive? model serves that",
    )
    assert misspelt_paths(deployment, ["/drvie", "/look"]) == (), "a skill that picks may come"


def test_an_adapter_that_nothing_is_bound_to_is_remarked_unless_documents_play_all(folder: Path):
    text = HEAD + "adapters: {arm: {command: [./arm]}, eye: external}\nbind: {/drive: eye, '*': model}\n"
    deployment = read(folder, text)
    assert [remark.split(":")[0] for remark in unbound_adapters(deployment)] == ["arm is left out"]
    assert unbound_adapters(without_a_robot(deployment)) == ()


def test_a_file_that_is_not_there_or_not_text_is_told(folder: Path):
    with pytest.raises(DeployError) as absent:
        read_deploy_file(folder / "absent.yaml")
    assert absent.value.message == f"there is no deploy file {folder / 'absent.yaml'}"
    assert "aos new example" in absent.value.hint
    (folder / "binary.yaml").write_bytes(b"\xff\xfe")
    with pytest.raises(DeployError) as binary:
        read_deploy_file(folder / "binary.yaml")
    assert "not UTF-8" in binary.value.diagnostics[0].message


def test_only_endpoints_of_this_machine_are_taken():
    for good in ("tcp/127.0.0.1:7447", "tcp/localhost:0", "tcp/[::1]:7447"):
        check_endpoint(good)
    for bad in ("tcp/192.168.0.1:7447", "udp/127.0.0.1:7447", "127.0.0.1:7447", "tcp/127.0.0.1"):
        with pytest.raises(DeployError, match="not an endpoint of this machine"):
            check_endpoint(bad)


# --- a folder in place of the file ---


def test_a_folder_with_one_deploy_file_stands_for_it(folder: Path):
    (folder / "rover.yaml").write_text(HEAD)
    (folder / "tests.yaml").write_text("aos: 1\nmissions: []\n")
    assert read_deploy_file(folder).path == folder / "rover.yaml"


def refusal(path: Path) -> str:
    with pytest.raises(DeployError) as caught:
        read_deploy_file(path)
    assert caught.value.code == "AOS801"
    return str(caught.value)


def test_a_folder_with_several_deploy_files_is_refused_with_their_names(folder: Path):
    for name in ("a", "b"):
        (folder / f"{name}.yaml").write_text(HEAD)
    assert f"has 2 deploy files. Name one: {folder / 'a.yaml'}, {folder / 'b.yaml'}" in refusal(folder)


def test_a_bundle_is_refused_with_the_deploy_file_beside_it(folder: Path, monkeypatch):
    monkeypatch.chdir(folder)
    text = refusal(Path("bundle"))
    assert text.endswith("no deploy file. Write one for it: aos new adapter model --in bundle")
    (folder / "rover.yaml").write_text(HEAD)
    assert refusal(Path("bundle")).endswith("no deploy file. Name one that has it: rover.yaml")


def test_a_folder_of_anything_else_is_refused_with_what_to_give(folder: Path):
    (folder / "empty").mkdir()
    assert "is a folder without a deploy file. Name a deploy file" in refusal(folder / "empty")
