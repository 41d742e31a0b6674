"""Counters, gauges and histograms, and Prometheus' text format for them (version 0.0.4)."""

import math
from abc import ABC, abstractmethod
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence

EXPOSITION = "text/plain; version=0.0.4; charset=utf-8"
"""The media type."""

_Labels = tuple[tuple[str, str], ...]


class Family(ABC):
    """The samples of one name, by labels. `text` says in one line what they are."""

    kind = "untyped"

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.text = text

    @abstractmethod
    def samples(self) -> Iterator[str]:
        """The lines of the samples."""

    def lines(self) -> Iterator[str]:
        """The family in the text format; nothing where there is no sample."""
        samples = list(self.samples())
        if samples:
            text = self.text.replace("\\", r"\\").replace("\n", r"\n")
            yield f"# HELP {self.name} {text}"
            yield f"# TYPE {self.name} {self.kind}"
            yield from samples


class Counter(Family):
    """Sums that never become less."""

    kind = "counter"

    def __init__(self, name: str, text: str) -> None:
        super().__init__(name, text)
        self._sums: dict[_Labels, float] = {}

    def add(self, amount: float = 1.0, **labels: str) -> None:
        """Adds an amount of at least 0; one of 0 makes the sample known."""
        key = tuple(labels.items())
        self._sums[key] = self._sums.get(key, 0.0) + amount

    def samples(self) -> Iterator[str]:
        for labels, value in sorted(self._sums.items()):
            yield _sample(self.name, labels, value)


class Gauge(Counter):
    """Values that hold now."""

    kind = "gauge"

    def set(self, value: float, **labels: str) -> None:
        self._sums[tuple(labels.items())] = value

    def clear(self) -> None:
        """Forgets all values."""
        self._sums.clear()


class Histogram(Family):
    """Numbers of observations up to each of the bounds, and their sum."""

    kind = "histogram"

    def __init__(self, name: str, text: str, bounds: Sequence[float]) -> None:
        super().__init__(name, text)
        self._bounds = (*bounds, math.inf)
        self._numbers: dict[_Labels, list[int]] = {}
        self._sums: dict[_Labels, float] = {}

    def observe(self, value: float, **labels: str) -> None:
        key = tuple(labels.items())
        numbers = self._numbers.setdefault(key, [0] * len(self._bounds))
        numbers[bisect_left(self._bounds, value)] += 1
        self._sums[key] = self._sums.get(key, 0.0) + value

    def samples(self) -> Iterator[str]:
        for labels, numbers in sorted(self._numbers.items()):
            total = 0
            for bound, number in zip(self._bounds, numbers, strict=True):
                total += number
                yield _sample(f"{self.name}_bucket", (*labels, ("le", _number(bound))), total)
            yield _sample(f"{self.name}_sum", labels, self._sums[labels])
            yield _sample(f"{self.name}_count", labels, total)


def exposition(families: Iterable[Family]) -> bytes:
    return "".join(f"{line}\n" for family in families for line in family.lines()).encode()


def _sample(name: str, labels: _Labels, value: float) -> str:
    shown = ",".join(f'{label}="{_escaped(text)}"' for label, text in labels)
    return f"{name}{{{shown}}} {_number(value)}"


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace("\n", r"\n").replace('"', r"\"")


def _number(value: float) -> str:
    if math.isinf(value):
        return "+Inf" if value > 0 else "-Inf"
    return str(int(value)) if value == int(value) and abs(value) < 2**53 else repr(float(value))
