"""The draws of a project whose probabilities are numbers, and documents that keep what was drawn.

In the documents that keep it, each such draw has a state variable more, which holds the number of its outcome
from 1 on, or 0 where the last step did not come to it. All outcomes are equally likely there, also those that
the documents exclude: a record may show them. Nothing ends or is rewarded.
"""

import re
from collections.abc import Iterator

import msgspec
from msgspec.structs import replace

from aos_language.cpp.keywords import DRAW_SOURCES
from aos_language.cpp.snippets import Call, Cpp, DeclarationKind, Extent, read_cpp, strip_comments
from aos_language.cpp.tree import tree_of
from aos_language.observed import reports_in
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Assignment, Environment, Project, Skill, Snippet, StateVariable

_NUMBER = re.compile(r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[fF]?")
_KINDS = ("Bernoulli", "SampleDiscrete")
_ENCLOSING = frozenset(
    {"for_statement", "while_statement", "do_statement", "for_range_loop", "lambda_expression"}
)
_BEFORE = "void f() {"


class Draw(msgspec.Struct, frozen=True):
    """A draw: `places` are the places of its weights in the documents, as they stand there in `texts`.

    A Bernoulli has one number, the probability of its second outcome, `true`. `skill` is empty in the
    environment's code; `is_initial` in its initial belief, where a draw decides what there is at the start.
    """

    variable: str
    skill: str
    kind: str
    span: Span
    outcomes: tuple[str, ...]
    weights: tuple[float, ...]
    places: tuple[Span, ...]
    texts: tuple[str, ...]
    is_initial: bool = False


class Skipped(msgspec.Struct, frozen=True):
    """A draw that cannot be estimated, and why."""

    span: Span
    why: str


class Draws(msgspec.Struct, frozen=True):
    """The draws of a project, the ones that cannot be estimated, and the project that keeps what is drawn."""

    draws: tuple[Draw, ...]
    skipped: tuple[Skipped, ...]
    keeping: Project


class _Weight(msgspec.Struct, frozen=True):
    """A number in a draw: where it is used, and where it stands, which is elsewhere for a constant."""

    use: Extent
    stands: Extent


def draws_of(project: Project) -> Draws:
    """All draws of the dynamic models, the extrinsic changes and the initial belief."""
    search = _Search(project.environment)
    skills = tuple(search.skill(skill) for skill in project.skills)
    environment = search.environment(project.environment)
    keeping = replace(project, environment=environment, skills=skills)
    return Draws(tuple(search.draws), tuple(search.skipped), keeping)


class _Search:
    """Goes through a project's code, and makes its other text meanwhile."""

    def __init__(self, environment: Environment) -> None:
        self.draws: list[Draw] = []
        self.skipped: list[Skipped] = []
        self._enums = {enum.name: enum.values for enum in environment.enums}

    def skill(self, skill: Skill) -> Skill:
        changed = self._section(skill.model.dynamic_model, skill.name, "state__")
        return replace(skill, model=replace(skill.model, dynamic_model=changed))

    def environment(self, environment: Environment) -> Environment:
        """Returns the environment with the variables of all draws so far and of its own."""
        extrinsic = self._section(environment.extrinsic_changes, "", "state_")
        before = len(self.draws)
        initial = self._section(environment.initial_belief, "", "state")
        self.draws[before:] = [replace(d, is_initial=True) for d in self.draws[before:]]
        span = environment.span
        variables = tuple(
            StateVariable(draw.variable, "int", span, default_code=_code(f"state.{draw.variable} = 0;", span))
            for draw in self.draws
        )
        forget = _code(" ".join(f"state_.{draw.variable} = 0;" for draw in self.draws), span)
        return replace(
            environment,
            variables=(*environment.variables, *variables),
            initial_belief=initial,
            extrinsic_changes=(Assignment(span, code=forget), *extrinsic) if self.draws else extrinsic,
            special_states=(),
            state_heuristic=(),
            print_state=(),
        )

    def _section(self, code: tuple[Assignment, ...], skill: str, copy: str) -> tuple[Assignment, ...]:
        return tuple(self._assignment(assignment, skill, copy) for assignment in code)

    def _assignment(self, assignment: Assignment, skill: str, copy: str) -> Assignment:
        for loop in (*assignment.over_previous, *assignment.over_next):
            if loop.body is not None:
                for call in _calls(read_cpp(loop.body.code)):
                    self._skip(loop.body, call, "it is drawn in a loop")
        if assignment.code is None:
            return assignment
        snippet = assignment.code
        cpp = read_cpp(snippet.code)
        edits: list[tuple[Extent | int, str]] = []
        for call in _calls(cpp):
            weights = _weights(cpp, call)
            if _is_repeated(snippet.code, call.extent.start):
                self._skip(snippet, call, "it is drawn in a loop")
            elif weights is None:
                self._skip(snippet, call, "its probability is computed, and no number of the document")
            else:
                edits += self._keep(snippet, cpp, call, weights, skill, copy)
        changed = replace(snippet, code=cpp.replace(edits))
        return replace(assignment, code=changed)

    def _keep(
        self, snippet: Snippet, cpp: Cpp, call: Call, weights: list[_Weight], skill: str, copy: str
    ) -> Iterator[tuple[Extent | int, str]]:
        """Draws the outcome before the call, which is left with that one alone."""
        variable = f"drawn_here_{len(self.draws) + 1}"
        texts = tuple(snippet.code[weight.stands.start : weight.stands.end] for weight in weights)
        self.draws.append(
            Draw(
                variable=variable,
                skill=skill,
                kind=call.name[1],
                span=snippet.at(call.extent.start),
                outcomes=self._outcomes(cpp, call, len(weights)),
                weights=tuple(float(text.rstrip("fF")) for text in texts),
                places=tuple(snippet.at(weight.stands.start) for weight in weights),
                texts=texts,
            )
        )
        kept = f"{copy}.{variable}"
        if call.name[1] == "Bernoulli":
            yield weights[0].use, f"({kept} = AOS.Bernoulli(0.5) ? 2 : 1) == 2 ? 1.0 : 0.0"
            return
        equal = ", ".join(["1.0"] * len(weights))
        chosen = f"({kept} = 1 + AOS.SampleDiscrete(-1, {{{equal}}}))"
        for number, weight in enumerate(weights, 1):
            yield weight.use, f"({chosen if number == 1 else kept} == {number} ? 1.0 : 0.0)"

    def _outcomes(self, cpp: Cpp, call: Call, count: int) -> tuple[str, ...]:
        if call.name[1] == "Bernoulli":
            return ("false", "true")
        first = call.arguments[0]
        name = cpp.text(first).strip()
        local = [
            enumerator.name
            for enumerator in cpp.declarations
            if enumerator.kind is DeclarationKind.ENUMERATOR and enumerator.type == name
        ]
        values = tuple(local) or self._enums.get(name, ())
        return (
            values if len(values) == count else tuple(f"outcome {number}" for number in range(1, count + 1))
        )

    def _skip(self, snippet: Snippet, call: Call, why: str) -> None:
        self.skipped.append(Skipped(snippet.at(call.extent.start), why))


def _code(text: str, span: Span) -> Snippet:
    return Snippet(text, (span,))


def _calls(cpp: Cpp) -> Iterator[Call]:
    """The draws whose outcomes can be counted; what is reported as a number is observed anyhow."""
    reported = [report.draw for report in reports_in(cpp)]
    for call in cpp.calls:
        is_draw = len(call.name) == 2 and call.name[0] in DRAW_SOURCES and call.name[1] in _KINDS
        if is_draw and call.arguments and call not in reported:
            yield call


def _weights(cpp: Cpp, call: Call) -> list[_Weight] | None:
    """The numbers of a draw; None where one of them is computed."""
    last = call.arguments[-1]
    text = strip_comments(cpp.code)[last.start : last.end]
    if call.name[1] == "Bernoulli":
        pieces = [(0, text)]
    elif text.lstrip().startswith("{") and text.rstrip().endswith("}"):
        begin, end = text.index("{") + 1, text.rindex("}")
        pieces, at = [], begin
        for piece in text[begin:end].split(","):
            pieces.append((at, piece))
            at += len(piece) + 1
    else:
        return None
    weights = [_weight(cpp, last.start + at, piece) for at, piece in pieces]
    return [weight for weight in weights if weight is not None] if all(weights) else None


def _weight(cpp: Cpp, start: int, text: str) -> _Weight | None:
    """A number, or a constant of the same code that is one."""
    use = Extent(start + len(text) - len(text.lstrip()), start + len(text.rstrip()))
    if _NUMBER.fullmatch(text.strip()):
        return _Weight(use, use)
    for declaration in cpp.declarations:
        if (
            declaration.name == text.strip()
            and declaration.initial is not None
            and declaration.type.startswith(("const ", "constexpr "))
        ):
            value = cpp.text(declaration.initial)
            return _Weight(use, declaration.initial) if _NUMBER.fullmatch(value) else None
    return None


def _is_repeated(code: str, offset: int) -> bool:
    """Returns whether one step may come more than once to what stands there."""
    place = len((_BEFORE + code[:offset]).encode())
    node = tree_of(f"{_BEFORE}{code}\n}}").descendant_for_byte_range(place, place)
    while node is not None:
        if node.type in _ENCLOSING:
            return True
        node = node.parent
    return False
