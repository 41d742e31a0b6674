"""The calibration of documents by recorded missions: estimates, and the patch that they suggest."""

import asyncio
import difflib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import msgspec

from aos_deploy.bundles.files import deployment_at, files_of_bundles, files_of_deployment
from aos_deploy.places import cache_dir
from aos_lab.calibration.draws import Draw, Draws, Skipped, draws_of
from aos_lab.calibration.estimation import PRIOR, DrawEstimate, Estimate, estimate
from aos_lab.calibration.lattice import Lattice, Layers, lattice_of
from aos_lab.calibration.records import RecordedMission
from aos_language.load import load_files
from aos_protocol.diagnostics import Span
from aos_protocol.errors import DocumentError
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine


def _not_proposed(estimates: Sequence[DrawEstimate]) -> Iterator[str]:
    """Yields the places where the records contradict a number that is not to be estimated."""
    for found in estimates:
        excluded = [outcome for outcome in found.outcomes if outcome.is_excluded and not outcome.is_inside]
        for outcome in excluded:
            yield (
                f"{found.draw.span}: the documents exclude {outcome.outcome}, and the records have it "
                f"{outcome.count:.0f} times: a weight of 0 is changed by hand only"
            )
        if found.draw.is_initial and not found.is_inside and not excluded:
            yield (
                f"{found.draw.span}: this draw decides what there is at the start, and the records begin "
                "otherwise: it is changed by hand only"
            )


def _by_values(missions: Sequence[RecordedMission]) -> Iterator[tuple[dict[str, str], list[RecordedMission]]]:
    """The missions with the same values of mission parameters, in the order of the first of them."""
    found: dict[frozenset[tuple[str, str]], list[RecordedMission]] = {}
    for mission in missions:
        found.setdefault(frozenset(mission.mission_parameters.items()), []).append(mission)
    for alike in found.values():
        yield alike[0].mission_parameters, alike


class Calibration(msgspec.Struct, frozen=True):
    """The result of a calibration. `remarks` say which steps were not used, and `by_hand` what the patch
    leaves out. The patch's names of files are those from `patch_folder`, this folder (`.`) or the root."""

    missions: int
    steps: int
    remarks: tuple[str, ...]
    estimates: tuple[DrawEstimate, ...]
    skipped: tuple[Skipped, ...]
    patch: str
    patch_folder: str
    by_hand: tuple[str, ...]


def calibrate(
    missions: Sequence[RecordedMission],
    bundles: Sequence[Path],
    *,
    on_build: Callable[[str], None] = lambda text: None,
    on_mission: Callable[[], None] = lambda: None,
    on_sweep: Callable[[int, int], None] = lambda done, of: None,
) -> Calibration:
    """Estimates the numbers of all draws in the bundles' documents; DocumentError if they have errors.

    A deploy file stands for its bundles without the skills that it leaves out. The estimation has an
    event loop of its own for the engine, and none while it estimates: Ctrl-C ends that at once.
    """
    files: dict[str, bytes] = {}
    paths: dict[str, Path] = {}
    for bundle in bundles:
        deployment = deployment_at(bundle)
        found = files_of_bundles((bundle,), ()) if deployment is None else files_of_deployment(deployment)
        files |= found.files
        paths |= {name: (found.bundles[name] / name).resolve() for name in found.files}
    loaded = load_files(files, name=", ".join(map(str, bundles)))
    if loaded.project is None:
        raise DocumentError(
            "the documents have errors", hint="Mend the places named above", diagnostics=loaded.diagnostics
        )
    draws = draws_of(loaded.project)
    lattices = asyncio.run(_lattices(missions, draws, on_build, on_mission))
    estimates = estimate(draws.draws, lattices, on_sweep)
    is_here = all(path.is_relative_to(Path.cwd()) for path in paths.values())
    base = Path.cwd() if is_here else Path("/")
    names = {name: path.relative_to(base).as_posix() for name, path in paths.items()}
    patch, by_hand = patch_of((estimate for estimate in estimates if estimate.is_contradicted), files, names)
    return Calibration(
        missions=len(missions),
        steps=sum(lattice.steps for lattice in lattices),
        remarks=tuple(lattice.remark for lattice in lattices if lattice.remark),
        estimates=estimates,
        skipped=draws.skipped,
        patch=patch,
        patch_folder="." if is_here else "/",
        by_hand=(*by_hand, *_not_proposed(estimates)),
    )


