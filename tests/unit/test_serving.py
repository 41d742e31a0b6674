"""The paths that are served to ROS: the types from the deploy file and from documents, and what is said of
mistakes."""

import re
from pathlib import Path

import pytest
from commands import aos
from places import BUNDLES, DEPLOY, ROOT

from aos_deploy.deployment.reading import Deployment, read_deploy_file
from aos_deploy.missions.serve_run import serving_program
from aos_language.load import load_bundle
from aos_protocol.errors import DeployError
from aos_skills.ros.adapter import Way, way_to
from aos_skills.ros.documented import documented


def deployment(folder: Path, serve: str) -> Deployment:
    path = folder / "robot.yaml"
    path.write_text(
        f"aos: 1\nrobot: armadillo\nbundles: [{ROOT}/deploy/bundles/armadillo-finer]\n"
        f"world: {ROOT}/deploy/worlds/armadillo.yaml\nbind: {{'*': pybullet}}\n{serve}"
    )
    return read_deploy_file(path)


def test_types_are_written_shortly_or_in_full(tmp_path):
    program = serving_program(
        deployment(
            tmp_path,
            "serve:\n  types: {/pick: std_srvs/Trigger, serve: std_srvs/srv/Trigger,"
            " /joints: a_msgs/msg/Joints}\n"
            "  ros1: {master: 'http://127.0.0.1:1'}\n",
        ),
        "ros1",
    )
    assert program.settings["types"] == {
        "/pick": "std_srvs/srv/Trigger",
        "/serve": "std_srvs/srv/Trigger",
        "/joints": "a_msgs/msg/Joints",
    }
    assert program.settings["options"]["master"] == "http://127.0.0.1:1"


@pytest.mark.parametrize(
    ("serve", "kind", "message"),
    [
        ("", "ros2", r"nothing in robot\.yaml has a ROS type .*serve: \{types: \{/pick"),
        (
            "serve: {types: {/pick: std_srvs/Trigger}}\n",
            "ros3",
            "nothing can be served as 'ros3'. Known are ros2",
        ),
        (
            "serve: {type: {}}\n",
            "ros2",
            r"serve in robot\.yaml has an unknown key type. Its keys are interfaces",
        ),
        ("serve: {ros1: {domain: 1}}\n", "ros1", r"serve\.ros1 in robot\.yaml has an unknown key domain"),
        ("serve: {ros1: here}\n", "ros1", r"serve\.ros1 in robot\.yaml is not a mapping"),
        ("serve: {types: {/pick: Trigger}}\n", "ros2", "'Trigger' is not the name of a ROS interface"),
    ],
)
def test_mistakes_are_said_with_their_place(tmp_path, serve, kind, message):
    with pytest.raises(DeployError, match=message):
        serving_program(deployment(tmp_path, serve), kind)


def test_the_shipped_robot_has_a_type_for_every_path_and_topic():
    shipped = read_deploy_file(DEPLOY / "armadillo-robot.yaml")
    types = serving_program(shipped, "ros2").settings["types"]
    loaded = load_bundle(BUNDLES / "armadillo-finer")
    assert loaded.project is not None
    known = documented(loaded.project)
    assert {*known.paths, *known.topics, "/retract"} == set(types)


@pytest.mark.corpus
def test_original_mappings_name_their_services_types(corpus: Path):
    project = load_bundle(corpus / "armadillo-rough").project
    assert project is not None
    assert documented(project).paths == {
        "/pick_unknown": "robotican_demos_upgrade/srv/pick_unknown",
        "/custom_actions/navigate": "armadillo_navigation_upgrade/srv/navigate_srv",
        "/arm_outstretched_indicator": "robotican_demos_upgrade/srv/arm_outstretched_indicator",
        "/object_grasp_indicator": "robotican_demos_upgrade/srv/grasp_indicator",
        "/deliver_to_person": "std_srvs/srv/Trigger",
    }


@pytest.mark.parametrize(
    ("target", "way"),
    [
        (None, Way("", "/pick")),
        ("arm/pick", Way("", "/arm/pick")),
        ({"service": "/arm/pick"}, Way("service", "/arm/pick")),
        ({"action": "/go", "type": "a_msgs/action/Go"}, Way("action", "/go", "a_msgs/action/Go")),
    ],
)
def test_a_path_is_bound_to_a_name_a_service_or_an_action(target, way):
    assert way_to("/pick", target) == way


@pytest.mark.parametrize(
    "target", [3, {}, {"topic": "/pick"}, {"service": "/a", "action": "/b"}, {"action": 1}]
)
def test_anything_else_is_an_error_that_shows_how_to_write_it(target):
    with pytest.raises(
        DeployError, match=r"/pick is bound to .*Write the name of one, or \{service: /pick\}"
    ):
        way_to("/pick", target)


@pytest.mark.parametrize("kind", ["ros2", "dds", "ros1"])
def test_a_new_adapter_is_a_deploy_file_and_a_list_of_the_interfaces_it_needs(kind, tmp_path):
    bundle = BUNDLES / "armadillo-finer"
    command = ["new", "adapter", kind, "--in", str(bundle), "--to", str(tmp_path)]
    made = aos(*command)
    assert made.exit_code == 0, made.output
    (adapter,) = read_deploy_file(tmp_path / "armadillo.yaml").adapters
    page = re.search(r"in the sources of AOS, (\S+)\.$", (tmp_path / "armadillo.yaml").read_text(), re.M)
    assert (ROOT / page[1]).is_file()
    assert (adapter.kind_name, adapter.serves_others) == (kind, True)
    assert "`/pick`: the type that the robot says" in (tmp_path / "interfaces" / "README.md").read_text()


def test_an_example_brings_its_interfaces_along(tmp_path):
    made = aos("new", "example", "armadillo-robot", "--in", tmp_path / "robot")
    assert made.exit_code == 0, made.output
    assert (tmp_path / "robot" / "interfaces" / "armadillo_skills" / "srv" / "Navigate.srv").is_file()
