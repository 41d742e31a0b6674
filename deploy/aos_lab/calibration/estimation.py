"""Probabilities with intervals from what missions may have been.

Where the records say what was drawn, the outcomes are counted, and the interval is Jeffreys's. Where they
leave it open, the outcomes are drawn along with the probabilities (Gibbs sampling, with Jeffreys's prior), so
that the interval is as much wider as the records say less.
"""

import math
from collections.abc import Callable, Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from aos_lab.calibration.draws import Draw
from aos_lab.calibration.lattice import Lattice
from aos_lab.trials.intervals import CONFIDENCE, Interval

PRIOR = 0.5
LEAST_DIFFERENCE = 0.1
"""Nobody asks whether a number is wrong by less than this."""
NORMAL_QUANTILE = 1.96
SWEEPS, FIRST_SWEEPS = 600, 150
QUANTILE_SAMPLES = 400_000
SEED = 1

Numbers = npt.NDArray[np.float64]


class Estimate(msgspec.Struct, frozen=True):
    """The estimate of one outcome: how often it was drawn, as far as is known, and its probability.

    `document` is the probability that the documents give it; with 0 they exclude it, which no record changes.
    """

    outcome: str
    count: float
    probability: Interval
    document: float

    @property
    def is_inside(self) -> bool:
        """True if the document's number is one that the records allow."""
        return self.probability.low <= self.document <= self.probability.high

    @property
    def is_excluded(self) -> bool:
        """True if the documents say that it never comes."""
        return self.document == 0.0


class DrawEstimate(msgspec.Struct, frozen=True):
    """The estimate of all outcomes of a draw, or of draws that share their numbers.

    With `is_counted` the records leave none of them open. `records_to_tell` is about how many it would take
    to contradict the document's numbers: if they are as wrong as the records have it, or by 0.1 if less.
    """

    draw: Draw
    count: float
    is_counted: bool
    outcomes: tuple[Estimate, ...]
    records_to_tell: int = 0

    @property
    def is_inside(self) -> bool:
        """True if the records allow the document's numbers; they do where they say nothing."""
        return not self.count or all(outcome.is_inside for outcome in self.outcomes)

    @property
    def may_be_chance(self) -> bool:
        """True if by the document no outcome comes improbably often, or seldom."""
        return all(
            outcome.is_inside or (0 < outcome.document < 1 and not _is_improbable(outcome, self.count))
            for outcome in self.outcomes
        )

    @property
    def is_contradicted(self) -> bool:
        """True if the records are reason to change a number: one of an outcome that comes now and then."""
        possible = [outcome for outcome in self.outcomes if not outcome.is_excluded]
        if not self.count or len(possible) < 2 or self.draw.is_initial:
            return False
        return any(not outcome.is_inside and _is_improbable(outcome, self.count) for outcome in possible)


class _Parameters:
    """The probabilities of all draws. Draws whose numbers stand at the same places share them."""

    def __init__(self, draws: Sequence[Draw]) -> None:
        self.of_draw = [next(i for i, other in enumerate(draws) if other.places == d.places) for d in draws]
        self.sizes = [len(draw.outcomes) for draw in draws]
        self.possible = [_document(draw) > 0 for draw in draws]

    def start(self) -> list[Numbers]:
        """All outcomes that the documents allow, equally likely."""
        return [mask / max(mask.sum(), 1) for mask in self.possible]

    def drawn_from(self, counts: Sequence[Numbers], random: np.random.Generator) -> list[Numbers]:
        """Probabilities by these counts. What the documents exclude stays impossible."""
        drawn = []
        for count, mask in zip(counts, self.possible, strict=True):
            probabilities = np.zeros(len(count))
            if mask.any():
                probabilities[mask] = random.dirichlet(count[mask] + PRIOR)
            drawn.append(probabilities)
        return drawn

    def odds(self, drawn: npt.NDArray[np.int64], probabilities: Sequence[Numbers]) -> Numbers:
        """Returns for each state of a layer by how much its draws are likelier than with equal
        probabilities."""
        odds = np.ones(len(drawn))
        for draw, owner in enumerate(self.of_draw):
            factors = np.r_[1.0, probabilities[owner] * self.sizes[draw]]
            odds *= factors[drawn[:, draw]]
        return odds

    def count(self, drawn: npt.NDArray[np.int64], counts: list[Numbers]) -> None:
        """Adds one layer's outcomes, of which each is a row."""
        for draw, owner in enumerate(self.of_draw):
            counts[owner] += np.bincount(drawn[:, draw], minlength=self.sizes[draw] + 1)[1:]


def estimate(
    draws: Sequence[Draw],
    lattices: Sequence[Lattice],
    on_sweep: Callable[[int, int], None] = lambda done, of: None,
) -> tuple[DrawEstimate, ...]:
    """Returns an estimate for each draw whose numbers no draw before it has."""
    random = np.random.default_rng(SEED)
    parameters = _Parameters(draws)
    fixed = [np.zeros(len(draw.outcomes)) for draw in draws]
    open_ones: list[Lattice] = []
    for lattice in lattices:
        if _is_counted(lattice):
            for layer in lattice.drawn:
                parameters.count(layer[:1], fixed)
        else:
            open_ones.append(lattice)
    sweeps = _sweeps(parameters, fixed, open_ones, random, on_sweep)
    found = []
    for number, draw in enumerate(draws):
        if parameters.of_draw[number] == number:
            counts = np.array([sweep[number] for sweep in sweeps])
            found.append(_of_draw(draw, counts, random))
    return tuple(found)


def _is_counted(lattice: Lattice) -> bool:
    return all((layer == layer[0]).all() for layer in lattice.drawn)


