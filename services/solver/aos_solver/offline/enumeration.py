"""A bundle's model as numbers, from its compiled engine."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
import numpy as np

from aos_protocol.errors import ModelError
from aos_solver.child.answers import Explored, LeftOut
from aos_solver.child.engine import Engine
from aos_solver.offline.explicit_model import ExplicitModel, Floats, Integers, Ragged, StartBelief

__all__ = ["ENDED", "MANY_STATES", "MOST_STATES", "Enumeration", "Extent", "enumerate_model"]

MOST_STATES = 1_000_000
MANY_STATES = 100_000
"""With more it is tried whether all variables matter."""
ENDED = "ended"
"""The name of the state that stands for all in which the mission is over."""

_PIECE_S = 0.25
_HINT = "A counter without a limit makes a state of every value; give it one, or plan online"


class Extent(msgspec.Struct, frozen=True):
    """How far an enumeration has come: states whose outcomes are known, and states known at all."""

    explored: int
    known: int


class Enumeration(msgspec.Struct, frozen=True):
    """The model, and the engine's texts of its states but the last one, in which the mission is over.

    States are not told apart by what is `left_out`.
    """

    model: ExplicitModel
    state_texts: tuple[str, ...]
    left_out: LeftOut


async def enumerate_model(
    engine: Engine,
    *,
    most_states: int = MOST_STATES,
    discount: float | None = None,
    on_progress: Callable[[Extent], None] = lambda extent: None,
) -> Enumeration:
    """All that can happen from the initial belief on; `discount` None is the documents'.

    Models of many states are listed without the variables that change neither what is earned nor what is
    observed, if there are any.
    ModelError AOS220 if a draw is continuous, or there are more than `most_states` states.
    """
    await engine.reset_belief()
    left_out = LeftOut()
    pieces = _Pieces()
    await _explore(engine, pieces, left_out, min(most_states, MANY_STATES), on_progress)
    if not pieces.is_done:
        left_out = await engine.propose_left_out()
        if left_out.variables:
            pieces = _Pieces()
        await _explore(engine, pieces, left_out, most_states, on_progress)
    if not pieces.is_done:
        message = f"{engine.description.project} has more than {most_states} states that can be reached"
        raise ModelError(message, code="AOS220", hint=_HINT)
    belief = await engine.export_belief(left_out.numbers)
    states = pieces.states
    # Particles that have ended already are worth nothing and are left out.
    numbers = {text: number for number, text in enumerate(states)}
    start: dict[int, float] = {}
    for weight, text in belief.particles:
        if (number := numbers.get(text)) is not None:
            start[number] = start.get(number, 0.0) + weight
    return Enumeration(_explicit(engine, pieces, start, discount), tuple(states), left_out)


async def _explore(
    engine: Engine,
    pieces: _Pieces,
    left_out: LeftOut,
    most_states: int,
    on_progress: Callable[[Extent], None],
) -> None:
    """Adds pieces until all are there, or more states than that are known."""
    while not pieces.is_done and len(pieces.states) <= most_states:
        is_new = not pieces.states
        try:
            pieces.take(await engine.explore(is_new=is_new, time_s=_PIECE_S, left_out=left_out.numbers))
        except ModelError as error:
            if error.code != "AOS220":
                raise
            raise ModelError(
                f"{engine.description.project} cannot be solved before the mission: {error.message}",
                code="AOS220",
                hint="Use draws with a finite number of outcomes, or plan online (aos plan, aos-up)",
            ) from error
        on_progress(Extent(pieces.explored, len(pieces.states)))


class _Pieces:
    """What the engine has told so far."""

    def __init__(self) -> None:
        self.states: list[str] = []
        self.observations: list[str] = []
        self.explored = -1
        self._rewards: list[Floats] = []
        self._counts: list[Integers] = []
        self._outcomes: list[Floats] = []

    @property
    def is_done(self) -> bool:
        return self.explored == len(self.states)

    def take(self, piece: Explored) -> None:
        self.states += piece.states
        self.observations += piece.observations
        self.explored = piece.explored
        self._rewards.append(np.array(piece.rewards))
        self._counts.append(np.array(piece.counts, dtype=np.int64))
        self._outcomes.append(np.array(piece.outcomes, dtype=float).reshape(-1, 3))

    def rewards(self, actions: int) -> Floats:
        return np.concatenate(self._rewards).reshape(-1, actions)

    def outcomes(self) -> tuple[Integers, Integers, Integers, Floats]:
        """Row (state, action), next state, observation and probability of every outcome."""
        counts = np.concatenate(self._counts)
        table = np.concatenate(self._outcomes)
        rows = np.repeat(np.arange(len(counts)), counts)
        return rows, table[:, 0].astype(np.int64), table[:, 1].astype(np.int64), table[:, 2]


def _explicit(
    engine: Engine, pieces: _Pieces, start: dict[int, float], discount: float | None
) -> ExplicitModel:
    description = engine.description
    actions = len(description.actions)
    ended = len(pieces.states)
    rows, after, observation, probability = pieces.outcomes()
    after = np.where(after < 0, ended, after)
    silent = len(pieces.observations)
    # What is observed once the mission is over does not matter.
    rows = np.concatenate([rows, ended * actions + np.arange(actions)])
    after = np.concatenate([after, np.full(actions, ended)])
    observation = np.concatenate([observation, np.full(actions, silent)])
    probability = np.concatenate([probability, np.ones(actions)])
    row_count = (ended + 1) * actions
    outcomes, sensings, readings = _with_sensings(rows, after, observation, probability, row_count)
    numbers, weights = np.array(list(start)), np.array(list(start.values()))
    return ExplicitModel(
        name=description.project,
        discount=description.discount if discount is None else discount,
        states=(*(f"s{number}" for number in range(ended)), ENDED),
        actions=tuple(action.name for action in description.actions),
        observations=(*pieces.observations, ENDED),
        rewards=np.vstack([pieces.rewards(actions), np.zeros((1, actions))]),
        outcomes=outcomes,
        sensings=sensings,
        readings=readings,
        starts=(StartBelief(1.0, numbers, weights),) if start else (),
    )


def _with_sensings(
    rows: Integers, after: Integers, observation: Integers, probability: Floats, row_count: int
) -> tuple[Ragged, Integers, Ragged]:
    """Outcomes by (row, next state), and what is observed with each; equal distributions are kept once."""
    order = np.lexsort((observation, after, rows))
    rows, after, observation = rows[order], after[order], observation[order]
    probability = probability[order]
    begins = np.flatnonzero(np.r_[True, (rows[1:] != rows[:-1]) | (after[1:] != after[:-1])])
    totals = np.add.reduceat(probability, begins)
    lengths = np.diff(np.r_[begins, len(rows)])
    shares = probability / np.repeat(totals, lengths)
    known: dict[bytes, int] = {}
    sensings = np.empty(len(begins), dtype=np.int64)
    kept: list[slice] = []
    rounded = np.round(shares, 12)
    for number, (begin, length) in enumerate(zip(begins, lengths, strict=True)):
        part = slice(begin, begin + length)
        key = observation[part].tobytes() + rounded[part].tobytes()
        sensings[number] = known.setdefault(key, len(kept))
        if sensings[number] == len(kept):
            kept.append(part)
    readings = Ragged(
        np.cumsum([0, *(part.stop - part.start for part in kept)]),
        np.concatenate([observation[part] for part in kept]),
        np.concatenate([shares[part] for part in kept]),
    )
    first = np.searchsorted(rows[begins], np.arange(row_count + 1))
    return Ragged(first, after[begins], totals), sensings, readings