async def _lattices(
    missions: Sequence[RecordedMission],
    draws: Draws,
    on_build: Callable[[str], None],
    on_mission: Callable[[], None],
) -> list[Lattice]:
    """Returns all that each mission may have been, by the engine of the documents."""
    built = await build_project(draws.keeping, cache_dir(), on_build)
    async with await Engine.start(built, seed=1, keeps_belief=False) as engine:
        lattices: list[Lattice] = []
        for values, alike in _by_values(missions):
            await engine.start_with(values)
            layers = Layers(engine, [draw.variable for draw in draws.draws])
            for mission in alike:
                lattices.append(await lattice_of(mission, layers))
                on_mission()
        return lattices


_DIGITS = 4
_SAME = 0.5 * 10.0**-_DIGITS


def proposed_numbers(estimate: DrawEstimate) -> tuple[float, ...]:
    """Returns the numbers in place of the draw's; the weights of a discrete draw make 1.

    An outcome outside its interval gets its share of the records. Those inside share the rest as the
    documents have them. What the documents exclude stays 0. An outcome that they allow and that never came
    keeps half a record's weight: with 0 its first coming would be impossible.
    """
    possible = [outcome for outcome in estimate.outcomes if not outcome.is_excluded]
    inside = [outcome for outcome in possible if outcome.is_inside]
    hits = {outcome.outcome: outcome.count or PRIOR for outcome in possible}
    rest = max(sum(outcome.count for outcome in inside), PRIOR * len(inside))
    total = rest + sum(hits[outcome.outcome] for outcome in possible if not outcome.is_inside)
    weight_inside = sum(outcome.document for outcome in inside)

    def share(outcome: Estimate) -> float:
        if outcome.is_excluded:
            return 0.0
        of_document = rest * outcome.document / weight_inside if outcome.is_inside else 0.0
        return round((of_document or hits[outcome.outcome]) / total, _DIGITS)

    shares = [share(outcome) for outcome in estimate.outcomes]
    if estimate.draw.kind == "Bernoulli":
        return (shares[1],)
    largest = shares.index(max(shares))
    others = sum(share for number, share in enumerate(shares) if number != largest)
    shares[largest] = round(1 - others, _DIGITS)
    return tuple(shares)


def patch_of(
    estimates: Iterable[DrawEstimate], files: Mapping[str, bytes], paths: Mapping[str, str]
) -> tuple[str, tuple[str, ...]]:
    """The diff, and what it leaves out: numbers that do not stand in a document as they are used.

    `files` are the documents by the names in their places, `paths` how the diff names them.
    """
    edits: dict[str, list[tuple[Span, str, str]]] = {}
    for found in estimates:
        draw: Draw = found.draw
        for span, old, new in zip(draw.places, draw.texts, proposed_numbers(found), strict=True):
            if abs(float(old.rstrip("fF")) - new) >= _SAME:
                edits.setdefault(span.file, []).append((span, old, f"{new:g}"))
    parts: list[str] = []
    left_out: list[str] = []
    for name, changes in sorted(edits.items()):
        lines = files[name].decode("utf-8").splitlines(keepends=True)
        changed = list(lines)
        for span, old, value in sorted(changes, key=lambda change: -change[0].column):
            line, start = changed[span.line - 1], span.column - 1
            if line[start : start + len(old)] != old:
                left_out.append(f"{span}: {old} has to become {value} by hand")
                continue
            changed[span.line - 1] = line[:start] + value + line[start + len(old) :]
        path = paths[name]
        parts += difflib.unified_diff(lines, changed, f"a/{path}", f"b/{path}")
    return "".join(parts), tuple(left_out)
