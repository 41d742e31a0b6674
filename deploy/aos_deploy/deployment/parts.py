"""The deploy file as it is written: which robot, documents, world and budgets make up a system.

Its parts say what each setting means, and have the defaults of what is left out.
"""

from typing import Annotated, Any, Literal

import msgspec

from aos_deploy.deployment.own_programs import ProgramPart, Seconds
from aos_protocol.documents import MAX_HORIZON
from aos_solver.mission.rules.failures import SkillRule

Probability = Annotated[float, msgspec.Meta(gt=0, le=1)]
MAX_COUNT = 2**31 - 1
MAX_SEED = 2**63 - 1
Count = Annotated[int, msgspec.Meta(ge=1, le=MAX_COUNT)]
Horizon = Annotated[int, msgspec.Meta(ge=1, le=MAX_HORIZON)]
Seed = Annotated[int, msgspec.Meta(ge=0, le=MAX_SEED)]


class BusPart(msgspec.Struct, frozen=True, kw_only=True):
    """The address at which the router listens: without one, a socket in the run directory.

    Port 0 takes any free one.
    """

    listen: str = ""


class ConstraintPart(msgspec.Struct, frozen=True, kw_only=True):
    """The event `never` has at most this `probability` in a mission; see docs/constraints.md.

    It is an expression of the documents' language over `state`, `state__` and the names of skills. Searches
    count `cost` less for a step that violates it.
    """

    never: str
    probability: Annotated[float, msgspec.Meta(ge=0, lt=1)]
    cost: Annotated[float, msgspec.Meta(ge=0)] = 0.0


class MissionPart(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The conditions that end a mission. `stop_below_value` is an expected return; without one nothing is too
    poor.

    A skill is set aside for `set_aside_s` after `set_aside_after` failures in a row, and the mission ends
    after `failure_limit` failures of all skills; see docs/when-a-skill-fails.md. It holds for `hold_s` at
    most, for somebody or for adapters that have left. `constraints` are what it must hardly ever do. `set`
    gives values to the mission parameters that the documents declare.
    """

    goal_probability: Probability = 0.9
    step_limit: Count = 30
    stop_below_value: float | None = None
    activation_timeout_s: Seconds = 120.0
    failure_limit: Count = 30
    set_aside_after: Count = 3
    set_aside_s: Seconds = 300.0
    hold_s: Seconds = 600.0
    constraints: tuple[ConstraintPart, ...] = ()
    set: dict[str, Any] = {}


class SolverPart(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The budget of one decision, in simulations or in time, and what makes it reproducible.

    Without a horizon the environment document's holds, and with `plans_to_step_limit` it ends where the
    mission does. With the planner `auto` the model, the belief and the budget decide. POMCP can search with
    several `threads`; POMCP and SARSOP, with a budget in time, go on while a skill runs. With a `policy`,
    which `aos solve` has written, nothing is searched.
    """

    simulations: Count | None = None
    time_s: Seconds | None = None
    horizon: Horizon | None = None
    plans_to_step_limit: bool = False
    policy: str | None = None
    planner: Literal["pomcp", "despot", "sarsop", "auto"] = "auto"
    threads: Annotated[int, msgspec.Meta(ge=1, le=32)] = 1
    ponder_while_acting: bool = True
    seed: Seed = 1
    impossible_observation: Literal["hold", "widen", "reset"] = "widen"


class SpansPart(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The collector that gets OpenTelemetry's spans of missions, by OTLP over HTTP; without one none are
    made."""

    otlp: str = ""


class DeployFile(msgspec.Struct, frozen=True, kw_only=True):
    """The file as it is written; what is not required has the defaults given here.

    `project` is the project that the bundles' documents name, by default the robot's name. `leave_out` names
    skills whose documents are kept back at the start. `watch` is the folder whose sub-folders
    the registry takes as bundles, by default `drop` in the run directory. `skills` says what follows when a
    skill fails. `adapters` gives adapters a name and options. `bind` says which adapter serves which
    activation path of the abstraction mappings, `"*"` stands for all others; see docs/deploy-file.md. `serve`
    says how `aos-up --serve` shows them to others. `programs` run beside the adapters. `runs` is where run
    directories go. With `trust: documents` their code runs also where the kernel cannot confine it. A system
    with `stay` goes on after its mission, and waits for the next. Where `spans` names a collector, it gets
    OpenTelemetry's spans of the missions.
    """

    aos: Literal[1]
    robot: str
    bundles: tuple[str, ...]
    project: str = ""
    leave_out: tuple[str, ...] = ()
    watch: str | None = None
    bus: BusPart = BusPart()
    mission: MissionPart = MissionPart()
    solver: SolverPart = SolverPart()
    world: str | None = None
    skills: dict[str, SkillRule] = {}
    adapters: dict[str, Any] = {}
    bind: dict[str, Any] = {}
    serve: dict[str, Any] = {}
    programs: dict[str, ProgramPart] = {}
    runs: str = "runs"
    trust: Literal["nobody", "documents"] = "nobody"
    stay: bool = False
    spans: SpansPart = SpansPart()
