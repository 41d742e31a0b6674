import shutil
from collections.abc import Mapping
from pathlib import Path

from .cases import MAPPINGS
from .counters import counting

DEPLOY_FILE = "cell.yaml"
HOSTILE = "reach"
"""The skill with hostile code, where there is one."""

_PROJECT = "cell"
_STEPS = "1000000"
_GOOD = "step"
_GOOD_REWARD, _HOSTILE_REWARD = 1, 2
"""The robot prefers whatever is hostile, and has a reason to go on without it."""

# A mission that waits for documents is to leave the processor to them: no search beside the robot, which
# takes its time. Each hostile mapping is run again as long as it is there, or once.
_DEPLOY = """aos: 1
robot: cell
bundles: [good]
bus: {listen: "tcp/127.0.0.1:0"}
mission: {step_limit: 1000000, failure_limit: 1000000, set_aside_after: TIMES, set_aside_s: 100000}
solver: {simulations: 20, ponder_while_acting: false}
runs: runs
bind:
"""
_BOUND = '  /SKILL: {python: "robot.py:act"}\n'
_OFTEN = 1000000
_ROBOT = "import time\n\n\ndef act(call):\n    time.sleep(0.1)\n    return {}\n"
_RESULT = """local_variable: value
from_ros_service_response: true
code:
CODE
"""
"""The rest of a mapping, whose code is Python."""
_CODE_LINE = {"mapping": 10, "model": 5, "compiler": 5}
_HARMLESS = "value = 1"


def hostile_skills() -> dict[str, str]:
    return {f"{HOSTILE}{number}": name for number, name in enumerate(MAPPINGS)}


def write_system(place: Path, *, times: int = _OFTEN) -> Path:
    """Writes a deploy file and its bundle with the good skill; returns the bundle.

    A skill that has failed so many `times` in a row is not chosen again.
    """
    shutil.rmtree(place, ignore_errors=True)
    bundle = place / "good"
    bundle.mkdir(parents=True)
    bound = "".join(_BOUND.replace("SKILL", skill) for skill in (_GOOD, HOSTILE, *hostile_skills()))
    (place / DEPLOY_FILE).write_text(_DEPLOY.replace("TIMES", str(times)) + bound)
    (place / "robot.py").write_text(_ROBOT)
    files = counting(_PROJECT, _GOOD, steps=_STEPS, reward=_GOOD_REWARD)
    (bundle / "cell.ef").write_text(files["cell.ef"])
    (bundle / f"{_GOOD}.sd").write_text(files[f"{_GOOD}.sd"])
    (bundle / f"{_GOOD}.am").write_text(files[f"{_GOOD}.am"] + _RESULT.replace("CODE", _HARMLESS))
    return bundle


def write_hostile(bundle: Path, kind: str, skills: Mapping[str, str], *, deeper: int = 0):
    """Writes skills with hostile code into a bundle. Code of a mapping stands so many lines `deeper`."""
    bundle.mkdir(exist_ok=True)
    for skill, code in skills.items():
        model, mapping = ("", "\n" * deeper + code) if kind == "mapping" else (code, _HARMLESS)
        files = counting(_PROJECT, skill, code=model, reward=_HOSTILE_REWARD)
        (bundle / f"{skill}.sd").write_text(files[f"{skill}.sd"])
        (bundle / f"{skill}.am").write_text(files[f"{skill}.am"] + _RESULT.replace("CODE", mapping))


def place_of(kind: str, skill: str, *, deeper: int = 0) -> str:
    """The words that tell the place of hostile code. Model code that goes on for ever is told at its head."""
    return f"{skill}.am:{_CODE_LINE[kind] + deeper}:" if kind == "mapping" else f"{skill}.sd:"
