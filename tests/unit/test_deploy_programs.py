from pathlib import Path

import msgspec
from deploy_files import HEAD, read

from aos_deploy.processes.program import programs_of_deployment
from aos_runtime.adapters import AdapterSettings, Binding


def test_services_are_told_what_the_file_says(folder: Path, monkeypatch):
    monkeypatch.setenv("AOS_CACHE_DIR", str(folder / "cache"))
    deployment = read(folder, f"{HEAD}watch: drop\nworld: room.yaml\nbind: {{/drive: pybullet}}\n")
    programs = {program.name: program for program in programs_of_deployment(deployment)}

    assert list(programs) == ["registry", "middleware", "pybullet", "solver"]
    assert programs["registry"].settings == {"watch": str(folder / "drop")}
    assert programs["middleware"].settings == {
        "project": "rover",
        "activation_timeout_s": 120.0,
        "played": [],
        "elsewhere": [],
    }
    adapter = msgspec.convert(
        programs["pybullet"].settings | {"robot": "", "service": "", "endpoint": "", "run_dir": ""},
        AdapterSettings,
    )
    assert adapter.adapter == "aos_skills.pybullet.adapter:PybulletAdapter"
    assert adapter.options == {"world": str(folder / "room.yaml")}
    assert adapter.bind == {"/drive": Binding()}
    solver = programs["solver"].settings
    assert solver["cache_dir"] == str(folder / "cache")
    assert "time_s" not in solver
    assert solver["goal_probability"] == 0.9


def test_the_middleware_is_told_which_skills_are_played_by_their_documents(folder: Path):
    deployment = read(folder, HEAD + 'bind: {/pick: model, /drive: external, "*": model}\n')
    programs = {program.name: program for program in programs_of_deployment(deployment)}
    assert programs["middleware"].settings["played"] == ["/pick", "*"]
    assert programs["middleware"].settings["elsewhere"] == ["/drive"]


def test_a_command_is_started_in_the_folder_of_the_deploy_file_or_of_its_host(folder: Path):
    text = """\
adapters: {near: {command: [./arm]}, far: {command: [./arm], host: robot@arm, folder: /opt/arm}}
bind: {/pick: near, /place: far}
"""
    programs = {program.name: program for program in programs_of_deployment(read(folder, HEAD + text))}
    assert (programs["near"].folder, programs["near"].host) == (str(folder), "")
    assert (programs["far"].folder, programs["far"].host) == ("/opt/arm", "robot@arm")


def test_adapters_get_their_paths_their_options_and_what_others_serve(folder: Path):
    deployment = read(
        folder,
        HEAD
        + """\
adapters:
  arm: {command: [./arm, --fast]}
  base: external
bind:
  /pick: {arm: /grasp, fields: {x: goal.x, speed: 2}, result: {success: "result == 'true'"}}
  drive: base
  "*": pybullet
""",
    )
    arm, base, world = deployment.adapters
    assert arm.bind == {
        "/pick": Binding(
            target="/grasp", fields={"x": "goal.x", "speed": "2"}, result={"success": "result == 'true'"}
        )
    }
    assert (arm.is_command, arm.options) == (True, {"command": ["./arm", "--fast"]})
    assert (base.name, base.is_process, base.bind) == ("base", False, {"/drive": Binding()})
    assert (world.name, world.serves_others, world.elsewhere) == ("pybullet", True, ("/pick", "/drive"))
    programs = {program.name: program for program in programs_of_deployment(deployment)}
    assert "base" not in programs
    assert programs["arm"].argv(Path("settings.json"))[-2:] == ["./arm", "--fast"]
