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
    aos/<robot>/call/<path>         query   the adapter runs a skill's code          SkillCall -> SkillResult
    aos/<robot>/skill/cancel        query   stop whatever moves                           Cancel -> Cancelled
    aos/<robot>/topic/<path>        stream  raw data of the robot                                TopicMessage
    aos/<robot>/model/check         query   can the solver use these documents       CheckModel -> ModelCheck
    aos/<robot>/mission/start       query   start the mission                    StartMission -> MissionState
    aos/<robot>/mission/state       stream and query: where the mission is       MissionQuery -> MissionState
    aos/<robot>/decision/record     stream  decisions and their outcomes                       DecisionRecord
    aos/<robot>/decision/history    query   the records from a sequence number        HistoryQuery -> History

Names are checked where they enter, so that no wildcard can: robot, service and skill names are identifiers,
paths are what a ROS name may be.
"""

from __future__ import annotations

import re

from aos_protocol.errors import BusError

__all__ = ["Keys"]

_NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")
_PATH = re.compile(r"/?[A-Za-z0-9_-]+(/[A-Za-z0-9_-]+)*")


class Keys:
    """The key expressions of one robot."""

    def __init__(self, robot: str) -> None:
        self.robot = _checked(_NAME, robot, "robot name")
        self._root = f"aos/{self.robot}"

    def live(self, service: str) -> str:
        return f"{self._root}/live/{_checked(_NAME, service, 'service name')}"

    @property
    def all_live(self) -> str:
        return f"{self._root}/live/*"

    @property
    def push_bundle(self) -> str:
        return f"{self._root}/bundle/push"

    @property
    def remove_bundle(self) -> str:
        return f"{self._root}/bundle/remove"

    @property
    def bundle_history(self) -> str:
        return f"{self._root}/bundle/history"

    @property
    def project(self) -> str:
        return f"{self._root}/bundle/project"

    @property
    def catalogue(self) -> str:
        return f"{self._root}/bundle/list"

    @property
    def announced(self) -> str:
        return f"{self._root}/bundle/announced"

    @property
    def bundle_report(self) -> str:
        return f"{self._root}/bundle/report"

    def activate(self, skill: str) -> str:
        return f"{self._root}/activate/{_checked(_NAME, skill, 'skill name')}"

    @property
    def activate_any(self) -> str:
        return f"{self._root}/activate/*"

    @property
    def mapping_state(self) -> str:
        return f"{self._root}/middleware/ready"

    def call(self, path: str) -> str:
        return f"{self._root}/call/{_path(path)}"

    @property
    def cancel(self) -> str:
        return f"{self._root}/skill/cancel"

    def topic(self, path: str) -> str:
        return f"{self._root}/topic/{_path(path)}"

    @property
    def check_model(self) -> str:
        return f"{self._root}/model/check"

    @property
    def start_mission(self) -> str:
        return f"{self._root}/mission/start"

    @property
    def mission_state(self) -> str:
        return f"{self._root}/mission/state"

    @property
    def decisions(self) -> str:
        return f"{self._root}/decision/record"

    @property
    def decision_history(self) -> str:
        return f"{self._root}/decision/history"

    def service_of(self, live_key: str) -> str:
        """The service name in a liveliness key."""
        return live_key.removeprefix(f"{self._root}/live/")


def _path(path: str) -> str:
    return _checked(_PATH, path, "path").strip("/")


def _checked(pattern: re.Pattern[str], text: str, what: str) -> str:
    if not pattern.fullmatch(text):
        raise BusError(
            f"{text!r} is not a {what}",
            code="AOS602",
            hint=f"A {what} matches {pattern.pattern}",
        )
    return text
