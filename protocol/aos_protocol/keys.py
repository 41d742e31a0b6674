"""Every key expression on the bus; the only file that spells one.

    aos/<robot>/live/<service>      token   the service is ready
    aos/<robot>/bundle/push         query   a bundle for the registry              PushBundle -> BundleReport
    aos/<robot>/bundle/remove       query   a skill or project to give up     RemoveDocuments -> BundleReport
    aos/<robot>/bundle/history      query   all revisions of a project            RevisionsQuery -> Revisions
    aos/<robot>/bundle/project      query   the documents of a project        ProjectQuery -> ProjectRevision
    aos/<robot>/bundle/list         query   what the catalogue holds              CatalogueQuery -> Catalogue
    aos/<robot>/bundle/announced    stream  a new project revision                            ProjectRevision
    aos/<robot>/bundle/report       stream  what became of a bundle                              BundleReport
    aos/<robot>/activate/<skill>    query   run a grounded action                         Activate -> Outcome
    aos/<robot>/middleware/ready    stream and query: which mappings run         MappingQuery -> MappingState
    aos/<robot>/serve/<adapter>/<version>/<instance>/<path>   token   an adapter answers calls of the path
    aos/<robot>/lack/<adapter>/<reason>/<path>   token   why an adapter that is there does not serve the path
    aos/<robot>/returning/<program>   token   an adapter that has left is started again, or may be
    aos/<robot>/call/<path>         query   the adapter runs a skill's code          SkillCall -> SkillResult
    aos/<robot>/cancel/<path>       query   stop what runs on the path                    Cancel -> Cancelled
    aos/<robot>/progress/<path>     stream  how far a call is                                   SkillProgress
    aos/<robot>/topic/<path>        stream  raw data of the robot                                TopicMessage
    aos/<robot>/model/check         query   can the solver use these documents       CheckModel -> ModelCheck
    aos/<robot>/mission/start       query   start the mission                    StartMission -> MissionState
    aos/<robot>/mission/stop        query   end the mission                        StopMission -> MissionState
    aos/<robot>/mission/list        query   which missions there were               MissionsQuery -> Missions
    aos/<robot>/mission/resume      query   go on with a mission that holds     ResumeMission -> MissionState
    aos/<robot>/mission/steer       query   hold, step, act, leave out, and back         Steer -> MissionState
    aos/<robot>/mission/state       stream and query: where the mission is       MissionQuery -> MissionState
    aos/<robot>/decision/record     stream  decisions and their outcomes                       DecisionRecord
    aos/<robot>/decision/history    query   the records from a sequence number        HistoryQuery -> History
    aos/<robot>/study/why           query   why a decision was made                         WhyQuery -> Why
    aos/<robot>/study/whatif        query   a decision under other circumstances     WhatIfQuery -> WhatIf
    aos/<robot>/study/tree          query   how a decision looks ahead           TreeQuery -> DecisionTree

Names are checked where they enter, so that no wildcard can: robot, service and skill names are identifiers,
paths are what a ROS name may be.
"""

from __future__ import annotations

import re
from typing import NamedTuple
from urllib.parse import quote, unquote

from aos_protocol.errors import BusError

NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")
"""The names that the bus knows robots, services, adapters and skills by."""
PATH = re.compile(r"/?[A-Za-z0-9_-]+(/[A-Za-z0-9_-]+)*")
"""The paths of activations."""
_VERSION = re.compile(r"[A-Za-z0-9._+-]{1,64}")
_INSTANCE = re.compile(r"(.+)-([0-9]+)-[0-9a-f]{1,8}")


class Serving(NamedTuple):
    """The contents of an adapter's token; `instance` tells two processes of one adapter apart."""

    adapter: str
    version: str
    instance: str
    path: str

    @property
    def who(self) -> str:
        """The adapter and its process, for people."""
        told = _INSTANCE.fullmatch(self.instance)
        process = f"process {told[2]} on {told[1]}" if told else f"instance {self.instance}"
        return f"{self.adapter} {self.version} ({process})"


class Lack(NamedTuple):
    """The contents of a token that says why an adapter, which is there, does not serve a path.

    The reason begins with its code, as in `AOS509: it is no Trigger`, where it has one.
    """

    adapter: str
    reason: str
    path: str

    @property
    def is_for_good(self) -> bool:
        """Says that to wait mends nothing: the robot defines the interface otherwise."""
        return self.reason.partition(":")[0] == "AOS509"


def instance_name(host: str, pid: int, session: str) -> str:
    """The instance of a process, by which people find it: host, process id, and its own session."""
    return f"{re.sub('[^A-Za-z0-9_-]', '-', host)[:40]}-{pid}-{session[:8]}"


