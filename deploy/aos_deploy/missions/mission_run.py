"""One run of a system: services up, documents in, the mission to its end, everything down."""

import asyncio
from collections.abc import Callable
from contextlib import aclosing
from functools import partial
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_deploy.bundles.files import BundledFiles, files_of_bundles, project_of
from aos_deploy.deployment.reading import Deployment, with_whole_paths
from aos_deploy.events import Event, Report, ServiceChanged, Told
from aos_deploy.missions.readiness import tell_lost_skills, unbound_adapters, until_skills_can_run
from aos_deploy.missions.run_of_processes import RunOfProcesses
from aos_deploy.missions.taking_up import TakenUp, worlds_text
from aos_deploy.page_address import page_texts
from aos_deploy.printing import count, from_here, time_text
from aos_deploy.processes.endpoint import hold_endpoint
from aos_deploy.processes.program import outsiders_of, programs_of_deployment
from aos_deploy.processes.supervisor import Supervisor, supervised
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.end import Account, Verdict, account_of, beginning_of, settled
from aos_deploy.runs.living import noted
from aos_deploy.runs.record import Summary, record_of
from aos_deploy.spans.rest import send_rest
from aos_protocol import messages
from aos_protocol.errors import AosError, DeployError, DocumentError, StorageError
from aos_runtime.client import AosClient
from aos_runtime.clock import Clock
from aos_runtime.disk.mission_folders import JOURNAL
from aos_runtime.parties.asking import ask_until_answered
from aos_runtime.parties.steering import start_mission
from aos_runtime.processes.lifecycle import root_cause
from aos_runtime.processes.settings import ServiceSettings

_END_NOTICE_S = 5.0
CAUSE_NOTICE_S = 0.5
_BUILD_TIMEOUT_S = 600.0
"""The first build with a compiler that has to build its own library takes a minute on a quick machine."""


