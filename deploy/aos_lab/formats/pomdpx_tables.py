"""The tables and decision diagrams of a `.pomdpx` file, as entries over its variables."""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from aos_lab.formats.factors import ANY, EACH, Entry, Table, Variable
from aos_lab.formats.problem_text import ProblemFindings, Word, advice_on_number
from aos_lab.formats.xml_text import Element
from aos_language.number_text import is_number
from aos_protocol.spelling import did_you_mean
from aos_solver.offline.explicit_model import Floats


def read_table(
    element: Element, variables: Sequence[Variable], is_distribution: bool, findings: ProblemFindings
) -> Table:
    """The table of a `CondProb` or `Func` whose variables are known; mistakes are findings."""
    table = Table(tuple(variables), [], is_distribution, f"{element.line}:{element.column}")
    parameter = element.first("Parameter")
    if parameter is None:
        findings.error("AOS105", f"{element.tag} has no Parameter", element)
        return table
    kind = parameter.attributes.get("type", "TBL")
    if kind == "TBL":
        for entry in parameter.all("Entry"):
            _read_entry(entry, table, findings)
    elif kind == "DD":
        _Diagram(parameter, table, findings).read()
    else:
        findings.error("AOS106", f"{kind} is no type of Parameter", parameter, "Write TBL or DD")
    return table


def _read_entry(element: Element, table: Table, findings: ProblemFindings) -> None:
    instance = element.first("Instance")
    numbers = element.first("ProbTable" if table.is_distribution else "ValueTable")
    if instance is None or numbers is None:
        wanted = "ProbTable" if table.is_distribution else "ValueTable"
        findings.error("AOS105", f"Entry needs Instance and {wanted}", element)
        return
    words = instance.words()
    if len(words) != len(table.variables):
        names = " ".join(variable.name for variable in table.variables)
        message = f"the Instance has {len(words)} values for {len(table.variables)} variables"
        findings.error("AOS106", message, instance, f"They are: {names}")
        return
    pattern = tuple(
        _choice(word, variable, findings) for word, variable in zip(words, table.variables, strict=True)
    )
    sizes = [len(v.values) for v, choice in zip(table.variables, pattern, strict=True) if choice == EACH]
    cells = _cells(numbers, sizes, table, findings)
    if cells is not None:
        table.entries.append(Entry(pattern, cells))


def _choice(word: Word, variable: Variable, findings: ProblemFindings) -> int:
    if word.text == "*":
        return ANY
    if word.text == "-":
        return EACH
    number = variable.numbers.get(word.text)
    if number is not None:
        return number
    findings.unknown(f"value of {variable.name} called", word, variable.values)
    return ANY


def _cells(element: Element, sizes: list[int], table: Table, findings: ProblemFindings) -> Floats | None:
    words = element.words()
    keyword = words[0].text if len(words) == 1 else ""
    if keyword == "uniform":
        return np.full(sizes, 1 / len(table.variables[-1].values))
    if keyword == "identity":
        if len(sizes) != 2 or sizes[0] != sizes[1]:
            message = "identity needs two `-` of as many values in the Instance"
            findings.error("AOS106", message, words[0])
            return None
        return np.eye(sizes[0])
    try:
        numbers = np.array([word.text for word in words], dtype=float)
    except ValueError:
        wrong = next(word for word in words if not is_number(word.text))
        hint = did_you_mean(wrong.text, ("identity", "uniform")) or advice_on_number(wrong.text)
        findings.error("AOS106", f"{wrong.text} is not a number", wrong, hint)
        return None
    wanted = int(np.prod(sizes, dtype=int))
    if len(numbers) != wanted:
        findings.error("AOS106", f"{len(numbers)} numbers where the Instance asks for {wanted}", element)
        return None
    if table.is_distribution and (numbers.min(initial=0) < 0 or numbers.max(initial=0) > 1 + 1e-9):
        wrong = next(word for word in words if not 0 <= float(word.text) <= 1 + 1e-9)
        findings.error("AOS122", f"{wrong.text} is no probability", wrong)
        return None
    if not np.isfinite(numbers).all():
        wrong = next(word for word in words if not np.isfinite(float(word.text)))
        findings.error("AOS106", f"{wrong.text} is not a finite number", wrong)
        return None
    return numbers.reshape(sizes)


