"""`aos solve`: a policy for a bundle or a problem file, worked out before the mission."""

import asyncio
import hashlib
import shutil
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Annotated, NamedTuple

import msgspec
import typer
from msgspec.structs import replace
from rich.progress import BarColumn, TextColumn

from aos_deploy.bundles.engine import engine_of_bundle
from aos_deploy.deployment.mission_values import SetValues, values_of_options
from aos_deploy.deployment.parts import MAX_COUNT
from aos_deploy.options import AsJson, TrustDocuments, all_writable, command, finite, seconds, writable
from aos_deploy.places import cache_dir
from aos_deploy.printing import count, print_json
from aos_deploy.terminal import progress, waiting
from aos_deploy.views.values import Digits
from aos_lab.formats import is_problem_file, problem_ending
from aos_lab.formats.graph_writers import c_header, graphviz, write_text
from aos_lab.formats.policy_graph import PolicyGraph, policy_graph
from aos_lab.formats.problem_files import read_problem
from aos_lab.formats.problem_writers import WRITERS, write_problem
from aos_protocol.documents import MissionValue
from aos_protocol.errors import DeployError, PlanningError
from aos_solver.child.answers.models import Listed
from aos_solver.offline.enumeration import MAX_STATES, enumerate_model
from aos_solver.offline.explicit_model import ExplicitModel, ModelSize, with_stopping
from aos_solver.offline.policy import Policy, PolicyHeader
from aos_solver.offline.solving import (
    Bounds,
    Solution,
    SolvingLimits,
    build_solver,
    check_discount,
    precision_of,
)
from aos_solver.offline.solving import solve as solve_model

_TOLD_NAMES = 12
_GRAPH_ENDINGS = (".dot", ".svg")
_MEANINGS = {
    "precision": "the bounds are as near as asked for",
    "settled": "the bounds come no nearer",
    "time": "the time is used up",
    "memory": "the memory is used up",
    "stopped": "stopped",
}


class _Target(msgspec.Struct, frozen=True):
    """The problem to solve: `digest` is of the compiled model or the file, `states` are the texts of its
    states, which are not told apart by what is `left_out`. `mission_parameters` are the values of all."""

    model: ExplicitModel
    digest: str
    states: tuple[str, ...]
    left_out: tuple[str, ...] = ()
    mission_parameters: dict[str, str] = {}


class Report(msgspec.Struct):
    """The output of `aos solve --json`.

    States are not told apart by the variables `left_out`. `history` is every progress; `graph_value` is what
    the graph gives.
    """

    model: str
    size: ModelSize
    left_out: tuple[str, ...]
    discount: float
    lower: float
    upper: float
    seconds: float
    ending: str
    vectors: int
    history: tuple[Bounds, ...]
    graph_nodes: int | None
    graph_value: float | None
    written: list[str]


class SolvingOptions(NamedTuple):
    """The model that is solved, and how far."""

    time_s: Annotated[float, seconds("--time", least=0.001, help="Seconds of computing at most")] = 60.0
    precision: Annotated[
        float | None,
        typer.Option(
            min=0,
            callback=finite,
            help="Enough when the bounds are so near; else 0.001, less for small rewards",
        ),
    ] = None
    discount: Annotated[
        float | None,
        typer.Option(min=0, max=1, callback=finite, help="Instead of the documents' own discount"),
    ] = None
    stop_value: Annotated[
        float | None, typer.Option(callback=finite, help="To end the mission is worth so much, at any time")
    ] = None
    states: Annotated[int, typer.Option(min=1, max=MAX_COUNT, help="Give up beyond so many states")] = (
        MAX_STATES
    )


class OutputOptions(NamedTuple):
    """The files that are written."""

    out: Annotated[
        Path | None, typer.Option(help="Save the policy, for aos-up, plan and simulate", callback=writable)
    ] = None
    export: Annotated[
        list[Path] | None,
        typer.Option(help="Write the model as .pomdpx or .pomdp; may be repeated", callback=all_writable),
    ] = None
    graph: Annotated[
        Path | None, typer.Option(help="Draw the policy: .dot, or .svg by Graphviz", callback=writable)
    ] = None
    header: Annotated[
        Path | None,
        typer.Option("--c-header", help="Write the policy as C that needs nothing else", callback=writable),
    ] = None
    nodes: Annotated[int, typer.Option(min=1, max=50_000, help="Size of the drawing and of the C")] = 200


