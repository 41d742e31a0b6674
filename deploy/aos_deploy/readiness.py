"""The wait before the first decision: every path that a skill calls has somebody who answers it."""

from collections.abc import Collection

from aos_deploy.deploy_file import Deployment
from aos_deploy.supervisor import Supervisor
from aos_protocol.errors import BusError, DeployError
from aos_protocol.messages import MappingQuery, MappingState, ProjectQuery, ProjectRevision
from aos_protocol.spelling import nearest
from aos_runtime.reported_state import state_when

_ASK_S = 5.0
_NOBODY_S = 1.0
MAPPINGS_S = 60.0


async def until_skills_can_run(supervisor: Supervisor, deployment: Deployment) -> tuple[str, ...]:
    """Returns when all skills of the newest revision can be run, with `misspelt_paths` of these.

    DeployError AOS807 names the paths that nobody serves, or two adapters serve, after the time that adapters
    may take to start.
    """
    bus, keys = supervisor.bus, supervisor.keys
    project = await bus.ask(keys.project, ProjectQuery(deployment.project), ProjectRevision, timeout_s=_ASK_S)
    newest: MappingState | None = None

    def has_revision(state: MappingState) -> bool:
        nonlocal newest
        newest = state
        return max(state.refused, state.revision) >= project.revision

    def is_complete(state: MappingState) -> bool:
        return has_revision(state) and (state.refused >= project.revision or not state.unavailable)

    # How long mappings take to be generated says nothing of adapters.
    await state_when(
        bus, keys.mapping_state, MappingQuery(), MappingState, has_revision, timeout_s=MAPPINGS_S
    )
    longest_s = max((plan.kind.ready_s for plan in deployment.adapters), default=_NOBODY_S)
    try:
        await state_when(
            bus, keys.mapping_state, MappingQuery(), MappingState, is_complete, timeout_s=longest_s
        )
    except BusError as error:
        if newest is None or not newest.unavailable:
            raise
        missing = "; ".join(f"{skill}: {why}" for skill, why in sorted(newest.unavailable.items()))
        raise DeployError(
            f"not every skill can be run within {longest_s:g} s: {missing}",
            code="AOS807",
            hint=_hint(supervisor, deployment),
        ) from error
    return misspelt_paths(deployment, {skill.mapping.activation.path for skill in project.project.skills})


def misspelt_paths(deployment: Deployment, called: Collection[str]) -> tuple[str, ...]:
    """A remark for each path of `bind:` that no skill calls, and that is nearly one that a skill calls and
    `"*"` binds: another adapter moves there. A path that is like none may be that of a skill to come.
    """
    bound = {path for plan in deployment.adapters for path in plan.bind}
    remarks = []
    for path in sorted(bound.difference(called)):
        if close := nearest(path, set(called) - bound):
            others = next((plan.name for plan in deployment.adapters if plan.serves_others), "another")
            remarks.append(
                f"`bind:` names {path}, which no skill calls. Did you mean {close}? {others} serves that"
            )
    return tuple(remarks)


def _hint(supervisor: Supervisor, deployment: Deployment) -> str:
    bound = [f"{path} to {plan.name}" for plan in deployment.adapters for path in plan.bind]
    bound += [f"all others to {plan.name}" for plan in deployment.adapters if plan.serves_others]
    lines = [
        f"The deploy file binds {', '.join(bound)}"
        if bound
        else "The deploy file binds nothing: see `bind:`",
        *(f"{plan.name} is external: start it" for plan in deployment.adapters if not plan.is_process),
        *(supervisor.look_at_log(plan.name) for plan in deployment.adapters if plan.is_process),
        "Or play without a robot: aos-up --model",
    ]
    return "\n    ".join(lines)