class _Diagram:
    """A decision diagram: every way to a number becomes an entry."""

    def __init__(self, parameter: Element, table: Table, findings: ProblemFindings) -> None:
        self._parameter = parameter
        self._table = table
        self._findings = findings
        self._places = {variable.name: place for place, variable in enumerate(table.variables)}
        self._templates = {
            template.attributes.get("id", ""): template for template in parameter.all("SubDAGTemplate")
        }

    def read(self) -> None:
        dag = self._parameter.first("DAG")
        if dag is None:
            self._findings.error("AOS105", "a Parameter of type DD needs a DAG", self._parameter)
            return
        for chosen, number in self._ways(dag, {}, 0):
            pattern = tuple(chosen.get(place, ANY) for place in range(len(self._table.variables)))
            self._table.entries.append(Entry(pattern, np.array(number)))

    def _ways(
        self, parent: Element, chosen: dict[int, int], depth: int
    ) -> Iterator[tuple[dict[int, int], float]]:
        """All assignments below an element, each with its number."""
        if depth > len(self._table.variables) + len(self._templates) + 1:
            self._findings.error("AOS106", "the diagram refers to itself", parent)
            return
        for element in parent.children:
            if element.tag == "Node":
                yield from self._node(element, chosen, depth)
            elif element.tag == "Terminal":
                words = element.words()
                if len(words) == 1 and is_number(words[0].text):
                    yield chosen, float(words[0].text)
                else:
                    hint = advice_on_number("".join(word.text for word in words))
                    self._findings.error("AOS106", "Terminal needs a number", element, hint)
            elif element.tag == "SubDAG":
                yield from self._sub_diagram(element, chosen, depth)

    def _node(
        self, element: Element, chosen: dict[int, int], depth: int
    ) -> Iterator[tuple[dict[int, int], float]]:
        place = self._place(element)
        if place is None:
            return
        for edge in element.all("Edge"):
            word = Word(edge.attributes.get("val", ""), edge.line, edge.column)
            value = max(_choice(word, self._table.variables[place], self._findings), ANY)
            yield from self._ways(edge, {**chosen, place: value}, depth + 1)

    def _sub_diagram(
        self, element: Element, chosen: dict[int, int], depth: int
    ) -> Iterator[tuple[dict[int, int], float]]:
        kind = element.attributes.get("type", "")
        if kind == "template":
            template = self._templates.get(element.attributes.get("idref", ""))
            if template is None:
                name = element.attributes.get("idref", "")
                message = f"there is no SubDAGTemplate {name}" if name else "a template needs idref"
                self._findings.error("AOS110", message, element, did_you_mean(name, self._templates))
                return
            yield from self._ways(template, chosen, depth + 1)
            return
        own = len(self._table.variables) - 1
        values = self._table.variables[own].values
        if kind == "uniform":
            yield chosen, 1 / len(values)
        elif kind == "deterministic":
            word = Word(element.attributes.get("val", ""), element.line, element.column)
            yield {**chosen, own: _choice(word, self._table.variables[own], self._findings)}, 1.0
        elif kind == "persistent":
            parents = self._table.variables[:-1]
            before = [v for v in parents if v.name == self._table.variables[own].earlier] or [
                v for v in parents if v.values == values
            ]
            if len(before) != 1:
                self._findings.error("AOS106", "persistent needs one parent with the same values", element)
                return
            place = self._places[before[0].name]
            known = chosen.get(place, ANY)
            ways = range(len(values)) if known == ANY else (known,)
            for value, after in itertools.product(ways, range(len(values))):
                yield {**chosen, place: value, own: after}, float(value == after)
        else:
            hint = did_you_mean(kind, ("deterministic", "persistent", "template", "uniform"))
            self._findings.error("AOS106", f"{kind} is no type of SubDAG", element, hint)

    def _place(self, element: Element) -> int | None:
        name = element.attributes.get("var", "")
        if name not in self._places:
            word = Word(name, element.line, element.column)
            self._findings.unknown("variable here called", word, self._places)
            return None
        return self._places[name]
