"""One run of a system that stays: services up, documents in, then mission after mission, until stopped."""

from contextlib import suppress
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_deploy.events import Event, Told
from aos_deploy.exit_codes import ExitCode, exit_code_of_error
from aos_deploy.missions.mission_run import MissionRun
from aos_deploy.printing import count, time_text
from aos_deploy.processes.supervisor import Supervisor
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.end import Account, Verdict, settled
from aos_deploy.runs.record import Summary, SystemSummary
from aos_protocol.errors import AosError, MissionRunsError, SteeringError, StorageError
from aos_protocol.messages import DecisionRecord, MissionEntry, MissionState, StartMission
from aos_protocol.mission_rows import DECISION
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import JOURNAL, make_folder_of_missions, mission_folder
from aos_runtime.parties.steering import start_mission
from aos_solver.mission.records.logbook import entries_of, entry_of


class SystemRun(MissionRun):
    """Runs a deployment until it is cancelled, or goes on with a run that is `taken_up`.

    The first mission is started at once. Each has a summary of its own when it has ended.
    """

    stays = True
    _mission = ""
    _mission_begun_s: float | None = None
    _decided_s: float | None = None

    def _run_directory(self) -> RunDirectory:
        run = super()._run_directory()
        make_folder_of_missions(run.path)
        return run

    async def _ask_to_start(self, supervisor: Supervisor) -> None:
        if self._taken_up is None or not self._taken_up.has_begun:
            start = StartMission(request=self._run.path.name)
            try:
                # Somebody else may have been quicker, as soon as the services could be asked.
                with suppress(MissionRunsError):
                    await start_mission(supervisor.bus, supervisor.keys, start)
            except SteeringError as error:
                self._report(
                    Told(f"{error.message}; `aos mission start` begins one, Ctrl-C stops the system")
                )

    def _take(self, event: Event) -> None:
        if isinstance(event, MissionState) and event.mission != self._mission:
            self._mission, self._heard = event.mission, Account()
            self._mission_begun_s = self._decided_s = None
        now_s = self._clock.monotonic_s()
        if isinstance(event, MissionState) and event.epoch == 1 and event.step == 0:
            self._mission_begun_s = self._mission_begun_s or now_s
        if isinstance(event, DecisionRecord) and event.step == 1:
            self._decided_s = self._decided_s or now_s
        super()._take(event)

    def _has_journaled(self, state: MissionState) -> bool:
        try:
            entry = entry_of(self._run.path, state.mission)
        except StorageError:
            return True
        return entry is not None and entry.ended_ns > 0

    def _take_end(self, state: MissionState) -> None:
        """Keeps the summary of a mission that has ended, once."""
        entry = entry_of(self._run.path, state.mission)
        if entry is None or self._run.read_summary(entry.number) is not None:
            return
        summary = self._keep(entry, was_interrupted=False)
        took = f"{count(summary.steps, 'step')} in {summary.duration_s:.1f} s"
        what = f"{entry.mission}: {summary.ending} after {took}"
        # What to do comes first: the live view has one line for this.
        self._report(Told(f"`aos mission start` begins the next, Ctrl-C stops the system; {what}"))

    def _keep(self, entry: MissionEntry, *, was_interrupted: bool) -> Summary:
        """Writes the summary of a mission; what ended it from outside goes into its journal."""
        folder = mission_folder(self._run.path, entry.number)
        stopped_by = self.error if not entry.ended_ns or entry.ending == "fault" else None
        verdict, lacking = settled(
            folder, self._heard, stopped_by=stopped_by, was_interrupted=was_interrupted, mission=entry.mission
        )
        self.error = self.error or lacking
        summary = replace(
            self._summary(verdict, folder),
            seed=entry.seed,
            started=time_text(entry.begun_ns),
            services_ready_s=None,
            **(self._measured(entry) or _durations(folder / JOURNAL, entry.begun_ns)),
            process_ends=(),
        )
        try:
            self._run.write_summary(summary, entry.number)
        except StorageError as error:
            self.error = self.error or error
        return summary

    def _measured(self, entry: MissionEntry) -> dict[str, float | None] | None:
        """The seconds to the first decision and to now of the mission that has just ended; None for others.

        The journal has the wall clock alone, which may have been set meanwhile.
        """
        if entry.mission != self._mission or self._mission_begun_s is None:
            return None
        first_s = None if self._decided_s is None else round(self._decided_s - self._mission_begun_s, 3)
        duration_s = round(self._clock.monotonic_s() - self._mission_begun_s, 3)
        return {"first_decision_s": first_s, "duration_s": duration_s}

    def _settled(self, run: RunDirectory, *, was_interrupted: bool) -> Summary:
        """The summary of the system, once each mission has its own."""
        entries: tuple[MissionEntry, ...] = ()
        try:
            entries = entries_of(run.path)
        except StorageError as error:
            self.error = self.error or error
        ran = bool(entries) and not entries[-1].ended_ns
        fault = self.error
        for entry in entries:
            if run.read_summary(entry.number) is None:
                self._keep(entry, was_interrupted=was_interrupted)
        verdict = self._verdict(fault, has_begun=bool(entries), ran=ran)
        fields = msgspec.structs.asdict(self._summary(verdict, run.path))
        summaries = [run.read_summary(entry.number) for entry in entries]
        fields["steps"] = sum(summary.steps for summary in summaries if summary is not None)
        return SystemSummary(**fields, missions=tuple(entry.mission for entry in entries))

    @staticmethod
    def _verdict(fault: AosError | None, *, has_begun: bool, ran: bool) -> Verdict:
        ending, remark, code = "stopped", "interrupted between missions", ExitCode.GOAL_REACHED
        if ran:
            ending, remark, code = "cancelled", "interrupted while a mission ran", ExitCode.INTERRUPTED
        if fault is not None:
            ending = "fault" if has_begun else "not_started"
            remark, code = str(fault), ExitCode.FAULT if has_begun else exit_code_of_error(fault)
        return Verdict(ending=ending, remark=remark, exit_code=int(code))


def _durations(journal: Path, begun_ns: int) -> dict[str, float | None]:
    """Returns the seconds to the first decision, and to the last row of a mission's journal."""
    with Journal.read(journal) as rows:
        first = next(rows.walk(DECISION), None)
        last = next(rows.walk(since=rows.last), None)
    first_s = None if first is None else round(max(first.stamp_ns - begun_ns, 0) / 1e9, 3)
    duration_s = 0.0 if last is None else round(max(last.stamp_ns - begun_ns, 0) / 1e9, 3)
    return {"first_decision_s": first_s, "duration_s": duration_s}
