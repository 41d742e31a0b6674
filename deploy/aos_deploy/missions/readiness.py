"""The skills that can be run: the wait for all before the first decision, and those that leave after it."""

import asyncio
from collections.abc import Collection

from aos_deploy.deployment.adapter_kinds import MODEL
from aos_deploy.deployment.reading import Deployment
from aos_deploy.events import Report, Told
from aos_deploy.processes.supervisor import Supervisor
from aos_protocol.errors import BusError, DeployError
from aos_protocol.messages import MappingQuery, MappingState, ProjectQuery, ProjectRevision
from aos_protocol.spelling import nearest
from aos_protocol.unavailable import by_reason
from aos_runtime.bus.subscription import merged
from aos_runtime.parties.reported_state import state_when
from aos_runtime.parties.served import lacks, served

_ASK_S = 5.0
_NOBODY_S = 1.0
MAPPINGS_S = 60.0
_SETTLED_S = 2.0
"""An absence this short is not told."""


async def until_skills_can_run(
    supervisor: Supervisor, deployment: Deployment, report: Report
) -> tuple[str, ...]:
    """Returns when all skills of the newest revision can be run, with `misspelt_paths` of these.

    A path that two serve, and what adapters lack for another, is reported soon. DeployError AOS807 names the
    paths that nobody serves, or two adapters serve, after the time that adapters may take to start; at once
    where the robot defines one otherwise.
    """
    bus, keys = supervisor.bus, supervisor.keys
    project = await bus.ask(keys.project, ProjectQuery(deployment.project), ProjectRevision, timeout_s=_ASK_S)
    newest: MappingState | None = None

    def has_revision(state: MappingState) -> bool:
        nonlocal newest
        newest = state
        return max(state.refused, state.revision) >= project.revision

    def is_decided(state: MappingState) -> bool:
        return has_revision(state) and (not _missing(state, project) or bool(state.for_good))

    # How long mappings take to be generated says nothing of adapters.
    await state_when(
        bus, keys.mapping_state, MappingQuery(), MappingState, has_revision, timeout_s=MAPPINGS_S
    )
    longest_s = max((plan.kind.ready_s for plan in deployment.adapters), default=_NOBODY_S)

    async def decided_within(timeout_s: float) -> None:
        await state_when(
            bus, keys.mapping_state, MappingQuery(), MappingState, is_decided, timeout_s=timeout_s
        )

    def not_all(state: MappingState, why: str) -> DeployError:
        message = f"not every skill can be run{why}: {_reasons(state, state.unavailable)}"
        skills = project.project.skills
        away = {skill.mapping.activation.path for skill in skills if skill.name in state.unavailable}
        return DeployError(message, code="AOS807", hint=_hint(supervisor, deployment, away))

    settled_s = min(longest_s, _SETTLED_S)
    try:
        try:
            await decided_within(settled_s)
        except BusError:
            remarks = [*await _served_by_several(supervisor), *await _lacking(supervisor)]
            if newest is not None and not remarks and settled_s < longest_s:
                remarks = [f"waiting, {longest_s:g} s at most: {_reasons(newest, newest.unavailable)}"]
            for text in remarks:
                report(Told(text))
            if settled_s == longest_s:
                raise
            await decided_within(longest_s - settled_s)
    except BusError as error:
        if newest is None or not newest.unavailable:
            raise
        raise not_all(newest, f" within {longest_s:g} s") from error
    if newest is not None and _missing(newest, project):
        raise not_all(newest, ", and to wait mends nothing")
    return misspelt_paths(deployment, {skill.mapping.activation.path for skill in project.project.skills})


def _missing(state: MappingState, project: ProjectRevision) -> bool:
    return state.refused < project.revision and bool(state.unavailable)


async def _served_by_several(supervisor: Supervisor) -> list[str]:
    """A remark for each path that several processes serve."""
    by_path: dict[str, list[str]] = {}
    for server in await served(supervisor.bus, supervisor.keys):
        by_path.setdefault(server.path, []).append(server.who)
    return [
        f"{path} is served by {' and '.join(sorted(who))}: end all but one of them"
        for path, who in sorted(by_path.items())
        if len(who) > 1
    ]


