"""Ways in which C++ takes a value from one variable to another.

Documents are made of them whose variables matter only along a chain. Whoever decides by the text of code
which variables matter has to follow every one.

A register is a state variable of some type that holds 0 or 1.
"""

import dataclasses
from collections.abc import Callable

KINDS = ("int", "bool", "enum", "field", "array", "double", "string")


@dataclasses.dataclass(frozen=True)
class Register:
    """A state variable, by its name and its kind."""

    name: str
    kind: str

    def declaration(self) -> str:
        kind = {"enum": "Light", "field": "Box"}.get(self.kind, self.kind)
        if self.kind == "array":
            return f"state_variable: int {self.name} []\ncode:\nstate.{self.name} = {{0, 0, 0}};\n"
        default = {"enum": "Off", "bool": "false", "string": '"off"', "field": ""}.get(self.kind, "0")
        code = f"code:\nstate.{self.name} = {default};\n" if default else ""
        return f"state_variable: {kind} {self.name}\n{code}"

    def read(self, state: str) -> str:
        """An expression for its value as a number."""
        place = self.place(state)
        return {
            "bool": f"({place} ? 1 : 0)",
            "enum": f"({place} == On ? 1 : 0)",
            "string": f'({place} == "on" ? 1 : 0)',
            "double": f"static_cast<int>({place})",
        }.get(self.kind, place)

    def write(self, state: str, value: str) -> str:
        place = self.place(state)
        return {
            "bool": f"{place} = ({value}) != 0;",
            "enum": f"{place} = ({value}) != 0 ? On : Off;",
            "string": f'if (({value}) != 0) {{ {place} = "on"; }} else {{ {place} = "off"; }}',
        }.get(self.kind, f"{place} = {value};")

    def place(self, state: str) -> str:
        """Returns the text that stands for it in code."""
        return f"{state}.{self.name}" + {"field": ".level", "array": "[1]"}.get(self.kind, "")

    @property
    def is_number(self) -> bool:
        return self.kind in ("int", "field", "array", "double")

    def is_a(self, kind: str) -> bool:
        """Tells whether it is of this kind; `number` is any number, and "" anything."""
        return self.is_number if kind == "number" else kind in ("", self.kind)


Idiom = Callable[[Register, Register, str], str | None]
"""Code that takes the first's value to the second in the named state; None where it does not fit."""

IDIOMS: dict[str, Idiom] = {}


def _text(name: str, code: str, *, source: str = "", target: str = "", alike: bool = False):
    """An idiom as a template: READ a number, WRITE(...) a statement, PLACE and FROM places.

    It is for registers of these kinds: `number` is any number, and "" anything. If they are `alike`, both are
    of one kind.
    """
    from_kind, to_kind = source, target

    def fill(source: Register, target: Register, state: str) -> str | None:
        if not (source.is_a(from_kind) and target.is_a(to_kind)) or (alike and source.kind != target.kind):
            return None
        filled = code.replace("READ", source.read("state")).replace("FROM", source.place("state"))
        filled = filled.replace("PLACE", target.place(state)).replace("NEXT", f"{state}.{target.name}")
        filled = filled.replace("NOW", f"state.{source.name}").replace("INTO", state)
        filled = filled.replace("TARGET", target.name).replace("SOURCE", source.name)
        while "WRITE(" in filled:
            before, _, after = filled.partition("WRITE(")
            value, _, rest = _closed(after)
            filled = before + target.write(state, value) + rest
        return filled

    IDIOMS[name] = fill


def _closed(text: str) -> tuple[str, str, str]:
    depth = 1
    for place, character in enumerate(text):
        depth += {"(": 1, ")": -1}.get(character, 0)
        if depth == 0:
            return text[:place], ")", text[place + 1 :].removeprefix(";")
    raise ValueError(text)