@command("Example: aos solve deploy/bundles/armadillo-finer --out armadillo.policy")
def solve(
    target: Annotated[
        Path, typer.Argument(metavar="TARGET", help="A bundle, a deploy, .pomdpx or .pomdp file")
    ],
    solving: SolvingOptions,
    files: OutputOptions,
    set_values: SetValues = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Work out a policy before the mission.

    The bounds of what it gives are proven. Every state that can be reached is enumerated and solved with
    SARSOP. Ctrl-C ends it early and keeps the best so far. Values are discounted and without a horizon.
    """
    exports = files.export or []
    _check_names(exports, files.graph)
    if is_problem_file(target):
        if set_values:
            raise typer.BadParameter("a problem file has no mission parameters", param_hint="--set")
        found = _problem(target, solving.states, solving.discount)
    else:
        values = values_of_options(set_values)
        found = asyncio.run(_enumerated(target, solving, values, is_exported=bool(exports)))
    if solving.stop_value is not None:
        found = replace(found, model=with_stopping(found.model, solving.stop_value))
    limits = SolvingLimits(precision=solving.precision, cpu_s=solving.time_s)
    for path in exports:
        write_problem(found.model, path)
    written = [str(path) for path in exports]
    check_discount(found.model.name, found.model.discount)
    if not as_json:
        _print_size(found)
    # Four decimals for the usual precision of 0.001, and more for a smaller one.
    digits = Digits.of([1000 * min(precision_of(found.model, limits), 1e-3)], 4)
    solution = asyncio.run(_solve(found.model, limits, None if as_json else digits))
    if files.out is not None:
        _policy(found, solution, solving.stop_value).save(files.out)
        written.append(str(files.out))
    drawn = None
    if files.graph or files.header:
        drawn = policy_graph(found.model, solution.vectors, max_nodes=files.nodes)
        written += _write_graph(drawn, files.graph, files.header)
    if as_json:
        print_json(_report(found, solution, drawn, written))
    else:
        _print_end(solution, drawn, written, digits)


def _check_names(exports: list[Path], graph: Path | None) -> None:
    """Refuses names of files with a wrong ending before the work begins."""
    for path in exports:
        if problem_ending(path) not in WRITERS:
            raise typer.BadParameter(f"{path} needs to end in {' or '.join(WRITERS)}", param_hint="--export")
    if graph is not None and graph.suffix not in _GRAPH_ENDINGS:
        endings = " or ".join(_GRAPH_ENDINGS)
        raise typer.BadParameter(f"{graph} needs to end in {endings}", param_hint="--graph")
    if graph is not None and graph.suffix == ".svg" and shutil.which("dot") is None:
        hint = "Install it (apt install graphviz), or write a .dot file"
        raise DeployError("drawing an .svg needs Graphviz", code="AOS805", hint=hint)


def _problem(path: Path, max_states: int, discount: float | None) -> _Target:
    with _progress() as on_progress:
        model = read_problem(
            path, max_states=max_states, on_progress=lambda known: on_progress(Listed(known, known))
        )
    if discount is not None:
        model = replace(model, discount=discount)
    return _Target(model, hashlib.sha256(path.read_bytes()).hexdigest(), model.states)


async def _enumerated(
    bundle: Path, solving: SolvingOptions, values: tuple[MissionValue, ...], *, is_exported: bool
) -> _Target:
    discount = solving.discount
    async with engine_of_bundle(bundle, seed=1, values=values) as engine:
        if not is_exported:  # A file may have any discount.
            wanted = engine.description.discount if discount is None else discount
            check_discount(engine.description.project, wanted)
        with _progress() as on_progress:
            found = await enumerate_model(
                engine, max_states=solving.states, discount=discount, on_progress=on_progress
            )
        parameters = engine.description.mission_parameters
        return _Target(found.model, engine.model_digest, found.state_texts, found.left_out, parameters)


async def _solve(model: ExplicitModel, limits: SolvingLimits, digits: Digits | None) -> Solution:
    """Solves until a limit or Ctrl-C. Shows that it works until there are bounds, and prints these with the
    digits, if they are given."""
    await build_solver(cache_dir(), lambda remark: typer.echo(f"aos: {remark}", err=True))
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGINT, stop.set)
    with ExitStack() as until_bounds:
        until_bounds.enter_context(waiting("computing first bounds"))

        def show(bounds: Bounds) -> None:
            until_bounds.close()
            if digits is not None and not bounds.ending:
                lower, upper = _outwards(bounds, digits)
                values = f"{lower:>12} {upper:>12} {digits.plain(bounds.gap):>10}"
                typer.echo(f"{bounds.seconds:9.2f} {values} {bounds.vectors:9,}")

        try:
            return await solve_model(model, limits, cache_dir=cache_dir(), on_progress=show, stop=stop)
        finally:
            loop.remove_signal_handler(signal.SIGINT)


def _policy(target: _Target, solution: Solution, stop_value: float | None) -> Policy:
    header = PolicyHeader(
        model=target.model.name,
        model_digest=target.digest,
        discount=target.model.discount,
        lower=solution.bounds.lower,
        upper=solution.bounds.upper,
        stop_value=stop_value,
        actions=target.model.actions,
        states=target.states,
        mission_parameters=target.mission_parameters,
    )
    return Policy(header, solution.vectors)


def _write_graph(drawn: PolicyGraph, graph: Path | None, header: Path | None) -> list[str]:
    written = []
    if graph is not None:
        text = graphviz(drawn)
        if graph.suffix == ".svg":
            done = subprocess.run(["dot", "-Tsvg"], input=text, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise PlanningError(f"Graphviz could not draw {graph}: {done.stderr.strip()}", code="AOS101")
            text = done.stdout
        write_text(graph, text)
        written.append(str(graph))
    if header is not None:
        write_text(header, c_header(drawn, header.stem))
        written.append(str(header))
    return written


# --- what is told ---


@contextmanager
def _progress() -> Iterator[Callable[[Listed], None]]:
    """A bar on stderr of how many of the known states are listed; it goes away in the end."""
    extent = TextColumn("{task.completed:,} of {task.total:,}")
    columns = (TextColumn("{task.description}"), BarColumn(), extent)
    with progress(*columns) as bar:
        task = bar.add_task("states", total=1)
        yield lambda found: bar.update(task, completed=found.listed, total=found.known)


def _print_size(target: _Target) -> None:
    model, size = target.model, target.model.size
    spaces = f"{count(size.states, 'state')}, {count(size.actions, 'action')}"
    sensing = count(size.observations, "observation")
    typer.echo(f"{model.name}: {spaces}, {sensing}, discount {model.discount:.16g}")
    _print_left_out(target.left_out)
    typer.echo(f"{'seconds':>9} {'at least':>12} {'at most':>12} {'gap':>10} {'vectors':>9}")


def _print_left_out(names: tuple[str, ...]) -> None:
    if names:
        more = f" and {len(names) - _TOLD_NAMES} more" if len(names) > _TOLD_NAMES else ""
        listing = f"{', '.join(names[:_TOLD_NAMES])}{more}"
        typer.echo(f"left out, as they change neither what is earned nor what is observed: {listing}")


def _outwards(bounds: Bounds, digits: Digits) -> tuple[str, str]:
    """Both bounds so that they hold in the printed digits as well."""
    return digits.plain(digits.down(bounds.lower)), digits.plain(digits.up(bounds.upper))


def _print_end(solution: Solution, drawn: PolicyGraph | None, written: list[str], digits: Digits) -> None:
    bounds = solution.bounds
    lower, upper = _outwards(bounds, digits)
    typer.echo(
        f"the policy gives at least {lower} from the start, and none more than {upper} "
        f"({_MEANINGS[bounds.ending]}, {bounds.seconds:.2f} s)"
    )
    if drawn is not None:
        extent = "" if drawn.is_whole else "; likelier beliefs have nodes of their own, --nodes adds more"
        value = digits.plain(drawn.value)
        typer.echo(f"as a graph of {count(len(drawn.nodes), 'node')} it gives {value}{extent}")
    for path in written:
        typer.echo(f"wrote {path}")


def _report(target: _Target, solution: Solution, drawn: PolicyGraph | None, written: list[str]) -> Report:
    bounds = solution.bounds
    return Report(
        model=target.model.name,
        size=target.model.size,
        left_out=target.left_out,
        discount=target.model.discount,
        lower=bounds.lower,
        upper=bounds.upper,
        seconds=bounds.seconds,
        ending=bounds.ending,
        vectors=bounds.vectors,
        history=solution.history,
        graph_nodes=len(drawn.nodes) if drawn is not None else None,
        graph_value=drawn.value if drawn is not None else None,
        written=written,
    )