class FixedKey:
    """A key expression that only the robot's name is missing from."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, keys: Keys, _: type[Keys]) -> str:
        return f"{keys.root}/{self._name}"


class Keys:
    """The key expressions of one robot."""

    all_live = FixedKey("live/*")
    push_bundle = FixedKey("bundle/push")
    remove_bundle = FixedKey("bundle/remove")
    bundle_history = FixedKey("bundle/history")
    project = FixedKey("bundle/project")
    catalogue = FixedKey("bundle/list")
    announced = FixedKey("bundle/announced")
    bundle_report = FixedKey("bundle/report")
    activate_any = FixedKey("activate/*")
    mapping_state = FixedKey("middleware/ready")
    all_progress = FixedKey("progress/**")
    all_serve = FixedKey("serve/**")
    all_lacks = FixedKey("lack/**")
    all_returning = FixedKey("returning/*")
    check_model = FixedKey("model/check")
    start_mission = FixedKey("mission/start")
    stop_mission = FixedKey("mission/stop")
    missions = FixedKey("mission/list")
    resume_mission = FixedKey("mission/resume")
    steer_mission = FixedKey("mission/steer")
    mission_state = FixedKey("mission/state")
    decisions = FixedKey("decision/record")
    decision_history = FixedKey("decision/history")
    study_why = FixedKey("study/why")
    study_whatif = FixedKey("study/whatif")
    study_tree = FixedKey("study/tree")

    def __init__(self, robot: str) -> None:
        self.robot = _checked(NAME, robot, "robot name")
        self.root = f"aos/{self.robot}"

    def live(self, service: str) -> str:
        return f"{self.root}/live/{_checked(NAME, service, 'service name')}"

    def activate(self, skill: str) -> str:
        return f"{self.root}/activate/{_checked(NAME, skill, 'skill name')}"

    def call(self, path: str) -> str:
        return f"{self.root}/call/{_path(path)}"

    def cancel(self, path: str) -> str:
        return f"{self.root}/cancel/{_path(path)}"

    def progress(self, path: str) -> str:
        return f"{self.root}/progress/{_path(path)}"

    def serve(self, serving: Serving) -> str:
        adapter = _checked(NAME, serving.adapter, "adapter name")
        version = _checked(_VERSION, serving.version, "version")
        instance = _checked(NAME, serving.instance, "instance name")
        return f"{self.root}/serve/{adapter}/{version}/{instance}/{_path(serving.path)}"

    def serving_of(self, serve_key: str) -> Serving | None:
        """Returns the contents of a token; None for one that says nothing."""
        parts = self._parts(serve_key, "serve", 4)
        return Serving(parts[0], parts[1], parts[2], "/" + parts[3]) if parts else None

    def lack(self, lack: Lack) -> str:
        adapter = _checked(NAME, lack.adapter, "adapter name")
        reason = quote(lack.reason[:999], safe="") or "-"  # Zenoh panics at keys of 64 kB.
        return f"{self.root}/lack/{adapter}/{reason}/{_path(lack.path)}"

    def lack_of(self, lack_key: str) -> Lack | None:
        """Returns the contents of a token; None for one that says nothing."""
        parts = self._parts(lack_key, "lack", 3)
        return Lack(parts[0], unquote(parts[1]), "/" + parts[2]) if parts else None

    def returning(self, program: str) -> str:
        return f"{self.root}/returning/{_checked(NAME, program, 'adapter name')}"

    def returning_of(self, key: str) -> str | None:
        """Returns the adapter that a token says to be expected back; None for a key of another kind."""
        head, _, program = key.rpartition("/")
        return program if head == f"{self.root}/returning" else None

    def topic(self, path: str) -> str:
        return f"{self.root}/topic/{_path(path)}"

    def service_of(self, live_key: str) -> str:
        """The service name in a liveliness key."""
        return live_key.removeprefix(f"{self.root}/live/")

    def _parts(self, key: str, kind: str, count: int) -> list[str]:
        """The parts of a token of this kind, its path as the last one; none for another key."""
        parts = key.removeprefix(f"{self.root}/{kind}/").split("/", count - 1)
        return parts if key.startswith(f"{self.root}/{kind}/") and len(parts) == count else []


def _path(path: str) -> str:
    return _checked(PATH, path, "path").strip("/")


def _checked(pattern: re.Pattern[str], text: str, what: str) -> str:
    if not pattern.fullmatch(text):
        raise BusError(f"{text!r} is not a {what}", code="AOS602", hint=f"A {what} matches {pattern.pattern}")
    return text