def _sweeps(
    parameters: _Parameters,
    fixed: list[Numbers],
    lattices: Sequence[Lattice],
    random: np.random.Generator,
    on_sweep: Callable[[int, int], None],
) -> list[list[Numbers]]:
    """The counts of outcomes in each sweep; one sweep does where nothing is open."""
    if not lattices:
        return [fixed]
    alike = _alike(lattices)
    probabilities = parameters.start()
    kept = []
    total = FIRST_SWEEPS + SWEEPS
    for sweep in range(total):
        counts = [count.copy() for count in fixed]
        for lattice, missions in alike:
            forward = _forward(lattice, parameters, probabilities)
            for _ in range(missions):
                for layer in _one_way(lattice, forward, random):
                    parameters.count(layer, counts)
        probabilities = parameters.drawn_from(counts, random)
        if sweep >= FIRST_SWEEPS:
            kept.append(counts)
        on_sweep(sweep + 1, total)
    return kept


def _alike(lattices: Sequence[Lattice]) -> list[tuple[Lattice, int]]:
    """Those that differ, and how many missions are like each: with few responses there are few."""
    found: dict[bytes, tuple[Lattice, int]] = {}
    for lattice in lattices:
        key = b"|".join(array.tobytes() for array in (lattice.start, *lattice.links, *lattice.drawn))
        found[key] = (lattice, found.get(key, (lattice, 0))[1] + 1)
    return list(found.values())


def _forward(lattice: Lattice, parameters: _Parameters, probabilities: Sequence[Numbers]) -> list[Numbers]:
    """The odds of each layer's states by all that was observed before."""
    odds = [parameters.odds(layer, probabilities) for layer in lattice.drawn]
    forward = [_scaled(lattice.start * odds[0])]
    for link, layer_odds in zip(lattice.links, odds[1:], strict=True):
        forward.append(_scaled((forward[-1] @ link) * layer_odds))
    return forward


def _one_way(
    lattice: Lattice, forward: Sequence[Numbers], random: np.random.Generator
) -> list[npt.NDArray[np.int64]]:
    """The draws of a way through the layers, drawn from all ways, from its end to its beginning."""
    state = _chosen(forward[-1], random)
    way = [lattice.drawn[-1][state : state + 1]]
    for number in range(lattice.steps - 1, -1, -1):
        state = _chosen(forward[number] * lattice.links[number][:, state], random)
        way.append(lattice.drawn[number][state : state + 1])
    return way


def _scaled(odds: Numbers) -> Numbers:
    total = odds.sum()
    # Outcomes that have become next to impossible are still all that there is.
    return odds / total if total > 0 else np.full(len(odds), 1 / len(odds))


def _chosen(odds: Numbers, random: np.random.Generator) -> int:
    heights = np.cumsum(odds)
    return int(min(np.searchsorted(heights, random.random() * heights[-1], side="right"), len(odds) - 1))


def _of_draw(draw: Draw, counts: Numbers, random: np.random.Generator) -> DrawEstimate:
    """`counts` has a row for each sweep."""
    totals = counts.sum(axis=1)
    document = _document(draw)
    estimates = []
    for number, outcome in enumerate(draw.outcomes):
        hits = counts[:, number]
        estimates.append(
            Estimate(outcome, float(hits.mean()), _interval(hits, totals, random), float(document[number]))
        )
    is_counted = bool((counts == counts[0]).all())
    needed = max((_records_to_tell(estimate, totals.mean()) for estimate in estimates), default=0)
    return DrawEstimate(draw, float(totals.mean()), is_counted, tuple(estimates), needed)


def _records_to_tell(estimate: Estimate, records: float) -> int:
    """Returns about how many records would put the document's number outside the interval; 0 for what is
    excluded."""
    if estimate.is_excluded or estimate.document == 1.0:
        return 0
    document = estimate.document
    share = (estimate.count + PRIOR) / (records + 2 * PRIOR)
    if abs(share - document) < LEAST_DIFFERENCE:
        share = document + LEAST_DIFFERENCE * (1 if document < 0.5 else -1)
    variance = max(document * (1 - document), share * (1 - share))
    return math.ceil(NORMAL_QUANTILE**2 * variance / (share - document) ** 2)


def _is_improbable(outcome: Estimate, records: float) -> bool:
    """Returns whether so many, or so few, of the records come in less than 2.5 of 100 cases by the document's
    number.

    Of few records Jeffreys's interval leaves out more than that.
    """
    n, hits, p = round(records), round(outcome.count), outcome.document

    def probability(k: int) -> float:
        ways = math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)
        return math.exp(ways + k * math.log(p) + (n - k) * math.log1p(-p))

    of_each = [probability(k) for k in range(n + 1)]
    return min(sum(of_each[: hits + 1]), sum(of_each[hits:])) < (1 - CONFIDENCE) / 2


def _document(draw: Draw) -> Numbers:
    """The probabilities of all outcomes as the documents have them."""
    if draw.kind == "Bernoulli":
        return np.array([1 - draw.weights[0], draw.weights[0]])
    weights = np.array(draw.weights)
    return weights / weights.sum() if weights.sum() > 0 else weights


def _interval(hits: Numbers, totals: Numbers, random: np.random.Generator) -> Interval:
    """Jeffreys's, over all sweeps. It reaches 0 where an outcome never came, and 1 where no other did."""
    if not totals.mean():
        return Interval(0.0, 0.0, 1.0)
    repeats = -(-QUANTILE_SAMPLES // len(hits))
    samples = random.beta(hits + PRIOR, totals - hits + PRIOR, (repeats, len(hits)))
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(samples, [tail, 1 - tail])
    share = float(hits.sum() / totals.sum())
    return Interval(
        share, 0.0 if not hits.any() else float(low), 1.0 if (hits == totals).all() else float(high)
    )
