"""The exit codes of aos-up and aos: one number that says what happened."""

from enum import IntEnum

from aos_protocol.errors import AosError
from aos_protocol.messages import MissionState


class ExitCode(IntEnum):
    GOAL_REACHED = 0
    DOCUMENTS_WRONG = 1
    USAGE = 2
    NOT_STARTED = 3
    MISSION_FAILED = 4
    NOTHING_WORTHWHILE = 5
    STEP_LIMIT = 6
    FAULT = 7
    MISSION_OVER = 8
    SKILLS_FAILED = 9
    TOO_RISKY = 10
    INTERRUPTED = 130


_MEANINGS = {
    ExitCode.GOAL_REACHED: "the goal was reached, as the belief has it",
    ExitCode.DOCUMENTS_WRONG: "documents or the deploy file have errors",
    ExitCode.USAGE: "the command was used wrongly",
    ExitCode.NOT_STARTED: "the machine lacks something, or a service could not start",
    ExitCode.MISSION_FAILED: "the mission failed",
    ExitCode.NOTHING_WORTHWHILE: "no action was worth taking any more",
    ExitCode.STEP_LIMIT: "the step limit was reached",
    ExitCode.FAULT: "a fault while the mission ran",
    ExitCode.MISSION_OVER: "the mission ended with neither its goal nor a failure",
    ExitCode.SKILLS_FAILED: "skills kept failing",
    ExitCode.TOO_RISKY: "every action risked more than the mission's constraints allow",
    ExitCode.INTERRUPTED: "interrupted",
}

EXIT_CODES_TEXT = "Exit codes: " + ", ".join(f"{code:d} {text}" for code, text in _MEANINGS.items()) + "."

_BY_ENDING = {
    "goal": ExitCode.GOAL_REACHED,
    "over": ExitCode.MISSION_OVER,
    "failure": ExitCode.MISSION_FAILED,
    "nothing_worthwhile": ExitCode.NOTHING_WORTHWHILE,
    "step_limit": ExitCode.STEP_LIMIT,
    "skills_failed": ExitCode.SKILLS_FAILED,
    "too_risky": ExitCode.TOO_RISKY,
    "cancelled": ExitCode.INTERRUPTED,
    "fault": ExitCode.FAULT,
}


def exit_code_of_mission(state: MissionState) -> ExitCode:
    """The exit code of a mission that has ended."""
    if state.ending == "not_started":
        return _before_the_mission(state.code)
    return _BY_ENDING.get(state.ending, ExitCode.FAULT)


def exit_code_of_ending(ending: str) -> ExitCode:
    """The exit code of a mission of a system that stays, by its ending."""
    return _BY_ENDING.get(ending, ExitCode.FAULT)


def exit_code_of_error(error: AosError) -> ExitCode:
    """The exit code of a command that ended by this fault, and of a mission that it kept from starting."""
    return _before_the_mission(error.code)


def _before_the_mission(code: str) -> ExitCode:
    if code in ("AOS501", "AOS530"):
        return ExitCode.USAGE  # Nothing has failed: there is no such thing, or it cannot be asked so.
    if code.startswith(("AOS1", "AOS32")) or code in ("AOS201", "AOS801", "AOS808", "AOS810", "AOS901"):
        return ExitCode.DOCUMENTS_WRONG
    if code.startswith(("AOS6", "AOS8")) or code in (
        "AOS202",
        "AOS203",
        "AOS515",
        "AOS516",
        "AOS517",
        "AOS518",
        "AOS701",
    ):
        return ExitCode.NOT_STARTED
    return ExitCode.FAULT
