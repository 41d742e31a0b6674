"""A bundle's model as numbers, from its compiled engine."""

from collections.abc import Callable, Iterator

import msgspec
import numpy as np
from msgspec.structs import replace

from aos_protocol.errors import IntractableError
from aos_solver.child.answers.models import Listed
from aos_solver.child.engine import Engine
from aos_solver.offline.explicit_model import (
    ExplicitModel,
    FlatModel,
    Floats,
    StartBelief,
    read_flat,
    with_more_outcomes,
)

MAX_STATES = 1_000_000
ENDED = "ended"
"""The name of the state that stands for all in which the mission is over."""

_NEXT_TO_NOTHING = 1e-12
"""The probabilities of a row may miss this much by rounding."""


class Enumeration(msgspec.Struct, frozen=True):
    """The model, and the engine's texts of its states but the last one, in which the mission is over.

    States are not told apart by the variables `left_out`, which change nothing that is earned or observed.
    """

    model: ExplicitModel
    state_texts: tuple[str, ...]
    left_out: tuple[str, ...]


async def enumerate_model(
    engine: Engine,
    *,
    max_states: int = MAX_STATES,
    discount: float | None = None,
    on_progress: Callable[[Listed], None] = lambda listed: None,
) -> Enumeration:
    """All that can happen from the initial belief on; `discount` None is the documents'.

    IntractableError if a draw is continuous, or there are more than `max_states` states.
    """
    await engine.reset_belief()
    description = engine.description
    try:
        listed = await engine.list_states(max_states)
        while listed.listed < listed.known:
            on_progress(listed)
            listed = await engine.list_states()
    except IntractableError as error:
        raise IntractableError(
            f"{description.project} cannot be solved before the mission: {error.message}",
            hint="Use draws with a finite number of outcomes and counters with a limit, for no more than "
            f"{max_states} states (--states), or plan online (aos plan, aos-up)",
        ) from error
    written, flat, texts = await engine.write_listing()
    numbers, states = read_flat(flat), tuple(texts.splitlines())
    if discount is not None:
        numbers = replace(numbers, discount=discount)
    actions = tuple(action.name for action in description.actions)
    model = _with_an_end(description.project, numbers, actions, written.observations)
    return Enumeration(model, states, written.left_out)


def _with_ended_share(starts: tuple[StartBelief, ...], ended: int) -> Iterator[StartBelief]:
    """The beliefs at the start: what is missing from their probabilities is over from the start."""
    for start in starts:
        missing = 1 - start.probabilities.sum()
        if missing <= _NEXT_TO_NOTHING:
            yield start
            continue
        states = np.append(start.states, np.array([ended], start.states.dtype))
        yield StartBelief(start.weight, states, np.append(start.probabilities, missing))


def _with_an_end(
    name: str, numbers: FlatModel, actions: tuple[str, ...], observations: tuple[str, ...]
) -> ExplicitModel:
    """Adds a state in which the mission is over: what is missing from the probabilities of a row leads there.

    What is observed then does not matter.
    """
    ended, rows = numbers.rewards.shape[0], numbers.outcomes.row_numbers
    row_count = (ended + 1) * len(actions)
    missing: Floats = (1 - np.bincount(rows, numbers.outcomes.probabilities, row_count)).astype(np.float64)
    ending = np.flatnonzero(missing > _NEXT_TO_NOTHING)
    outcomes, sensings = with_more_outcomes(numbers, rows, row_count, ending, ended, missing[ending])
    return ExplicitModel(
        name=name,
        discount=numbers.discount,
        states=(*(f"s{number}" for number in range(ended)), ENDED),
        actions=actions,
        observations=(*observations, ENDED),
        rewards=np.vstack([numbers.rewards, np.zeros((1, len(actions)))]),
        outcomes=outcomes,
        sensings=sensings,
        likelihoods=numbers.likelihoods.with_certain_row(len(observations)),
        starts=tuple(_with_ended_share(numbers.starts, ended)),
    )
