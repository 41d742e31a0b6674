"""The state variables without influence: on anything, or on anything but what is observed.

Some state variables matter to nobody: no reward, observation or ending depends on them. Documents keep in
the state what the robot has learnt, for their rollout policies, and what people like to see. A model without
these variables earns and shows the same with the same probabilities, so planners need not tell states apart
by them.

Some draws shape only what is observed, such as the noise of a sensor. So do the parameters of some skills,
such as which place a camera looks at. The reward of a skill without other draws is certain.

All are cones of influence: they follow from the text of the code that a step runs, and where the text leaves
a doubt a variable or a draw matters.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from aos_language.cpp.flow import Flow, Flows, Locals, Name, flows_of
from aos_language.cpp.keywords import STATES
from aos_language.cpp.shared import SharedCode, SharedFunction
from aos_language.cpp.snippets import Cpp, Extent, read_cpp, read_cpp_expression
from aos_language.document_code import shared_code_of, snippets_of
from aos_language.observed import is_draw
from aos_protocol.documents import Assignment, Environment, Project, Snippet

_OBSERVATION = frozenset({"__moduleResponse", "__moduleResponseStr", "__observed"})
_WITHOUT_DRAW = frozenset({"Initialize", "IsInitialized", "SetNull", "Uninitialize"})


def irrelevant_variables(project: Project) -> frozenset[str]:
    """The names of the state variables without influence on anything that is earned or observed."""
    environment = project.environment
    variables = frozenset(variable.name for variable in environment.variables)
    reading = _Influence(environment)
    for code in _sections(project):
        reading.read(code)
    for constraint in project.constraints:
        if constraint.cost:
            reading.use_expression(constraint.never.code)
    return variables - reading.relevant()


def sensing_draws(project: Project) -> Mapping[Snippet, frozenset[int]]:
    """The draws of dynamic models that shape only what is observed, by where their calls start.

    Whatever such a draw gives, the step leads to the same state as far as its variables matter, with the same
    reward, and every loop runs as often. So successors can be listed where observations are too many to list.
    """
    reading, sections = _read_without_observations(project)
    influential = reading.influential()
    dynamic_models = [skill.model.dynamic_model for skill in project.skills]
    found: dict[Snippet, frozenset[int]] = {}
    for section, code in sections:
        if not any(code is model for model in dynamic_models):
            continue
        for snippet, cpp in snippets_of(code):
            calls = sorted(call.function.start for call in cpp.calls if is_draw(call))
            draws = reading.flows(cpp).draws
            if len(calls) == len(draws):
                shaping = {
                    at for at, draw in zip(calls, draws, strict=True) if (section, draw) not in influential
                }
                found[snippet] = found.get(snippet, frozenset(shaping)) & shaping
    return found


def certain_rewards(project: Project, sensing: Mapping[Snippet, frozenset[int]]) -> frozenset[str]:
    """The skills whose reward follows from state and parameters: all their draws are `sensing_draws`."""
    environment = project.environment
    around = [*snippets_of(environment.extrinsic_changes)]
    for special in environment.special_states:
        around += snippets_of(special.code)
        if special.condition is not None:
            around.append((special.condition, read_cpp_expression(special.condition.code)))
    drawing = shared_code_of(environment).drawing
    if _is_opaque(project) or _draws_of(around, drawing):
        return frozenset()
    certain = set()
    for skill in project.skills:
        parts = (skill.model.precondition, skill.model.execution_time, skill.model.dynamic_model)
        draws = [draw for code in parts for draw in _draws_of(snippets_of(code), drawing)]
        if all(start in sensing.get(snippet, ()) for snippet, start in draws):
            certain.add(skill.name)
    return frozenset(certain)


def skills_alike(project: Project) -> frozenset[str]:
    """The skills whose parameters shape only what is observed.

    From a state, all grounded actions of such a skill lead to the same states with the same rewards.
    """
    environment = project.environment
    asked_for = {
        mention.path[0] for _, cpp in snippets_of(environment.extrinsic_changes) for mention in cpp.mentions
    }
    if _is_opaque(project):
        return frozenset()
    reading, sections = _read_without_observations(project)
    influential = reading.influential()
    alike = set()
    for skill in project.skills:
        parts = (skill.model.precondition, skill.model.execution_time, skill.model.dynamic_model)
        names = [
            (section, Name(parameter.name))
            for section, code in sections
            for parameter in skill.model.parameters
            if any(code is part for part in parts)
        ]
        if names and skill.name not in asked_for and influential.isdisjoint(names):
            alike.add(skill.name)
    return frozenset(alike)


def _read_without_observations(
    project: Project,
) -> tuple[_Influence, list[tuple[int, tuple[Assignment, ...]]]]:
    """Reads what influences rewards, endings, loops and variables that matter; returns it and the sections
    with their numbers."""
    variables = frozenset(variable.name for variable in project.environment.variables)
    reading = _Influence(project.environment, observations_matter=False)
    reading.use_variables(variables - irrelevant_variables(project))
    return reading, [(reading.read(code), code) for code in _sections(project)]


def _is_opaque(project: Project) -> bool:
    """Returns whether some code hides what flows where."""
    snippets = (snippet for code in _sections(project) for snippet, _ in snippets_of(code))
    return any(flows_of(read_cpp(snippet.code)).is_opaque for snippet in snippets)


def _draws_of(snippets: Iterable[tuple[Snippet, Cpp]], drawing: frozenset[str]) -> list[tuple[Snippet, int]]:
    """The uses of the source of draws, also under another name, and those of `drawing` functions, each by its
    snippet and its start."""
    return [
        (snippet, mention.root.start)
        for snippet, cpp in snippets
        for mention in cpp.mentions
        if mention.path[0] in {"AOS", "AOSUtils"} | drawing and mention.method not in _WITHOUT_DRAW
    ]


def _sections(project: Project) -> Iterator[tuple[Assignment, ...]]:
    """The code that decides on rewards, observations and states: no rollout policies, heuristics and prints.

    What a real observation tells about a state corrects beliefs, which hold all variables.
    """
    environment = project.environment
    yield environment.initial_belief
    yield environment.extrinsic_changes
    for special in environment.special_states:
        yield special.code
    for skill in project.skills:
        yield skill.model.precondition
        yield skill.model.execution_time
        yield skill.model.dynamic_model


class _Influence:
    """The dependences between names. Names of other variables are those of one section, numbered."""

    def __init__(self, environment: Environment, *, observations_matter: bool = True) -> None:
        self._observations_matter = observations_matter
        self._shared = shared_code_of(environment)
        self._variables = frozenset(variable.name for variable in environment.variables)
        self._compounds = frozenset(compound.name for compound in environment.compounds)
        self._types = {variable.name: variable.type for variable in environment.variables}
        self._sources: dict[tuple[int, Name], set[tuple[int, Name]]] = {}
        self._used: set[tuple[int, Name]] = set()
        self._section = 0
        self._local = Locals()
        for special in environment.special_states:
            if special.condition is not None:
                self.use_expression(special.condition.code)
        for variable in environment.variables:
            if variable.default_code is not None:
                self._read_snippet(variable.default_code.code)
                self._section += 1

    def use_variables(self, names: Iterable[str]) -> None:
        """Variables of the state that matter in any case."""
        self._use(Name(name, is_of_state=True) for name in names)

    def read(self, assignments: tuple[Assignment, ...]) -> int:
        """Takes in a section, of which the snippets share their names; gives its number."""
        self._section += 1
        self._local = Locals()
        for assignment in assignments:
            for loop in (*assignment.over_previous, *assignment.over_next):
                # The item may be any variable of its type, so that what it is set to matters, too.
                self._use([Name(loop.item)])
                self._use(Name(name, is_of_state=True) for name in self._of_type(loop.type))
                if loop.condition is not None:
                    self.use_expression(loop.condition.code)
        for snippet, _ in snippets_of(assignments):
            self._read_snippet(snippet.code)
        return self._section

    def relevant(self) -> set[str]:
        """The variables from which a chain of flows leads to what is used."""
        return {name.text for _, name in self.influential() if name.is_of_state}

    def influential(self) -> set[tuple[int, Name]]:
        """All names from which a chain of flows leads to what is used, each with its section."""
        found = set(self._used)
        waiting = list(found)
        while waiting:
            for source in self._sources.get(waiting.pop(), ()):
                if source not in found:
                    found.add(source)
                    waiting.append(source)
        return found

    def flows(self, cpp: Cpp) -> Flows:
        """Returns what flows where in a snippet; shared functions that only read are looked through."""
        shared = self._shared
        return flows_of(read_cpp(looked_through(cpp, shared)), shared.reading, shared.all_names, self._local)

    # --- one snippet ---

    def _read_snippet(self, code: str) -> None:
        flows = self.flows(read_cpp(code))
        if flows.is_opaque:
            self._use(Name(name, is_of_state=True) for name in self._variables)
        self._use(flows.used)
        if not self._observations_matter:
            self._use(flows.looped)
        for flow in flows.flows:
            self._add(flow)

    def _add(self, flow: Flow) -> None:
        is_result = not flow.target.is_of_state and flow.target.text.startswith("__")
        if is_result and (self._observations_matter or flow.target.text not in _OBSERVATION):
            self._use(flow.sources)
            return
        targets = self._places([flow.target])
        for target in targets:
            self._sources.setdefault(target, set()).update(self._places(flow.sources))

    def use_expression(self, code: str) -> None:
        """All that an expression mentions and draws matters."""
        cpp = read_cpp_expression(looked_through(read_cpp_expression(code), self._shared))
        if cpp.faults:
            self._use(Name(name, is_of_state=True) for name in self._variables)
        for mention in cpp.mentions:
            if mention.path[0] in STATES:
                self._use([Name(mention.path[1] if len(mention.path) > 1 else "", is_of_state=True)])
            else:
                self._use([Name(mention.path[0])])
        self._use(self.flows(read_cpp_expression(code)).draws)

    def _use(self, names: Iterable[Name]) -> None:
        self._used.update(self._places(names))

    def _places(self, names: Iterable[Name]) -> set[tuple[int, Name]]:
        """The variables of the state are the same in all sections; the whole state is all of them."""
        places: set[tuple[int, Name]] = set()
        for name in names:
            if not name.is_of_state:
                places.add((self._section, name))
            elif name.text in self._variables:
                places.add((0, name))
            else:
                listed = name.text.removesuffix("Objects") if name.text.endswith("Objects") else ""
                variables = self._of_type(listed) if listed in self._compounds else self._variables
                places |= {(0, Name(variable, is_of_state=True)) for variable in variables}
        return places

    def _of_type(self, type_name: str) -> list[str]:
        return [name for name, its_type in self._types.items() if its_type == type_name]


def looked_through(cpp: Cpp, shared: SharedCode) -> str:
    """The code with the whole state, as an argument of a function that only reads, replaced by what it reads.

    `holds(state, item)` becomes `holds((state.at + state.size), item)`: for readings of the text alone.
    """
    own = cpp.declared
    edits: dict[Extent, str] = {}
    for call in cpp.calls:
        functions = [
            function
            for function in shared.functions
            if call.name == (function.name,) and function.name not in own
        ]
        for index, argument in enumerate(call.arguments if functions else ()):
            state = cpp.text(argument)
            read = [
                _members(function, index, shared) for function in functions if function.name in shared.reading
            ]
            if state in STATES and len(read) == len(functions) and None not in read:
                names = sorted(set().union(*(members or () for members in read)))
                edits[argument] = f"({' + '.join(f'{state}.{name}' for name in names) or '0'})"
    return cpp.replace(edits.items()) if edits else cpp.code


def _members(function: SharedFunction, index: int, shared: SharedCode) -> set[str] | None:
    """The members of a parameter that the function uses; None where it uses the parameter as a whole."""
    name = function.takes[index] if index < len(function.takes) else ""
    declared = {declaration.extent.start for declaration in shared.cpp.declarations}
    uses = [
        mention
        for mention in shared.cpp.mentions
        if mention.path[0] == name
        and function.extent.start <= mention.extent.start < function.extent.end
        and mention.root.start not in declared
    ]
    if not name or any(len(mention.path) == 1 for mention in uses):
        return None
    return {mention.path[1] for mention in uses}
