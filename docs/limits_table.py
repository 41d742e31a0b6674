"""The table of docs/limits.md: every limit that a user can meet, with its value read from the sources.

A place is `module.CONSTANT` or `module.Struct.field` of Python, or `header:name` below the engine's `aos`.
A value that has moved is an error here, so that the page cannot tell an old one.
"""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from typing import NamedTuple

import msgspec

__all__ = ["limits_table", "value_at"]

ENGINE = Path(__file__).resolve().parents[1] / "services/solver/aos_solver/cpp/aos"


class Row(NamedTuple):
    """A limit; `unit` is s, bytes, or what is counted. `key` is how a user sets it, if one can."""

    what: str
    place: str
    unit: str
    beyond: str
    key: str = ""


LIMITS: dict[str, tuple[Row, ...]] = {
    "Documents and bundles": (
        Row("a document", "aos_language.reading.source.MAX_FILE_BYTES", "bytes", "AOS120"),
        Row(
            "a bundle, or an archive of one",
            "aos_language.reading.files.MAX_BUNDLE_BYTES", "bytes", "AOS120",
        ),
        Row("files in a bundle", "aos_language.reading.files.MAX_BUNDLE_FILES", "", "AOS120"),
        Row("an archive, unpacked", "aos_language.archive.MAX_UNPACKED_BYTES", "bytes", "refused"),
        Row("unpacked to packed size", "aos_language.archive.MAX_RATIO", "times", "refused"),
        Row(
            "values in one another in JSON",
            "aos_language.reading.json_text.MAX_NESTING", "levels", "AOS104",
        ),
        Row("brackets in one another in code", "aos_language.cpp.tokens.MAX_NESTING", "levels", "AOS108"),
        Row("special states that count once", "aos_solver.emission.lower._MAX_FLAGS", "", "AOS124"),
        Row(
            "a dropped folder is complete when nothing changed for",
            "aos_registry.settings.Settings.quiet_s", "s", "it is read",
        ),
        Row("one that always changes is read after", "aos_registry.watch._LONGEST_WAIT_S", "s", "it is read"),
    ),
    "Models": (
        Row("a state", "aos_solver.building.build.MAX_STATE_BYTES", "bytes", "AOS201"),
        Row(
            "a vector that grows by code, unless the code tells more",
            "aos_solver.emission.lower_capacities.GROWING_CAPACITY", "elements", "AOS215",
        ),
        Row(
            "a vector that the robot's data fill, unless it has a length at the start",
            "aos_solver.emission.lower_capacities.REPORTED_CAPACITY", "elements", "AOS215",
        ),
        Row("one command of g++ or clang++", "aos_solver.building.compiler.DEADLINE_S", "s", "AOS202"),
        Row(
            "one command of ziglang's compiler",
            "aos_solver.building.compiler.ZIG_DEADLINE_S", "s", "AOS202",
        ),
        Row(
            "memory of the compiler",
            "aos_solver.building.compiler_run._ADDRESS_SPACE_BYTES", "bytes", "AOS202",
        ),
        Row("the start of an engine", "aos_solver.child.engine_child.START_DEADLINE_S", "s", "AOS211"),
        Row("memory of an engine", "aos_solver.child.engine_child.ADDRESS_SPACE_BYTES", "bytes", "AOS213"),
        Row(
            "what a model prints",
            "aos_solver.child.printed.PRINT_LIMIT_BYTES", "bytes", "the rest is dropped",
        ),
        Row(
            "one call of document code, in tenths of a second of processor time",
            "aos_solver.child.engine_child.HANG_PERIODS", "", "AOS211",
        ),
        Row(
            "combinations of discrete draws in a step",
            "base/enumerator.hpp:path_budget", "", "beliefs and plans are sampled",
        ),
        Row(
            "memory for the rounds of loops that draw, in one step",
            "base/loop_chain.hpp:max_key_bytes", "bytes", "beliefs and plans are sampled",
        ),
        Row(
            "a model that is not used is kept for",
            "aos_solver.building.build_cache._UNUSED_AFTER_S", "s", "built anew",
        ),
        Row(
            "the cache of compiled models",
            "aos_solver.building.build_cache._SIZE_BYTES", "bytes", "the longest unused are removed",
        ),
    ),
    "Planning": (
        Row(
            "states that searches number",
            "planning/listed/state_lister.hpp:states", "", "POMCP without them",
        ),
        Row(
            "states whose values POMCP computes",
            "planning/values/wide_values.hpp:states", "", "learned values",
        ),
        Row(
            "outcomes of these states",
            "planning/listed/state_lister.hpp:outcomes", "", "POMCP without them",
        ),
        Row("states of an exact belief", "belief/belief.hpp:max_weighted_states", "", "particles"),
        Row("particles of a sampled belief", "belief/history.hpp:particle_count", "", "drawn anew"),
        Row(
            "memory of the search trees",
            "planning/pomcp/pomcp_constants.hpp:max_search_bytes", "bytes", "trees grow no more",
        ),
        Row("threads of a search", "planning/budget.hpp:max_search_threads", "", "refused", "`threads`"),
        Row("states of `aos solve`", "aos_solver.offline.enumeration.MAX_STATES", "", "AOS220", "`--states`"),
        Row(
            "states of a problem file",
            "aos_lab.formats.factored_model.MAX_STATES", "", "AOS220", "`--states`",
        ),
        Row(
            "memory of `aos solve`",
            "aos_solver.offline.solving._ADDRESS_SPACE_BYTES", "bytes", "the best so far",
        ),
        Row("`aos plan --exact`", "aos_solver.child.mission_questions.EXACT_TIME_S", "s", "AOS220"),
        Row(
            "an answer of the engine, beside what it may plan",
            "aos_solver.child.asking.ANSWER_DEADLINE_S", "s", "AOS211",
        ),
        Row(
            "a decision, beyond its budget in time",
            "aos_solver.child.mission_questions.PLANNING_DEADLINE_S", "s", "AOS211",
        ),
        Row(
            "`aos lint` looks for goals and preconditions that nothing leads to",
            "aos_deploy.reachability._TIME_S", "s", "it tells how far it looked",
        ),
    ),
    "Missions": (
        Row(
            "steps",
            "aos_deploy.deploy_file.MissionPart.step_limit", "",
            "ending `step_limit`", "`mission.step_limit`",
        ),
        Row(
            "one answer with decision records",
            "aos_solver.mission.history.PAGE_RECORDS", "", "the next page has the rest",
        ),
        Row(
            "an activation", "aos_deploy.deploy_file.MissionPart.activation_timeout_s", "s",
            "outcome `timed_out`", "`mission.activation_timeout_s`, `max_duration`",
        ),
        Row(
            "failures in a row of one skill",
            "aos_deploy.deploy_file.MissionPart.set_aside_after", "",
            "it is set aside", "`mission.set_aside_after`",
        ),
        Row(
            "the time for which a skill is set aside",
            "aos_deploy.deploy_file.MissionPart.set_aside_s", "s",
            "it may be chosen again", "`mission.set_aside_s`",
        ),
        Row(
            "failures of all skills in a mission",
            "aos_deploy.deploy_file.MissionPart.failure_limit", "",
            "ending `skills_failed`", "`mission.failure_limit`",
        ),
        Row(
            "combinations of what skills did that nobody observed",
            "belief/hypotheses.hpp:max_hypotheses", "",
            "the oldest row of failures is closed",
        ),
        Row(
            "holding, when no skill can be run or a person is waited for",
            "aos_deploy.deploy_file.MissionPart.hold_s", "s", "AOS513", "`mission.hold_s`",
        ),
        Row(
            "a replay of the mission's past in new documents",
            "aos_solver.mission.takeover.REPLAY_S", "s", "the belief is projected",
        ),
        Row(
            "solver waits for an activation longer than the activation's own limit",
            "aos_solver.bus_ports.ACTIVATION_MARGIN_S", "s", "outcome `unknown`",
        ),
        Row(
            "solver or middleware asks the registry something small, or the solver the middleware",
            "aos_runtime.registry_watch.ASK_TIMEOUT_S", "s", "AOS601",
        ),
        Row(
            "solver waits for the middleware to generate the mappings before the first step",
            "aos_solver.mapping_watch.MAPPING_DEADLINE_S", "s", "ending `fault`",
        ),
        Row(
            "a mission is waited for that is to begin, with documents that are still compiled",
            "aos_runtime.steering.START_TIMEOUT_S", "s", "AOS601",
        ),
        Row(
            "a mission is waited for that is stopped, or that is to carry out an action of an operator",
            "aos_runtime.steering.STEER_TIMEOUT_S", "s", "AOS601",
        ),
        Row(
            "conditions with which a mission begins",
            "aos_solver.mission.conditions.MAX_CONDITIONS", "", "AOS142",
        ),
        Row(
            "registry asks the solver whether documents can be used (this compiles)",
            "aos_registry.settings.Settings.model_check_timeout_s", "s", "the push is refused",
        ),
        Row("`aos bundle push` waits for that", "aos_deploy.commands.bundle.PUSH_TIMEOUT_S", "s", "AOS601"),
    ),
    "Mappings and adapters": (
        Row("loading a mapping's module", "aos_middleware.settings.Settings.load_s", "s", "AOS403"),
        Row("one function of a mapping", "aos_middleware.settings.Settings.evaluation_s", "s", "AOS403"),
        Row(
            "memory of mapping code",
            "aos_middleware.evaluator.EvaluationLimits.address_space_bytes", "bytes", "AOS401",
        ),
        Row(
            "files that mapping code writes",
            "aos_middleware.evaluator.EvaluationLimits.file_bytes", "bytes", "AOS401",
        ),
        Row(
            "middleware waits for topic messages sent during a call, after its end",
            "aos_middleware.heard_topics.CATCH_UP_S", "s", "it goes on without",
        ),
        Row(
            "an adapter's word that a skill has stopped which its mapping or a monitor stops",
            "aos_middleware.stopping.STOP_S", "s", "it is asked again",
        ),
        Row(
            "an activation waits for new monitors to be at work",
            "aos_middleware.monitors.LISTEN_S", "s", "it begins without",
        ),
        Row("topic messages that wait", "aos_middleware.heard_topics.QUEUE_SIZE", "", "the oldest are lost"),
        Row(
            "topic messages an adapter has not sent",
            "aos_runtime.adapters.outbox.MAX_UNSENT_MESSAGES", "", "the oldest are lost",
        ),
        Row(
            "an adapter stops a call that is cancelled",
            "aos_runtime.adapters.settings.AdapterSettings.cancel_s", "s", "its process ends",
        ),
        Row(
            "an adapter or a service is started within 60 s",
            "aos_deploy.restarts.STARTS", "times", "the mission ends",
        ),
        Row(
            "the same for an adapter that was ready after its last start",
            "aos_deploy.restarts.STARTS_OF_ADAPTER", "times", "the mission ends",
        ),
    ),
    "Robots that speak ROS": (
        Row("a server or publisher appears", "aos_skills.ros.node.DISCOVERY_S", "s", "AOS505"),
        Row("a goal ends after it was cancelled", "aos_skills.ros.action_client.CANCEL_S", "s", "AOS504"),
        Row(
            "the process that speaks ROS 1 becomes ready", "aos_skills.ros1.process.START_S", "s", "AOS605",
        ),
        Row(
            "a message of ROS 1, as text",
            "aos_skills.ros1.process.MAX_LINE_BYTES", "bytes", "it is left out",
        ),
        Row(
            "a call by a node that is served",
            "aos_skills.ros.server.ServerSettings.timeout_s", "s", "AOS503",
        ),
    ),
    "Processes and bus": (
        Row(
            "a service becomes ready, unless its program says otherwise",
            "aos_deploy.program.Program.start_s", "s", "AOS802",
        ),
        Row(
            "a service stops by itself before it is killed, unless its program says otherwise",
            "aos_deploy.program.Program.stop_s", "s", "it is killed",
        ),
        Row(
            "`aos-up` waits for the end of a service that may be why the mission has failed",
            "aos_deploy.mission_run.CAUSE_NOTICE_S", "s", "no cause is told",
        ),
        Row(
            "a frozen process is taken for dead (a dead one at once)",
            "aos_runtime.bus_config.LEASE_S", "s", "it has left the bus",
        ),
        Row(
            "the same for a frozen adapter",
            "aos_runtime.bus_config.ADAPTER_LEASE_S", "s", "its skills are unavailable",
        ),
        Row("a message on the bus", "aos_protocol.codec.MAX_BYTES", "bytes", "AOS602"),
    ),
}  # fmt: skip


