"""The whole benchmark: every figure of the problems asked for, ours and the others', one after the other."""

import asyncio
from collections.abc import AsyncIterator, Callable, Iterable, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_lab.bench import baseline, pomdp_py_peer
from aos_lab.bench.measure import discounted_returns, sampling_rate, search_rate, threaded_search_rates
from aos_lab.bench.problems import Problem
from aos_lab.bench.rows import OURS, Report, Row, Skipped, figure, this_machine, with_ratios
from aos_language.load import load_bundle
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, DocumentError
from aos_runtime.distribution import pip_install
from aos_solver.building.compiler import find_compiler
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine, Planner, Stepping

METRICS = ("steps", "simulations", "return")
STEPS_BY_CODE = "steps, by code"
WITHOUT_POLICIES = ", no rollout policy"
"""A mark of a return whose problem has rollout policies, measured without them."""

Step = Callable[[str], None]
"""A call before each piece of work, with its name."""


class Effort(msgspec.Struct, frozen=True, kw_only=True):
    """The effort of a benchmark. `runs` and `budget_s` are of returns; `jobs` missions are run at a time."""

    metrics: tuple[str, ...] = METRICS
    repetitions: int = 5
    seconds: float = 1.0
    peer_simulations: int = 4_000
    runs: int | None = None
    budget_s: float = 0.1
    planners: tuple[Planner, ...] = ("auto",)
    jobs: int = 1
    seed: int = 1

    def runs_of(self, problem: Problem) -> int:
        if "return" not in self.metrics or problem.runs == 0:
            return 0
        return problem.runs if self.runs is None else self.runs


