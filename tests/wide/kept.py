"""The problems by name: documents, the size that is played, and what a rule by hand returns at that size."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from .cleaning import cleaning
from .gauges import gauges
from .greenhouse import greenhouse
from .leaving import questions, survey
from .lock import lock
from .photo import photo
from .pipe import pipe
from .problems import clutter, open_field, parcels
from .rescue import rescue
from .shelf import shelf
from .towers import towers
from .writing import Bundle


class Problem(NamedTuple):
    """A problem; `by_hand` tells what a rule returns, and random actions where they were played."""

    documents: Callable[[int], Bundle]
    size: int
    by_hand: str

    def write(self, bundle: Path, size: int) -> Path:
        bundle.mkdir(parents=True, exist_ok=True)
        for name, text in self.documents(size).items():
            (bundle / name).write_text(text)
        return bundle


# Mean returns of 2,000 missions. The rules and their worlds, which shared nothing with the engine, are in
# tests/wide of commit c19697af.
KEPT = {
    "parcels": Problem(parcels, 14, "rule 22.18 +- 0.17"),
    "clutter": Problem(clutter, 40, "rule 13.57 +- 0.51"),
    "open_field": Problem(open_field, 9, "rule 38.02 +- 0.80"),
    "shelf": Problem(shelf, 7, "rule 15.41 +- 0.31"),
    "greenhouse": Problem(greenhouse, 5, "rule -20.94 +- 0.20"),
    "cleaning": Problem(cleaning, 7, "rule -74.03 +- 0.34"),
    "survey": Problem(survey, 12, "rule 0.00 +- 0.00, random -4.05 +- 0.13"),
    "questions": Problem(questions, 18, "rule 6.62 +- 0.16, random -9.73 +- 0.06"),
    "rescue": Problem(rescue, 3, "rule 25.65 +- 0.24, random -40.71 +- 0.20"),
    "lock": Problem(lock, 5, "rule 13.96 +- 0.14, random -24.09 +- 0.13"),
    "towers": Problem(towers, 10, "rule 60.46 +- 0.03, random -28.02 +- 0.00"),
    "photo": Problem(photo, 12, "rule 3.88 +- 0.37, random -10.69 +- 0.17"),
    "gauges": Problem(gauges, 8, "rule 2.71 +- 0.15, random -26.09 +- 0.13"),
    "pipe": Problem(pipe, 40, "rule 18.45 +- 0.49, random -33.24 +- 0.67"),
}
