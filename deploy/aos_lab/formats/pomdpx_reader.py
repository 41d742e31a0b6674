"""Reads `.pomdpx`: POMDPs over variables, in the XML of the APPL planners.

Tables (`TBL`) and decision diagrams (`DD`), `*`, `-`, `identity` and `uniform`, several variables of every
kind, parents within the same step.
"""

from collections.abc import Iterable, Mapping

from aos_lab.formats.factored_model import FactoredModel, StateVariable
from aos_lab.formats.factors import Table, Variable
from aos_lab.formats.pomdpx_tables import read_table
from aos_lab.formats.problem_text import ProblemFindings
from aos_lab.formats.xml_text import Element, read_xml


def read_pomdpx(name: str, data: bytes) -> FactoredModel:
    """The model in a file; DocumentError with all findings, at their line and column, if it has mistakes."""
    text = data.decode("latin-1")
    findings = ProblemFindings(name, text)

    def read() -> FactoredModel | None:
        root = read_xml(data, findings)
        return _Reader(name, root, findings).model() if root is not None else None

    return findings.model_of(read)


class _Reader:
    def __init__(self, name: str, root: Element, findings: ProblemFindings) -> None:
        self._name = name
        self._root = root
        self._findings = findings

    def model(self) -> FactoredModel | None:
        if self._root.tag != "pomdpx":
            message = f"<{self._root.tag}> is no POMDP problem"
            self._findings.error("AOS107", message, self._root, "Expected <pomdpx>")
            return None
        variables = self._section("Variable")
        if variables is None:
            return None
        states = tuple(self._state(element) for element in variables.all("StateVar"))
        actions = tuple(self._plain(element, "a") for element in variables.all("ActionVar"))
        observations = tuple(self._plain(element, "o") for element in variables.all("ObsVar"))
        rewards = {e.attributes.get("vname", "") for e in variables.all("RewardVar")}
        for found, tag in ((states, "StateVar"), (actions, "ActionVar")):
            if not found:
                self._findings.error("AOS105", f"Variable has no {tag}", variables)
        if self._findings.has_any:
            return None  # Without its names and values nothing else can be told apart.
        before = {state.before.name: state.before for state in states}
        after = {state.after.name: state.after for state in states}
        chosen = {variable.name: variable for variable in actions}
        observed = {variable.name: variable for variable in observations}
        return FactoredModel(
            name=self._name,
            discount=self._discount(),
            states=states,
            actions=actions,
            observations=observations,
            initial=self._tables("InitialStateBelief", before, before),
            transitions=self._tables("StateTransitionFunction", after, chosen | before | after),
            sensing=self._tables("ObsFunction", observed, chosen | before | after | observed)
            if observed
            else (),
            rewards=self._rewards(rewards, chosen | before | after | observed),
        )

    def _section(self, tag: str) -> Element | None:
        element = self._root.first(tag)
        if element is None:
            self._findings.error("AOS105", f"there is no {tag}", self._root)
        return element

    def _discount(self) -> float:
        element = self._section("Discount")
        if element is None:
            return 0.0
        words = element.words()
        try:
            discount = float(words[0].text)
        except (IndexError, ValueError):
            discount = -1.0
        if not 0 <= discount <= 1:
            where = words[0] if words else element
            self._findings.error("AOS106", "Discount needs a number from 0 to 1", where)
        return discount

    def _state(self, element: Element) -> StateVariable:
        names = [element.attributes.get(key, "") for key in ("vnamePrev", "vnameCurr")]
        if not all(names):
            self._findings.error("AOS105", "StateVar needs vnamePrev and vnameCurr", element)
        values = self._values(element, "s")
        seen = element.attributes.get("fullyObs", "false").strip().lower()
        if seen not in ("true", "false"):
            self._findings.error("AOS106", f"fullyObs is true or false, not {seen}", element)
        before = Variable(names[0], values, element.line)
        return StateVariable(before, Variable(names[1], values, element.line, names[0]), seen == "true")

    def _plain(self, element: Element, letter: str) -> Variable:
        return Variable(self._name_of(element), self._values(element, letter), element.line)

    def _name_of(self, element: Element) -> str:
        name = element.attributes.get("vname", "")
        if not name:
            self._findings.error("AOS105", f"{element.tag} needs vname", element)
        return name

    def _values(self, element: Element, letter: str) -> tuple[str, ...]:
        """The names of a variable's values; numbered ones are called by a letter and their number."""
        listed, counted = element.first("ValueEnum"), element.first("NumValues")
        if listed is not None:
            words = listed.words()
            values = tuple(word.text.rstrip(",") or word.text for word in words)
            for place, word in enumerate(words):
                if word.text in values[:place]:
                    self._findings.error("AOS103", f"{word.text} is there twice", word)
                if word.text != values[place]:
                    message = f"{word.text} has a comma"
                    self._findings.error("AOS102", message, word, "Names stand between blanks")
            if values:
                return values
        elif counted is not None:
            words = counted.words()
            count = words[0].count if len(words) == 1 else None
            if count is not None and 0 < count <= 10_000_000:
                return tuple(f"{letter}{number}" for number in range(count))
        where = listed or counted or element
        self._findings.error(
            "AOS105",
            f"{element.tag} has no values",
            where,
            "Write them as ValueEnum, or how many as NumValues",
        )
        return ("",)

    def _tables(
        self, section: str, wanted: Mapping[str, Variable], known: Mapping[str, Variable]
    ) -> tuple[Table, ...]:
        """The conditional probabilities of a section, one for each of the `wanted` variables."""
        element = self._section(section)
        if element is None:
            return ()
        tables: dict[str, Table] = {}
        has_broken = False
        for conditional in element.all("CondProb"):
            variables = self._variables(conditional, wanted, known)
            has_broken = has_broken or variables is None
            if variables is not None:
                table = read_table(conditional, variables, True, self._findings)
                if table.own in tables:
                    message = f"a second CondProb of {table.own}"
                    self._findings.error("AOS103", message, conditional)
                tables[table.own] = table
        for name in wanted.keys() - tables.keys() if not has_broken else ():
            self._findings.error("AOS105", f"{section} says nothing about {name}", element)
        return tuple(tables.values())

    def _rewards(self, names: Iterable[str], known: Mapping[str, Variable]) -> tuple[Table, ...]:
        element = self._section("RewardFunction")
        if element is None:
            return ()
        targets = {name: Variable(name, ()) for name in names}
        tables = []
        for function in element.all("Func"):
            variables = self._variables(function, targets, known)
            if variables is not None:
                tables.append(read_table(function, variables[:-1], False, self._findings))
        return tuple(tables)

    def _variables(
        self, element: Element, wanted: Mapping[str, Variable], known: Mapping[str, Variable]
    ) -> list[Variable] | None:
        """The parents and the variable itself; None, with a finding, if one of them does not exist."""
        own, parents = element.first("Var"), element.first("Parent")
        words = own.words() if own is not None else []
        if len(words) != 1:
            self._findings.error("AOS105", f"{element.tag} needs one Var", element)
            return None
        if words[0].text not in wanted:
            self._findings.unknown("variable here called", words[0], wanted)
            return None
        found: list[Variable] = []
        for word in parents.words() if parents is not None else []:
            if word.text == "null":
                continue
            if word.text not in known or word.text == words[0].text:
                self._findings.unknown("parent here called", word, known)
                return None
            found.append(known[word.text])
        return [*found, wanted[words[0].text]]
