"""Writes a policy graph: for Graphviz, and as a C header that needs nothing else."""

import re
from collections.abc import Iterator
from pathlib import Path

from aos_lab.formats.policy_graph import OVER, PolicyGraph
from aos_lab.formats.symbols import symbols
from aos_protocol.errors import PlanningError

_MAX_NUMBERED = 0xFFFE


def write_text(path: Path, text: str) -> None:
    """Writes a file; PlanningError AOS101 where the disk refuses."""
    try:
        path.write_text(text)
    except OSError as error:
        raise PlanningError(f"cannot write {path}: {error.strerror}", code="AOS101") from error


def graphviz(graph: PolicyGraph) -> str:
    """The graph in the DOT language; draw it with `dot -Tsvg`."""
    return "\n".join(_dot_lines(graph)) + "\n"


def _dot_lines(graph: PolicyGraph) -> Iterator[str]:
    model = graph.model
    yield f"digraph {_quoted(model.name)} {{"
    yield f"  label={_quoted(f'{model.name}: {graph.value:.6g} from the start')};"
    yield "  rankdir=LR;"
    yield "  node [shape=box, style=rounded];"
    for number, node in enumerate(graph.nodes):
        width = ", penwidth=2" if number in graph.starts else ""
        yield f"  n{number} [label={_quoted(model.actions[node.action])}{width}];"
    if any(OVER in node.next.values() for node in graph.nodes):
        yield "  over [shape=point, width=0.15];"
    for number, node in enumerate(graph.nodes):
        for following in sorted(set(node.next.values())):
            observations = sorted(o for o, target in node.next.items() if target == following)
            label = "\n".join(model.observations[observation] for observation in observations)
            target = "over" if following == OVER else f"n{following}"
            yield f"  n{number} -> {target} [label={_quoted(label)}];"
    yield "}"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def c_header(graph: PolicyGraph, name: str) -> str:
    """A header in C99, all names of which begin with `name`; it needs no heap, no library and no start-up.

    PlanningError AOS320 if nodes or observations are more than 16 bits can number.
    """
    if max(len(graph.nodes), len(graph.model.observations)) >= _MAX_NUMBERED:
        message = f"{graph.model.name} has too many observations or nodes for 16 bits"
        raise PlanningError(message, code="AOS320", hint="Ask for fewer --nodes, or use the .policy file")
    return _header(graph, symbols([name.lower()])[0])


def _header(graph: PolicyGraph, prefix: str) -> str:
    model = graph.model
    upper = prefix.upper()
    start = "0" if len(graph.starts) == 1 else "k"
    told = "// The robot is told at the start which of these it is.\n" if len(graph.starts) > 1 else ""
    return f"""\
// The policy of {_one_line(model.name)}, written by `aos solve`; do not edit.
//
// From the start it gives {graph.value:.6g}, discounted by {model.discount:g} a step. To follow it:
//
//   uint16_t node = {prefix}_start[{start}];
//   while (node < {upper}_NODES) node = {prefix}_after(node, do_and_observe({prefix}_node_action[node]));
//
// `{prefix}_after` gives {upper}_OVER once the mission is over, and {upper}_NO_NODE for an
// observation that the model holds impossible there.
#ifndef {upper}_H
#define {upper}_H

#include <stdint.h>

{_enumeration(f"{prefix}_action", f"{upper}_DO", model.actions)}
{_enumeration(f"{prefix}_observation", f"{upper}_SEE", model.observations)}
enum {{ {upper}_NODES = {len(graph.nodes)}, {upper}_OVER = 0xfffe, {upper}_NO_NODE = 0xffff }};

{told}{_array(f"{prefix}_start", "uint16_t", [str(node) for node in graph.starts])}
{_array(f"{prefix}_node_action", "uint16_t", [str(node.action) for node in graph.nodes])}
{_edges(graph, prefix)}
// The node after an observation.
static inline uint16_t {prefix}_after(uint16_t node, {prefix}_observation observation) {{
  uint32_t low = {prefix}_first_edge[node];
  uint32_t high = {prefix}_first_edge[node + 1];
  while (low < high) {{
    uint32_t middle = low + (high - low) / 2;
    if ({prefix}_edge_observation[middle] == observation) return {prefix}_edge_node[middle];
    if ({prefix}_edge_observation[middle] < observation) {{
      low = middle + 1;
    }} else {{
      high = middle;
    }}
  }}
  return {upper}_NO_NODE;
}}

#endif
"""


def _edges(graph: PolicyGraph, prefix: str) -> str:
    first, numbers, following = [0], [], []
    for node in graph.nodes:
        for observation, target in sorted(node.next.items()):
            numbers.append(str(observation))
            following.append(str(target) if target != OVER else f"{prefix.upper()}_OVER")
        first.append(len(numbers))
    return f"""\
// The edges of a node, by ascending observation, begin at its place in the first array.
{_array(f"{prefix}_first_edge", "uint32_t", [str(place) for place in first])}
{_array(f"{prefix}_edge_observation", "uint16_t", numbers or ["0"])}
{_array(f"{prefix}_edge_node", "uint16_t", following or ["0"])}"""


def _enumeration(name: str, prefix: str, meanings: tuple[str, ...]) -> str:
    lines = "".join(
        f"  {prefix}_{symbol.upper()} = {number},  // {_one_line(meaning)}\n"
        for number, (symbol, meaning) in enumerate(zip(symbols(meanings), meanings, strict=True))
    )
    return f"typedef enum {{\n{lines}}} {name};\n"


def _array(name: str, kind: str, values: list[str]) -> str:
    rows = (values[begin : begin + 16] for begin in range(0, len(values), 16))
    lines = "".join(f"    {', '.join(row)},\n" for row in rows)
    return f"static const {kind} {name}[{len(values)}] = {{\n{lines}}};\n"


def _one_line(text: str) -> str:
    """A text that stays within a comment."""
    return re.sub(r"[^\x20-\x7e]", " ", text).rstrip("\\")