class MissionRun(RunOfProcesses):
    """Runs a deployment once, or goes on with a run that is `taken_up`. `report` is told what happens.

    Where it `shows_page`, also the address of the run's page, once the run can be found.
    """

    stays = False
    """True where the system goes on after a mission."""
    _run: RunDirectory

    def __init__(
        self,
        deployment: Deployment,
        report: Report,
        clock: Clock,
        *,
        taken_up: TakenUp | None = None,
        is_played: bool = False,
        shows_page: bool = False,
    ) -> None:
        file = replace(deployment.file, stay=self.stays)
        super().__init__(replace(deployment, file=file), report, clock)
        self._taken_up = taken_up
        self._shows_page = shows_page
        self._is_played = is_played or (taken_up is not None and taken_up.record.is_played)
        self._started = time_text(clock.now_ns()) if taken_up is None else taken_up.record.started
        self._heard = Account()
        self._own_pushes: set[str] = set()
        self._write_again: Callable[[], None] = _nothing
        self._services_ready_s: float | None = None
        self._first_decision_s: float | None = None

    async def run(self) -> Summary:
        """Runs until the mission has ended and every process with it, by itself, by a fault or cancelled.

        A fault is kept in `error`, and so is a lack of space for the journal's end or the summary: the exit
        code is the same without them. AosError if there is no run directory, because its endpoint is taken or
        it cannot be made.
        """
        with hold_endpoint(self._deployment.file.bus.listen) as endpoint:
            return await self._run_at(endpoint)

    async def _run_at(self, endpoint: str) -> Summary:
        run = self._run = self._run_directory()
        endpoint = endpoint or run.make_endpoint()
        self._tell_opened(run)
        if self._taken_up is not None and (lost := worlds_text(self._deployment)):
            self._report(Told(lost))
        for remark in unbound_adapters(self._deployment):
            self._report(Told(remark))
        was_interrupted = False
        try:
            if self._taken_up is None:
                run.keep_inputs(with_whole_paths(self._deployment), self._deployment.policy)
            with noted(run):
                await self._run_in(run, endpoint)
        except asyncio.CancelledError:
            was_interrupted = True
        except AosError as error:
            self.error = error
        summary = self._settled(run, was_interrupted=was_interrupted)
        self._write_summary(run, summary)
        await send_rest(run, is_wanted=bool(self._deployment.file.spans.otlp))
        run.close()
        took = f"{count(summary.steps, 'step')} in {summary.duration_s:.1f} s"
        lacks = self.error is not None and self.error.code == StorageError.code
        kept = "what could be written is" if lacks else "everything is kept"
        self._report(Told(f"{summary.ending} after {took}; {kept} in {from_here(run.path)}"))
        return summary

    def _settled(self, run: RunDirectory, *, was_interrupted: bool) -> Summary:
        """The summary of a run whose processes are gone."""
        verdict, lacking = settled(
            run.path, self._heard, stopped_by=self.error, was_interrupted=was_interrupted
        )
        self.error = self.error or lacking
        return self._summary(verdict, run.path)

    def _run_directory(self) -> RunDirectory:
        if self._taken_up is not None:
            return self._taken_up.run
        return super()._run_directory()

    async def _run_in(self, run: RunDirectory, endpoint: str) -> None:
        deployment = self._deployment
        base = ServiceSettings(
            robot=deployment.file.robot, service="", endpoint=endpoint, run_dir=str(run.path)
        )
        programs = programs_of_deployment(deployment)
        for program in programs:
            run.forget_fault(program.name)
        if self._taken_up is None or not self._taken_up.has_begun:  # Else the catalogue has later ones.
            await asyncio.to_thread(project_of, deployment)
        try:
            outsiders = outsiders_of(deployment)
            async with supervised(
                programs, base, run, self._hear, self._clock, outsiders=outsiders
            ) as supervisor:
                self._supervisor = supervisor
                await supervisor.start()
                self._write_record(run, endpoint, supervisor)
                if self._shows_page:
                    for text in await asyncio.to_thread(page_texts, run.path):
                        self._report(Told(text))
                self._write_again = partial(self._write_record, run, endpoint, supervisor)
                async with asyncio.TaskGroup() as tasks:
                    starting = tasks.create_task(self._start_mission(supervisor))
                    await self._follow(supervisor)
                    starting.cancel()  # Somebody may have stopped the mission before it began.
                if not self._heard.has_ended:
                    # The solver's process ends in a moment, and the supervision with the reason.
                    await supervisor.until_one_ended(timeout_s=_END_NOTICE_S)
                elif self._heard.state is not None and self._heard.state.ending == "fault":
                    # A service that is killed leaves the bus before its process counts as ended.
                    await supervisor.until_one_ended(timeout_s=CAUSE_NOTICE_S)
        except BaseExceptionGroup as group:
            raise root_cause(group) from group
        if not self._heard.has_ended:
            raise DeployError("the solver left before the mission ended", code="AOS804")

    def _hear(self, event: Event) -> None:
        """Passes on what the supervisor tells; a process that is started again has another id."""
        self._report(event)
        if isinstance(event, ServiceChanged) and event.state == "starting":
            self._write_again()

    async def _start_mission(self, supervisor: Supervisor) -> None:
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self._push_bundles(supervisor))
            await supervisor.until_ready()
            self._write_again()  # Now all processes have an id.
            self._services_ready_s = self._elapsed_s()
        for remark in await until_skills_can_run(supervisor, self._deployment, self._report):
            self._report(Told(remark))
        await self._ask_to_start(supervisor)

    async def _ask_to_start(self, supervisor: Supervisor) -> None:
        await start_mission(supervisor.bus, supervisor.keys, messages.StartMission())

    async def _push_bundles(self, supervisor: Supervisor) -> None:
        if self._taken_up is not None and self._taken_up.has_begun:
            return  # The catalogue has them, and what came after them.
        await supervisor.until_ready("registry")
        bundles = self._deployment.bundles
        together = await asyncio.to_thread(files_of_bundles, bundles, self._deployment.file.leave_out)
        await self._push(supervisor, together, ", ".join(str(from_here(bundle)) for bundle in bundles))

    async def _push(self, supervisor: Supervisor, together: BundledFiles, named: str) -> None:
        """Brings documents into the registry; DocumentError with all diagnostics if they are refused."""
        self._own_pushes.add(named)
        report = await ask_until_answered(
            supervisor.bus,
            supervisor.keys.push_bundle,
            messages.PushBundle(together.files, named),
            messages.BundleReport,
            server=supervisor.keys.live("registry"),
            timeout_s=_BUILD_TIMEOUT_S,
        )
        found = tuple(together.located(diagnostic) for diagnostic in report.diagnostics)
        if not report.is_accepted:
            refused = f"bundles {named} are" if "," in named else f"bundle {named} is"
            raise DocumentError(f"the {refused} refused", code="AOS120", diagnostics=found)
        self._report(replace(report, diagnostics=found))

    async def _follow(self, supervisor: Supervisor) -> None:
        async with asyncio.TaskGroup() as tasks:
            beside = (self._follow_progress(supervisor), tell_lost_skills(supervisor, self._report))
            following = [tasks.create_task(each) for each in beside]
            await self._follow_mission(supervisor)
            for each in following:
                each.cancel()

    async def _follow_progress(self, supervisor: Supervisor) -> None:
        async with supervisor.bus.listen(supervisor.keys.all_progress, messages.SkillProgress) as reports:
            async for _, progress in reports:
                self._report(progress)

    async def _follow_mission(self, supervisor: Supervisor) -> None:
        client = AosClient(supervisor.bus, self._deployment.file.robot)
        # It goes on after any word of an end: whether that is one, the journal says.
        async with aclosing(client.follow(away_s=None, stays=True)) as events:
            async for event in events:
                if isinstance(event, messages.BundleReport) and event.source in self._own_pushes:
                    # Told already, with the way to the files; another push of the same is news.
                    self._own_pushes.remove(event.source)
                    continue
                end = event if isinstance(event, messages.MissionState) and event.phase == "ended" else None
                if end is not None and not await asyncio.to_thread(self._has_journaled, end):
                    what = f"{end.mission} has ended, {end.ending}"
                    self._report(Told(f"not believed: {what}; its journal says that it goes on"))
                    continue
                self._take(event)
                self._report(event)
                if end is not None:
                    self._take_end(end)
                    if not self.stays:
                        return

    def _has_journaled(self, state: messages.MissionState) -> bool:
        """Says whether the journal has the end that somebody tells. One that is gone, or cannot be read, says
        nothing."""
        if not (self._run.path / JOURNAL).exists():
            return True
        try:
            account = account_of(self._run.path)
        except StorageError:
            return True
        return account.has_ended

    def _take_end(self, state: messages.MissionState) -> None:
        """Does nothing: the run ends with its mission, and is settled when all processes are gone."""

    def _take(self, event: Event) -> None:
        if isinstance(event, messages.DecisionRecord | messages.MissionState):
            self._heard.take(event)
        if isinstance(event, messages.DecisionRecord) and self._first_decision_s is None:
            self._first_decision_s = self._elapsed_s()

    def _write_record(self, run: RunDirectory, endpoint: str, supervisor: Supervisor) -> None:
        pids = supervisor.pids
        run.write_record(
            record_of(self._deployment, endpoint, self._started, pids, is_played=self._is_played)
        )

    def _summary(self, verdict: Verdict, folder: Path) -> Summary:
        begun = beginning_of(folder)
        return self._summary_of(
            started=self._started,
            **msgspec.structs.asdict(verdict),
            steps=verdict.steps,
            services_ready_s=self._services_ready_s,
            first_decision_s=self._first_decision_s,
            mission_parameters=begun.mission_parameters if begun is not None else {},
        )


def _nothing() -> None:
    """There is no record yet."""
