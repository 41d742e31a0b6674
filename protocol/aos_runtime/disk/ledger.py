"""Requests that were started and how they ended, so that one that is repeated moves nothing twice."""

from pathlib import Path
from typing import Any, Generic, TypeVar

from aos_protocol.messages import Activate, ActivationId, Fault, Message, Outcome, SkillCall, SkillResult
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import is_before


class Failure(Message, frozen=True):
    """A call that ended with an error."""

    id: ActivationId
    fault: Fault


Request = TypeVar("Request", Activate, SkillCall)
End = TypeVar("End", bound=Outcome | SkillResult | Failure)


class Ledger(Generic[Request, End]):
    """Requests and their ends by id, on the disk before they are told."""

    def __init__(self, path: Path, request: type[Request], ends: dict[str, type[Any]]) -> None:
        """`ends` has a type by the kind of its rows; StorageError if the file cannot be read."""
        # After a loss of power no mission goes on, and its ids are never used again.
        self._journal = Journal.open(path, survives_power_loss=False)
        self._started: dict[ActivationId, Request] = {}
        self._ended: dict[ActivationId, End] = {}
        self._mission = ""
        for row in self._journal.rows():
            if row.kind == "started":
                self._take(row.read_as(request))
            elif row.kind in ends:
                end = row.read_as(ends[row.kind])
                self._ended[end.id] = end

    def close(self) -> None:
        self._journal.close()

    def requests(self) -> tuple[Request, ...]:
        """Every request that was started, in order."""
        return tuple(self._started.values())

    def was_started(self, id: ActivationId) -> bool:
        """Says whether it was begun, by this process or by an earlier one."""
        return id in self._started

    def start(self, request: Request) -> None:
        """Notes a request; it is called before anything moves."""
        self._journal.append("started", request)
        self._take(request)

    def end(self, end: End, kind: str = "ended") -> None:
        """Notes how a request ended; it is called after the robot moved."""
        self._journal.append(kind, end)
        self._ended[end.id] = end

    def outlives(self, end: End) -> bool:
        """Says whether an end counts after its mission, too."""
        return False

    def _take(self, request: Request) -> None:
        """Those of missions before it in the same system are on the disk, and nobody asks for them."""
        mission = request.id.mission
        if mission != self._mission:
            self._mission = mission
            ended, started = self._ended.items(), self._started.items()
            self._ended = {
                id: end for id, end in ended if self.outlives(end) or not is_before(id.mission, mission)
            }
            self._started = {
                id: of for id, of in started if id in self._ended or not is_before(id.mission, mission)
            }
        self._started[request.id] = request