def limits_table() -> str:
    """The tables as Markdown, a heading above each."""
    parts = []
    for title, rows in LIMITS.items():
        lines = [f"## {title}", "", "| What | At most | Beyond it | Set by |"]
        lines += ["| --- | --- | --- | --- |", *map(_line, rows)]
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


def _line(row: Row) -> str:
    value = _text(value_at(row.place), row.unit)
    return f"| {row.what} | {value} | {_linked(row.beyond)} | {row.key} |"


def value_at(place: str) -> float:
    """The value of a constant or of a field's default; AttributeError if it is not there any more."""
    if ".hpp:" in place:
        return _value_in_header(*place.split(":"))
    parts = place.split(".")
    try:
        if parts[-2][0].isupper():
            struct = getattr(importlib.import_module(".".join(parts[:-2])), parts[-2])
            return next(field.default for field in msgspec.structs.fields(struct) if field.name == parts[-1])
        return float(getattr(importlib.import_module(".".join(parts[:-1])), parts[-1]))
    except (AttributeError, ImportError, StopIteration) as error:
        raise AttributeError(f"docs/limits_table.py: {place} is not there any more") from error


def _value_in_header(header: str, name: str) -> float:
    text = (ENGINE / header).read_text(encoding="utf-8")
    found = re.search(rf"\b{name} = (?:std::size_t\{{(\d+)\}} << )?([\d']+)", text)
    if found is None:
        raise AttributeError(f"docs/limits_table.py: {header} has no {name} any more")
    number = int(found[2].replace("'", ""))
    return int(found[1]) << number if found[1] else number


def _text(value: float, unit: str) -> str:
    if unit == "bytes" and value % 10**6 == 0:
        return f"{value / 10**6:g} MB"
    if unit == "bytes":
        return next(
            f"{value / size:g} {name}"
            for name, size in (("GiB", 2**30), ("MiB", 2**20), ("KiB", 2**10), ("bytes", 1))
            if value >= size
        )
    if unit == "s":
        return f"{value / 86400:g} days" if value >= 86400 else f"{value:g} s"
    return f"{value:,g} {unit}".strip() if value < 1e6 else f"{int(value):,} {unit}".strip()


def _linked(text: str) -> str:
    return re.sub(r"AOS\d{3}", lambda code: f"[{code[0]}](errors.md)", text)