_text("plain", "WRITE(READ);")
_text("local", "{ int v = READ; WRITE(v); }")
_text("two_locals", "{ int v = READ; int w; w = v; WRITE(w); }")
_text("if_else", "if (READ == 1) { WRITE(1); } else { WRITE(0); }")
_text("if_alone", "{ WRITE(0); if (READ == 1) { WRITE(1); } }")
_text("nested_if", "{ int v = 0; if (READ == 1) { if (true) { v = 1; } } WRITE(v); }")
_text("ternary", "WRITE(READ == 1 ? 1 : 0);")
_text("switch", "switch (READ) { case 0: { WRITE(0); break; } default: { WRITE(1); } }")
_text("for_loop", "{ int n = 0; for (int i = 0; i < READ; i++) n++; WRITE(n); }")
_text("while_break", "{ int n = 0; while (true) { if (n >= READ) break; n++; } WRITE(n); }")
_text("do_while", "{ int n = -1; do { n++; } while (n < READ); WRITE(n); }")
_text("continue", "{ int n = 0; for (int i = 0; i < 1; i++) { if (READ == 0) continue; n = 1; } WRITE(n); }")
_text("short_circuit", "{ int v = 0; bool ok = READ == 1 && (v = 1) == 1; WRITE(v); }")
_text("comma", "{ int v = 0; v = 0, v = READ; WRITE(v); }")
_text("lambda_write", "{ auto put = [&](int v) { WRITE(v); }; put(READ); }")
_text("lambda_read", "{ auto get = [&] { return READ; }; WRITE(get()); }")
_text("lambda_value", "{ auto get = [v = READ] { return v; }; WRITE(get()); }")
_text("function", "{ std::function<int()> get = [&] { return READ; }; WRITE(get()); }")
_text("table", "{ std::vector<int> table = {0, 1}; WRITE(table[READ]); }")
_text("table_write", "{ std::vector<int> table = {0, 0}; table[READ] = 1; WRITE(table[1]); }")
_text(
    "push_back",
    "{ std::vector<int> items; if (READ == 1) items.push_back(1); WRITE(static_cast<int>(items.size())); }",
)
_text("map", "{ std::map<int, int> m; m[READ] = 1; WRITE(static_cast<int>(m.count(1))); }")
_text("maximum", "WRITE(std::max(0, static_cast<int>(READ)));")
_text("draw", "WRITE(AOS.Bernoulli(READ) ? 1 : 0);")
_text(
    "draw_weights",
    "{ std::vector<double> odds = {1.0 - READ, 1.0 * READ}; WRITE(AOSUtils::SampleDiscrete(odds)); }",
)
_text("tuple", "{ auto pair = std::make_pair(READ, 2); WRITE(pair.first); }")
_text("binding", "{ auto [one, other] = std::make_pair(READ, 2); WRITE(one); }")
_text("text", '{ std::string s = READ == 1 ? "one" : "none"; WRITE(s.size() == 3 ? 1 : 0); }')
_text("bits", "WRITE((READ << 1 | 0) >> 1 & 1);")
_text("try_catch", "try { if (READ == 1) throw 1; WRITE(0); } catch (int v) { WRITE(v); }")
_text("alias_now", "{ const auto& now = state; int v = READ; WRITE(v); }")
_text(
    "reference_from",
    "{ const auto& from = FROM; int v = static_cast<int>(from); WRITE(v); }",
    source="number",
)
_text(
    "pointer_from",
    "{ const auto* from = &FROM; int v = static_cast<int>(*from); WRITE(v); }",
    source="number",
)
_text(
    "whole_copy",
    "{ const auto before = NOW; int v = static_cast<int>(before.level); WRITE(v); }",
    source="field",
)
_text("reference_to", "{ auto& to = PLACE; to = READ; }", target="number")
_text("pointer_to", "{ auto* to = &PLACE; *to = READ; }", target="number")
_text(
    "pointer_chosen",
    "{ int other = 0; auto* to = &other; auto* real = &PLACE; *real = READ; *to = 1; }",
    target="number",
)
_text("add", "{ PLACE = 0; PLACE += READ; }", target="number")
_text("increment", "{ PLACE = 0; if (READ == 1) PLACE++; }", target="number")
_text("swap", "{ auto v = PLACE; v = READ; std::swap(PLACE, v); }", target="number")
_text("tie", "{ int rest; std::tie(PLACE, rest) = std::make_tuple(READ, 3); }", target="number")
_text("assign_through_choice", "{ int other = 0; (true ? PLACE : other) = READ; }", target="int")
_text("compound", "NEXT = NOW;", source="field", target="field")
_text("compound_reference", "{ auto& box = NEXT; box.level = READ; }", target="field")
_text("compound_pointer", "{ auto* box = &NEXT; box->level = READ; }", target="field")
_text("array_copy", "NEXT = NOW;", source="array", target="array")
_text("range_for", "{ int n = 0; for (const auto& item : NOW) n += item; WRITE(n); }", source="array")
_text(
    "range_for_write",
    "{ int i = 0; for (auto& item : NEXT) { item = i == 1 ? READ : 0; i++; } }",
    target="array",
)
_text("index_loop", "{ int n = 0; for (int i = 0; i < 3; i++) n += NOW[i]; WRITE(n); }", source="array")
_text("accumulate", "WRITE(std::accumulate(NOW.begin(), NOW.end(), 0));", source="array")
_text("copy", "std::copy(NOW.begin(), NOW.end(), NEXT.begin());", source="array", target="array")
_text("fill", "std::fill(NEXT.begin() + 1, NEXT.begin() + 2, READ);", target="array")
_text("find", "WRITE(std::find(NOW.begin(), NOW.end(), 1) != NOW.end() ? 1 : 0);", source="array")
_text(
    "sort",
    "{ std::vector<int> v(NOW.begin(), NOW.end()); std::sort(v.begin(), v.end()); WRITE(v[2]); }",
    source="array",
)
_text("bytes", "std::memcpy(&PLACE, &FROM, sizeof FROM);", source="number", alike=True)
_text("alias_next", "{ auto& next = INTO; next.TARGET = READ; }", target="int")
_text(
    "alias_both",
    "{ auto& now = state; auto& next = INTO; next.TARGET = now.SOURCE; }",
    source="int",
    target="int",
)
_text("pointer_next", "{ auto* next = &INTO; next->TARGET = READ; }", target="int")
_text("pointer_now", "{ const auto* now = &state; WRITE(now->SOURCE); }", source="int")
