"""A hall with a cat: documents that change while a mission runs, in small."""

from collections.abc import Sequence

from aos_protocol.messages import Marginal
from aos_solver.mission.models.past import Evidence, Past

HALL = {
    "hall.ef": """project: hall
horizon: 3
define_type: Room
enum_members: Attic, Cellar, Yard
state_variable: Room cat
state_variable: bool is_wet
initial_belief:
state.cat = AOS.Bernoulli(0.25) ? Attic : Cellar;
extrinsic_code:
if (AOS.Bernoulli(0.1)) state_.is_wet = true;
reward_code:
if (state.cat == Yard) __reward = 1;
""",
    "look.sd": """project: hall
dynamic_model:
__moduleResponse = AOS.Bernoulli(state.cat == Attic ? 0.9 : 0.2) ? above : below;
""",
}
BELL = "state_variable: bool has_bell\ninitial_belief:\n"
"""Stands before the initial belief of documents with another variable."""


def changed(**changes: tuple[str, str]) -> dict[str, str]:
    """The documents with a text in place of another one, by the file's name without its ending."""
    files = dict(HALL)
    for stem, (old, new) in changes.items():
        (name,) = (name for name in files if name.startswith(f"{stem}.") and old in files[name])
        files[name] = files[name].replace(old, new)
    return files


def with_bell(code: str) -> dict[str, str]:
    return changed(hall=("initial_belief:\n", f"{BELL}{code}\n"))


def looked(response: str) -> Evidence:
    return Evidence("look", "look", response)


def past_of(*steps: Evidence) -> Past:
    past = Past()
    past.steps += steps
    return past


def marginal(marginals: Sequence[Marginal], variable: str) -> dict[str, float]:
    (found,) = (each.values for each in marginals if each.variable == variable)
    return found


def with_peek(files: dict[str, str]) -> dict[str, str]:
    return {"hall.ef": files["hall.ef"], "peek.sd": files["look.sd"]}
