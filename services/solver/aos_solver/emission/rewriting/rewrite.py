"""The few edits that make document code C++ in its function. They stay within their lines."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

import msgspec

from aos_language.cpp.goal_conditions import Edits
from aos_language.cpp.keywords import DRAW_SOURCES, STATES
from aos_language.cpp.loops import DrawingLoop
from aos_language.cpp.shared import SharedFunction
from aos_language.cpp.snippets import Call, Cpp, Extent, strip_comments
from aos_language.cpp.values import values_meant
from aos_language.observed import reports_in
from aos_protocol.documents import line_and_column
from aos_solver.emission.program import Edit
from aos_solver.emission.rewriting.containers import container_edits
from aos_solver.emission.rewriting.objects import object_edits
from aos_solver.emission.rewriting.references import capture_edits, index_edits, reference_edits

_CATCH_ALL = re.compile(r"\bcatch\s*\(\s*\.\.\.\s*\)\s*\{")
_SCOPE = re.compile(r"AOS(?:Utils)?")

EnumValues = tuple[str, ...] | None
"""The values of an enum that does not count from 0 upwards; None for one that does."""


class Rewriting(msgspec.Struct, frozen=True):
    """The meanings of names in a section.

    `object_types` are the compound types with a list of objects, `enums` those that are types, `values` the
    constants that every section sees, `drawing` the shared functions that have a source of draws as their
    first parameter. `counted` are the edits that count conditions, by the snippet's text. `responses` are
    those of the skill that have the name of an enum's value.
    """

    object_types: frozenset[str]
    enums: Mapping[str, EnumValues]
    values: frozenset[str] = frozenset()
    drawing: frozenset[str] = frozenset()
    counted: Mapping[str, Edits] = {}
    responses: frozenset[str] = frozenset()


class LoopsOfPiece(msgspec.Struct, frozen=True):
    """The drawing loops of a piece; `unset` is where its variables without a first value are declared.

    The loops have the numbers from `first` on, which no other loop of the model has.
    """

    loops: tuple[DrawingLoop, ...] = ()
    unset: tuple[int, ...] = ()
    first: int = 0


NO_LOOPS = LoopsOfPiece()


def rewrite(
    cpp: Cpp,
    rewriting: Rewriting,
    told_apart: Mapping[int, str],
    functions: Iterable[SharedFunction] = (),
    of_loops: LoopsOfPiece = NO_LOOPS,
) -> tuple[str, tuple[Edit, ...]]:
    """The text to emit, and what was edited. `told_apart`: the starts of draws of a kind, with its word.

    - a missing last `;` is put in
    - `AOSUtils::` becomes `AOSUtils.`
    - `state.<Type>Objects`, a view made on demand, gets its `()`
    - `AOS.SampleDiscrete(Enum, {...})` becomes `AOS.template SampleDiscrete<Enum>({...})`
    - over an enum whose values have numbers of their own it becomes `AOS.SampleOf({Enum::a, Enum::b}, {...})`
    - such a draw says so: `AOS.sensing().Bernoulli(p)`, `AOS.averaged().SampleNormal(mean, deviation)`
    - a draw that is reported becomes its distribution: `__observed.range = aos::Normal(mean, deviation)`
    - `state->x` becomes `state.x`
    - `catch (...)` lets pass what ends a path of draws
    - an enum's value with the name of a response becomes `model::value` where only the value can be meant
    - a call of a shared function that draws, `slips(0.1)`, becomes `slips(AOS, 0.1)`, and its definition, one
      of `functions`, `bool slips(auto& AOS, double p) {`
    - a loop that draws tells of its rounds: see `drawing_loop.hpp`; variables that it may read are set first
    - objects, containers, indexes, references and lambdas: see the neighbours
    """
    reported = [report.draw for report in reports_in(cpp)]
    edits: list[tuple[Extent | int, str]] = list(_before_loops(of_loops))
    edits += _of_mentions(cpp, rewriting, reported)
    edits += _of_drawing_calls(cpp, rewriting.drawing)  # Before what begins at the first argument.
    for draw in reported:
        edits += _of_reported(draw)
    unnamed = [*object_edits(cpp, rewriting.object_types), *container_edits(cpp, rewriting.values)]
    unnamed += [*reference_edits(cpp), *capture_edits(cpp, rewriting.drawing), *index_edits(cpp)]
    edits += [(place.start, "model::") for place in values_meant(cpp, rewriting.responses)]
    for start, end, text in unnamed:
        edits.append((Extent(start, end) if end > start else start, text))
    edits += _of_definitions(cpp, functions)
    edits += [
        (found.end(), " aos::let_paths_end();") for found in _CATCH_ALL.finditer(strip_comments(cpp.code))
    ]
    edits += rewriting.counted.get(cpp.code, ())
    for call in cpp.calls:
        if call not in reported:
            edits += _of_call(call, cpp.code, rewriting)
            if kind := told_apart.get(call.function.start):
                scope = _SCOPE.match(cpp.code, call.function.start)
                edits += [(scope.end(), f".{kind}()")] if scope is not None else []
    edits += [(loop.head_end, ")" if loop.head_end > loop.head else "true)") for loop in of_loops.loops]
    # Last, since a bracket that goes to the same place has to come before it.
    edits += [(offset, ";") for offset in cpp.missing_semicolons]
    edits += _after_loops(of_loops.loops)
    unique = list(dict.fromkeys(edits))
    return cpp.replace(unique), tuple(sorted(_placed(unique, cpp.code), key=lambda e: (e.line, e.column)))


def _of_drawing_calls(cpp: Cpp, drawing: frozenset[str]) -> Iterator[tuple[Extent | int, str]]:
    own = cpp.declared
    for call in cpp.calls:
        if len(call.name) == 1 and call.name[0] in drawing - own:
            at = cpp.code.index("(", call.function.end) + 1
            yield at, "AOS, " if call.arguments else "AOS"


def _of_definitions(cpp: Cpp, functions: Iterable[SharedFunction]) -> Iterator[tuple[Extent | int, str]]:
    for function in functions:
        if function.draws:
            yield function.parameters, "auto& AOS, " if function.has_parameters else "auto& AOS"
        body = cpp.code[function.body : function.extent.end]
        if function.draws and re.search(r"\bAOSUtils\b", body):
            yield function.body, " auto& AOSUtils = AOS; "


def _before_loops(of_loops: LoopsOfPiece) -> Iterator[tuple[Extent | int, str]]:
    for offset in of_loops.unset:
        yield offset, "{}"
    for index, loop in enumerate(of_loops.loops, 1):
        yield loop.start, f"{{ aos::DrawingLoop aos_loop_{index}{{AOS, {of_loops.first + index - 1}}}; "
        ties = ", ".join(f"std::tie({', '.join(names)})" for names in (loop.mentioned, loop.others))
        head = "head_in_function" if loop.is_in_function else "head"
        yield loop.head, f"aos_loop_{index}.{head}({ties}), ("


def _after_loops(loops: Sequence[DrawingLoop]) -> Iterator[tuple[Extent | int, str]]:
    for end in dict.fromkeys(loop.end for loop in loops):
        yield end, " }" * sum(loop.end == end for loop in loops)


def _of_mentions(
    cpp: Cpp, rewriting: Rewriting, reported: Iterable[Call]
) -> Iterator[tuple[Extent | int, str]]:
    renamed = {draw.function.start for draw in reported}
    for mention in cpp.mentions:
        if mention.root.start in renamed:
            continue
        if scope := re.compile(r"AOSUtils\s*::").match(cpp.code, mention.root.start):
            yield Extent(scope.end() - 2, scope.end()), "."
        if mention.path[0] not in STATES or len(mention.path) < 2:
            continue
        after_root = mention.root.end
        if arrow := re.compile(r"\s*->").match(cpp.code, after_root):
            yield Extent(arrow.end() - 2, arrow.end()), "."
        name = mention.path[1]
        if name.removesuffix("Objects") in rewriting.object_types and name.endswith("Objects"):
            pattern = re.compile(rf"\s*(?:\.|->)\s*{name}\b(?!\s*\()")
            if found := pattern.match(cpp.code, after_root):
                yield found.end(), "()"


_DISTRIBUTIONS = {
    "Bernoulli": "aos::Bernoulli",
    "SampleDiscrete": "aos::Discrete",
    "SampleNormal": "aos::Normal",
    "SampleUniform": "aos::Uniform",
}


def _of_reported(draw: Call) -> Iterator[tuple[Extent | int, str]]:
    """Yields the edits of a draw that is reported: of an enum's values the number, whatever the enum is
    called."""
    yield draw.function, _DISTRIBUTIONS[draw.name[1]]
    if draw.name[1] == "SampleDiscrete" and len(draw.arguments) == 2:
        yield draw.arguments[0], "aos::normalised"


def _of_call(call: Call, code: str, rewriting: Rewriting) -> Iterator[tuple[Extent | int, str]]:
    if call.name[-1:] != ("SampleDiscrete",) or call.name[0] not in DRAW_SOURCES:
        return
    if len(call.arguments) != 2:
        return
    first, second = call.arguments
    name = Extent(call.function.end - len("SampleDiscrete"), call.function.end)
    over = code[first.start : first.end].strip()
    values = rewriting.enums.get(over)
    if values is not None:
        yield name, "SampleOf"
        yield first, f"{{{', '.join(values)}}}"
    elif over in rewriting.enums:
        bracket = strip_comments(code).index("(", call.function.end)
        yield name.start, "template "
        yield Extent(bracket, bracket + 1), "<"
        yield _comma(code, first, second), ">("


def _comma(code: str, first: Extent, second: Extent) -> Extent:
    """The comma between two arguments, with the blanks behind it."""
    between = strip_comments(code)[first.end : second.start]
    start = first.end + between.index(",")
    end = start + 1
    while code[end] in " \t":
        end += 1
    return Extent(start, end)


def _placed(edits: Iterable[tuple[Extent | int, str]], code: str) -> Iterator[Edit]:
    for at, text in edits:
        extent = Extent(at, at) if isinstance(at, int) else at
        yield Edit(*line_and_column(code, extent.start), extent.end - extent.start, len(text))