class Suite:
    """One benchmark. Whatever fails or is missing is told in the report, and the rest is measured."""

    def __init__(self, problems: list[Problem], effort: Effort, cache_dir: Path, on_step: Step) -> None:
        self._problems = problems
        self._effort = effort
        self._cache_dir = cache_dir
        self._on_step = on_step
        self._rows: list[Row] = []
        self._skipped: list[Skipped] = []

    @property
    def steps(self) -> int:
        """The number of calls of `on_step`, at most: missions may be run without rollout policies, too."""
        planners = len(self._effort.planners)
        return sum(3 + 2 * planners * self._effort.runs_of(problem) for problem in self._problems)

    async def run(self) -> Report:
        """Measures everything."""
        compiler = await find_compiler()
        machine = this_machine(compiler.version, self._effort.seed, self._effort.budget_s)
        if not pomdp_py_peer.is_installed():
            self._skip(pomdp_py_peer.NAME, f"it is not installed: {pip_install('bench')}")
        for problem in self._problems:
            if not problem.bundle.is_dir():
                self._skip(problem.name, "its documents are not there")
                continue
            with self._telling(problem.name):
                await self._measure_ours(problem)
            with self._telling(f"{pomdp_py_peer.NAME} on {problem.name}"):
                self._measure_peer(problem)
        compared = [problem for problem in self._problems if problem.name in baseline.PROBLEMS]
        if compared and {"steps", "simulations"} & set(self._effort.metrics):
            with self._telling(baseline.NAME):
                baselines = await baseline.Baselines.built(compiler, self._cache_dir)
                await self._measure_baselines(baselines, compared)
        return Report(machine, with_ratios(self._rows), tuple(self._skipped))

    async def _measure_ours(self, problem: Problem) -> None:
        effort = self._effort
        self._on_step(f"{problem.name}: building")
        project = project_of(problem)
        async with self._engine(project) as engine:
            self._on_step(f"{problem.name}: rates")
            if "steps" in effort.metrics:
                await self._sampling_rates(engine, problem)
            if "simulations" in effort.metrics:
                await self._search_rate(engine, problem, "simulations")
                async with self._engine(project) as other:
                    await self._two_threads({1: engine, 2: other}, problem)
        plain = without_policies(project)
        if "simulations" in effort.metrics and plain is not project:
            async with self._engine(plain) as engine:
                await self._search_rate(engine, problem, baseline.WITHOUT_KNOWLEDGE)
        for planner in effort.planners if effort.runs_of(problem) else ():
            metric = f"return, {planner}"
            await self._returns(problem, planner, project, metric)
            if plain is not project:
                await self._returns(problem, planner, plain, f"{metric}{WITHOUT_POLICIES}")

    async def _sampling_rates(self, engine: Engine, problem: Problem) -> None:
        """Measures steps as POMCP makes them; where that is by a table, those by the code, too."""
        effort = self._effort

        async def rates(stepping: Stepping) -> list[float]:
            return await sampling_rate(engine, effort.repetitions, effort.seconds, effort.seed, stepping)

        by_table = await rates("table")
        if by_table:
            self._rows.append(figure(OURS, problem.name, "steps", by_table, "1/s"))
        metric = STEPS_BY_CODE if by_table else "steps"
        self._rows.append(figure(OURS, problem.name, metric, await rates("code"), "1/s"))

    async def _search_rate(self, engine: Engine, problem: Problem, metric: str) -> None:
        rates = await search_rate(engine, self._effort.repetitions, self._effort.seed)
        self._rows.append(figure(OURS, problem.name, metric, rates, "1/s"))

    async def _two_threads(self, engines: Mapping[int, Engine], problem: Problem) -> None:
        """Measures in real time, and so is of use only where two cores are idle."""
        rates = await threaded_search_rates(engines, self._effort.repetitions, self._effort.seed)
        for threads, name in ((2, OURS), (1, "one thread")):
            row = figure(name, problem.name, "simulations, two threads", rates[threads], "1/s")
            self._rows.append(row)

    async def _returns(self, problem: Problem, planner: Planner, project: Project, metric: str) -> None:
        """Missions with the seeds from `seed` on, dealt out to the jobs."""
        seed, runs = self._effort.seed, self._effort.runs_of(problem)
        label = f"{problem.name}: {metric}"

        async def job(number: int) -> list[float]:
            async with self._engine(project) as engine:
                seeds = range(seed + number, seed + runs, self._effort.jobs)
                return await discounted_returns(
                    engine, problem, planner, seeds, self._effort.budget_s, lambda: self._on_step(label)
                )

        async with asyncio.TaskGroup() as tasks:
            jobs = [tasks.create_task(job(number)) for number in range(self._effort.jobs)]
        values = [value for task in jobs for value in task.result()]
        self._rows.append(figure(OURS, problem.name, metric, values, f"{runs} runs"))

    def _measure_peer(self, problem: Problem) -> None:
        if problem.name not in pomdp_py_peer.PROBLEMS or not pomdp_py_peer.is_installed():
            return
        self._on_step(f"{problem.name}: {pomdp_py_peer.NAME}")
        effort = self._effort
        if "steps" in effort.metrics:
            rate = pomdp_py_peer.sampling_rate(problem.name, effort.seconds, effort.seed)
            self._rows.append(figure(pomdp_py_peer.NAME, problem.name, "steps", [rate], "1/s"))
        if "simulations" in effort.metrics:
            rate = pomdp_py_peer.search_rate(problem.name, effort.peer_simulations, effort.seed)
            self._rows.append(figure(pomdp_py_peer.NAME, problem.name, "simulations", [rate], "1/s"))

    async def _measure_baselines(self, baselines: baseline.Baselines, problems: Iterable[Problem]) -> None:
        effort = self._effort
        for problem in problems:
            self._on_step(f"{problem.name}: {baseline.NAME}")
            repetitions = [
                await baselines.measure(problem.name, effort.seconds, effort.seed + turn)
                for turn in range(effort.repetitions)
            ]
            for turns in zip(*repetitions, strict=True):
                metric = turns[0].metric
                if metric.partition(",")[0] not in effort.metrics:
                    continue
                row = figure(baseline.NAME, problem.name, metric, [turn.value for turn in turns], "1/s")
                self._rows.append(row)
                if metric == "steps" and self._has(problem, STEPS_BY_CODE):
                    self._rows.append(replace(row, metric=STEPS_BY_CODE))

    def _has(self, problem: Problem, metric: str) -> bool:
        return any((row.problem, row.metric) == (problem.name, metric) for row in self._rows)

    @asynccontextmanager
    async def _engine(self, project: Project) -> AsyncIterator[Engine]:
        built = await build_project(project, self._cache_dir, kind="thorough")
        async with await Engine.start(built, seed=self._effort.seed, keeps_belief=False) as engine:
            yield engine

    @contextmanager
    def _telling(self, name: str) -> Iterator[None]:
        """A fault within becomes a remark of the report."""
        try:
            yield
        except* AosError as faults:
            self._skip(name, str(faults.exceptions[0]))

    def _skip(self, name: str, reason: str) -> None:
        self._skipped.append(Skipped(name, reason))


def without_policies(project: Project) -> Project:
    """The same documents with random play-outs; the project itself if it has no rollout policies."""
    if not any(skill.model.rollout_policy for skill in project.skills):
        return project
    skills = [replace(skill, model=replace(skill.model, rollout_policy=())) for skill in project.skills]
    return replace(project, skills=tuple(skills))


def project_of(problem: Problem) -> Project:
    """The documents of a problem; DocumentError if they have mistakes."""
    loaded = load_bundle(problem.bundle)
    if loaded.project is None:
        raise DocumentError(f"{problem.bundle} has errors", hint=f"See aos lint {problem.bundle}")
    return loaded.project
