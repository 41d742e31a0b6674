"""Which state variables matter to nobody: no reward, observation or ending depends on them.

Documents keep in the state what the robot has learnt, for their rollout policies, and what people like to
see. A model without these variables earns and shows the same with the same probabilities, so planners need
not tell states apart by them. This is a cone of influence: it follows from the text of the code that a step
runs, and where the text leaves a doubt the variable matters.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from aos_protocol.documents import Assignment, Environment, Project
from aos_runtime.cpp_flow import STATES, Flow, Name, flows_of
from aos_runtime.document_code import snippets_of
from aos_runtime.snippets import read_cpp, read_cpp_expression

__all__ = ["irrelevant_variables"]


def irrelevant_variables(project: Project) -> frozenset[str]:
    """The names of the state variables without influence on anything that is earned or observed."""
    environment = project.environment
    variables = frozenset(variable.name for variable in environment.variables)
    reading = _Influence(environment)
    for code in _sections(project):
        reading.read(code)
    return variables - reading.relevant()


def _sections(project: Project) -> Iterator[tuple[Assignment, ...]]:
    """The code that decides on rewards, observations and states: no rollout policies, heuristics and prints.

    What is told about a state by a real observation corrects beliefs, which hold all variables.
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
    """What may depend on what. Names of other variables are those of one section, numbered."""

    def __init__(self, environment: Environment) -> None:
        self._variables = frozenset(variable.name for variable in environment.variables)
        self._types = {variable.name: variable.type for variable in environment.variables}
        self._sources: dict[tuple[int, Name], set[tuple[int, Name]]] = {}
        self._used: set[tuple[int, Name]] = set()
        self._section = 0
        for special in environment.special_states:
            if special.condition is not None:
                self._use_all_mentioned(special.condition.code)
        for variable in environment.variables:
            if variable.default_code is not None:
                self._read_snippet(variable.default_code.code)
                self._section += 1

    def read(self, assignments: tuple[Assignment, ...]) -> None:
        """Takes in a section, of which the snippets share their names."""
        self._section += 1
        for assignment in assignments:
            for loop in (*assignment.over_previous, *assignment.over_next):
                # The item may be any variable of its type.
                self._use(Name(name, is_of_state=True) for name in self._of_type(loop.type))
                if loop.condition is not None:
                    self._use_all_mentioned(loop.condition.code)
        for snippet, _ in snippets_of(assignments):
            self._read_snippet(snippet.code)

    def relevant(self) -> set[str]:
        """The variables from which a chain of flows leads to what is used."""
        found = set(self._used)
        waiting = list(found)
        while waiting:
            for source in self._sources.get(waiting.pop(), ()):
                if source not in found:
                    found.add(source)
                    waiting.append(source)
        return {name.text for _, name in found if name.is_of_state}

    # --- one snippet -----------------------------------------------------------------------------------

    def _read_snippet(self, code: str) -> None:
        flows = flows_of(read_cpp(code))
        if flows.is_opaque:
            self._use(Name(name, is_of_state=True) for name in self._variables)
        self._use(flows.used)
        for flow in flows.flows:
            self._add(flow)

    def _add(self, flow: Flow) -> None:
        if not flow.target.is_of_state and flow.target.text.startswith("__"):
            self._use(flow.sources)
            return
        targets = self._places([flow.target])
        for target in targets:
            self._sources.setdefault(target, set()).update(self._places(flow.sources))

    def _use_all_mentioned(self, code: str) -> None:
        cpp = read_cpp_expression(code)
        if cpp.faults:
            self._use(Name(name, is_of_state=True) for name in self._variables)
        for mention in cpp.mentions:
            if mention.path[0] in STATES:
                self._use([Name(mention.path[1] if len(mention.path) > 1 else "", is_of_state=True)])

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
                places |= {(0, Name(variable, is_of_state=True)) for variable in self._variables}
        return places

    def _of_type(self, type_name: str) -> list[str]:
        return [name for name, its_type in self._types.items() if its_type == type_name]
