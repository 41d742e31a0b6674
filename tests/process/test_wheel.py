from collections.abc import Iterator
from pathlib import Path

import pytest
from installed import SIMULATOR, Installation, built_wheel, install, link_packages
from places import ROOT

ANY_PORT = ("--listen", "tcp/127.0.0.1:0")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    return built_wheel(ROOT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def aos_without_sim(wheel: Path, cache_dir: Path, tmp_path_factory) -> Installation:
    place = tmp_path_factory.mktemp("without-sim")
    install(wheel, place / "environment", without=SIMULATOR)
    (place / "empty").mkdir()
    return Installation(place / "environment", place / "empty", cache_dir)


@pytest.fixture
def aos(aos_without_sim: Installation, tmp_path, cache_dir: Path) -> Iterator[Installation]:
    environment = aos_without_sim.commands.parent
    links = link_packages(environment, only=SIMULATOR)
    assert links
    yield Installation(environment, tmp_path, cache_dir)
    for link in links:
        link.unlink()


def test_the_wheel_has_a_name_of_its_own(wheel: Path):
    assert wheel.name.startswith("aos_autonomy-")


@pytest.mark.physics
def test_the_main_job_runs_from_an_empty_folder(aos: Installation):
    assert aos.run("aos", "new", "example", "armadillo").returncode == 0
    deploy = aos.folder / "armadillo" / "armadillo.yaml"
    deploy.write_text(deploy.read_text().replace("step_limit: 30", "step_limit: 2"))
    done = aos.run("aos-up", "armadillo/armadillo.yaml", *ANY_PORT)
    assert "step  2: pick -> " in done.stdout, done.stderr
    assert done.returncode == 6, done.stderr
    assert (aos.folder / "runs" / "latest" / "summary.json").is_file()


def test_a_benchmark_runs_from_an_empty_folder(aos_without_sim: Installation):
    done = aos_without_sim.run("aos", "bench", "tiger", "--metric", "steps", "--quick", "--json")
    assert done.returncode == 0, done.stderr
    assert '"name": "by hand"' in done.stdout


def test_a_simulated_room_without_the_extra_says_what_to_install(aos_without_sim: Installation):
    aos_without_sim.run("aos", "new", "example", "armadillo")
    done = aos_without_sim.run("aos-up", "armadillo/armadillo.yaml", *ANY_PORT)
    assert done.returncode == 3
    assert "needs the package pybullet" in done.stderr
    assert "pip install 'aos-autonomy[sim]'" in done.stderr


def test_the_doctor_can_do_without_the_simulator(aos_without_sim: Installation):
    done = aos_without_sim.run("aos", "doctor")
    assert done.returncode == 0
    assert "pip install 'aos-autonomy[sim]'" in done.stdout