async def _lacking(supervisor: Supervisor) -> list[str]:
    """A remark for each path of which an adapter tells why it does not serve it."""
    found = sorted(await lacks(supervisor.bus, supervisor.keys))
    return [f"{lack.path} is not served yet: {lack.adapter} says: {lack.reason}" for lack in found]


async def tell_lost_skills(supervisor: Supervisor, report: Report) -> None:
    """Reports skills that could be run and cannot any more, and those that can again, until it is cancelled.

    Nothing is told of them while a program starts again, which is told itself.
    """
    bus, keys = supervisor.bus, supervisor.keys
    runnable: set[str] = set()
    lost: set[str] = set()
    told = bus.listen(keys.mapping_state, MappingState)
    async with merged(told, bus.presence(keys.live("middleware"))) as changes:
        async for _, change in changes:
            runnable |= _runnable(change)
            while True:
                await asyncio.sleep(_SETTLED_S)
                if not supervisor.is_changing:
                    break
            while changes.has_items:  # The answer is newer, and a skill of theirs may have left since.
                runnable |= _runnable((await anext(changes))[1])
            try:
                state = await bus.ask(keys.mapping_state, MappingQuery(), MappingState, timeout_s=_ASK_S)
            except BusError:
                continue  # It is told when the middleware is back.
            if left := runnable & state.unavailable.keys():
                more = "`aos skill list` and the adapters' logs tell more"
                report(Told(f"cannot be run any more: {_reasons(state, left)} ({more})"))
            now = _runnable(state)
            if back := lost & now:
                report(Told(f"can be run again: {', '.join(sorted(back))}"))
            lost = (lost | left) - now
            runnable = (runnable | now) - left


def _runnable(state: MappingState | bool) -> set[str]:
    """The skills that the middleware tells can be run; none where it tells of its presence."""
    return set(state.skills) - state.unavailable.keys() if isinstance(state, MappingState) else set()


def _reasons(state: MappingState, skills: Collection[str]) -> str:
    told = by_reason({skill: state.unavailable[skill] for skill in sorted(skills)})
    return "; ".join(f"{', '.join(away)}: {reason}" for reason, away in told.items())


def misspelt_paths(deployment: Deployment, called: Collection[str]) -> tuple[str, ...]:
    """A remark for each path of `bind:` that no skill calls, and that is nearly one that a skill calls and
    `"*"` binds: another adapter moves there. A path that is like none may be that of a skill to come."""
    bound = {path for plan in deployment.adapters for path in plan.bind}
    remarks = []
    for path in sorted(bound.difference(called)):
        if close := nearest(path, set(called) - bound):
            others = next((plan.name for plan in deployment.adapters if plan.serves_others), "another")
            remarks.append(
                f"`bind:` names {path}, which no skill calls. Did you mean {close}? {others} serves that"
            )
    return tuple(remarks)


def unbound_adapters(deployment: Deployment) -> tuple[str, ...]:
    """A remark for each adapter of `adapters:` that nothing is bound to; none where documents play all."""
    kinds = {plan.kind_name for plan in deployment.adapters}
    if kinds == {MODEL}:
        return ()
    bound = {plan.name for plan in deployment.adapters}
    return tuple(
        f"{name} is left out: `bind:` binds no path to this adapter, as `/PATH: {name}` does"
        for name in deployment.file.adapters
        if name not in bound
    )


def _hint(supervisor: Supervisor, deployment: Deployment, away: Collection[str]) -> str:
    """The bindings, and what is to be seen of the adapters that are to serve the paths that are away."""
    bound = [f"{path} to {plan.name}" for plan in deployment.adapters for path in plan.bind]
    bound += [f"all others to {plan.name}" for plan in deployment.adapters if plan.serves_others]
    meant = [plan for plan in deployment.adapters if plan.serves_others or set(plan.bind) & set(away)]
    lines = [
        f"The deploy file binds {', '.join(bound)}"
        if bound
        else "The deploy file binds nothing: see `bind:`",
        *(f"{plan.name} is external: start it" for plan in meant if not plan.is_process),
        *(supervisor.look_at_log(plan.name) for plan in meant if plan.is_process),
        "Or play without a robot: aos-up --model",
    ]
    return "\n    ".join(lines)
