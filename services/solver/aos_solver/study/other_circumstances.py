"""The decision of a step under other circumstances: actions forbidden, other beliefs, other documents."""

from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import NamedTuple

from msgspec.structs import replace

from aos_language.load import load_files
from aos_protocol.errors import DocumentError, SkillError, StudyError
from aos_protocol.messages import ActionValue, DecisionRecord, WhatIf, WhatIfQuery
from aos_solver.child.engine import Engine, Restriction
from aos_solver.earlier_models import built_for
from aos_solver.mission.models.past import replayed
from aos_solver.study.replaying import ReplayedMission
from aos_solver.study.supposing import believe_all, changed_files, put_aside


class OtherDocuments(NamedTuple):
    """The source of a revision's files, and how much an engine of changed ones gives way."""

    files: Callable[[int], Awaitable[dict[str, bytes]]]
    niceness: int


async def decided_otherwise(
    replay: ReplayedMission, decision: DecisionRecord, query: WhatIfQuery, documents: OtherDocuments
) -> WhatIf:
    """The decision that would be made at the step at which a replay is; the replay stays there."""
    if not (query.forbid or query.without or query.believe or query.change):
        hint = "Use --forbid, --without, --believe or --change; `aos why` explains the decision as it was"
        raise StudyError("nothing is supposed", hint=hint)
    async with _engine(replay, query.change, documents) as (engine, said), put_aside(engine):
        return await _decided(replay, decision, query, engine, said)


async def _decided(
    replay: ReplayedMission,
    decision: DecisionRecord,
    query: WhatIfQuery,
    engine: Engine,
    said: tuple[str, ...],
) -> WhatIf:
    made = decision.deciding_search
    was_worth = await _values_before(replay, decision)
    was = replay.restriction_of(made) if made is not None else Restriction()
    within = _restricted(engine, query, was)
    said += await believe_all(engine, query.believe, cautious=within.cautious)
    search = replay.search_by(decision)
    if query.change:
        search = search.after_takeover()
    belief = await engine.summary()
    plan = await search.run(engine, decision.step, within)
    names = [action.name for action in engine.description.actions]
    barred = {names[number] for number in (*within.barred, *within.without_actions)}
    actions = tuple(each for each in _told(plan.actions, plan.planner) if each.action not in barred)
    best = next(value for value in actions if value.action == plan.best.action)
    return WhatIf(
        decision.mission,
        decision.step,
        best.action,
        best.q,
        best.stderr,
        decision.action,
        was_worth.get(decision.action, 0.0),
        actions,
        belief,
        plan.planner,
        plan.why,
        said,
    )


async def _values_before(replay: ReplayedMission, decision: DecisionRecord) -> dict[str, float]:
    """The values by which a decision was made, or that it would have been made by."""
    actions, planner = decision.actions, decision.planner
    if not actions:
        plan = await replay.search_by(decision).run(replay.engine, decision.step)
        actions, planner = plan.actions, plan.planner
    return {value.action: value.q for value in _told(actions, planner)}


def _told(actions: tuple[ActionValue, ...], planner: str) -> tuple[ActionValue, ...]:
    """The values as `why` tells them: exact ones, and not those of missions that plan anew at each step."""
    if planner != "exact":
        return actions
    return tuple(
        replace(value, q=value.at_least, stderr=0.0)
        if value.at_most is None
        else replace(value, q=(value.at_least + value.at_most) / 2, stderr=0.0)
        for value in actions
        if value.at_least is not None
    )


def _restricted(engine: Engine, query: WhatIfQuery, was: Restriction) -> Restriction:
    """The actions and the belief that the decision is for; SkillError AOS501 for unknown ones."""
    numbers = {action.name: number for number, action in enumerate(engine.description.actions)}
    skills = {action.skill for action in engine.description.actions}
    for kind, given, known in (("action", query.forbid, numbers), ("skill", query.without, skills)):
        for name in given:
            if name not in known:
                hint = f"Name one of {', '.join(sorted(known))}"
                raise SkillError(f"there is no {kind} {name}", code="AOS501", hint=hint)
    barred = sorted({*was.barred, *(numbers[name] for name in query.forbid)})
    without = sorted({*was.without, *query.without})
    gone = {*barred, *was.without_actions}
    left = [a for n, a in enumerate(engine.description.actions) if n not in gone and a.skill not in without]
    if not left:
        raise StudyError("no action would be left", hint="Forbid fewer")
    return replace(was, barred=barred, without=without)


@asynccontextmanager
async def _engine(
    replay: ReplayedMission, changes: tuple[str, ...], documents: OtherDocuments
) -> AsyncIterator[tuple[Engine, tuple[str, ...]]]:
    """The replay's engine, or one of changed documents with its posterior after the same steps."""
    if not changes:
        yield replay.engine, ()
        return
    files, said = changed_files(await documents.files(replay.revision), changes)
    loaded = load_files(files, name=replay.settings.project)
    if loaded.project is None:
        raise DocumentError(
            "the changed documents have errors", hint="Suppose another", diagnostics=loaded.diagnostics
        )
    built = await built_for(replay.begun, loaded.project, replay.settings, lambda text: None)
    async with await Engine.start(
        built,
        seed=replay.begun.seed,
        impossible_observation=replay.settings.impossible_observation,
        niceness=documents.niceness,
    ) as engine:
        step = 0
        async for update in replayed(engine, replay.past):
            step += 1
            if update.is_impossible:
                said = (*said, f"step {step} is impossible in the changed documents")
        yield engine, said
