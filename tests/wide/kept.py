"""The problems by name: documents, the size that is played, the rule by hand, the world of random actions."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from . import rules
from .cleaning import cleaning, cleaning_rule
from .gauges import Gauges, gauges, gauges_rule
from .greenhouse import greenhouse, greenhouse_rule
from .leaving import Questions, Survey, questions, questions_rule, survey, survey_rule
from .lock import Lock, lock, lock_rule
from .photo import Photo, photo, photo_rule
from .pipe import Pipe, pipe, pipe_rule
from .problems import clutter, open_field, parcels
from .rescue import Rescue, rescue, rescue_rule
from .shelf import shelf, shelf_rule
from .towers import Towers, towers, towers_rule
from .world import World
from .writing import Bundle


class Problem(NamedTuple):
    """A problem; `world` is None where random actions are not played."""

    documents: Callable[[int], Bundle]
    size: int
    rule: Callable[[int, random.Random], float]
    world: Callable[[int, random.Random], World] | None = None

    def write(self, bundle: Path, size: int) -> Path:
        bundle.mkdir(parents=True, exist_ok=True)
        for name, text in self.documents(size).items():
            (bundle / name).write_text(text)
        return bundle


KEPT = {
    "parcels": Problem(parcels, 14, rules.parcels),
    "clutter": Problem(clutter, 40, rules.clutter),
    "open_field": Problem(open_field, 9, rules.open_field),
    "shelf": Problem(shelf, 7, shelf_rule),
    "greenhouse": Problem(greenhouse, 5, greenhouse_rule),
    "cleaning": Problem(cleaning, 7, cleaning_rule),
    "survey": Problem(survey, 12, survey_rule, Survey),
    "questions": Problem(questions, 18, questions_rule, Questions),
    "rescue": Problem(rescue, 3, rescue_rule, Rescue),
    "lock": Problem(lock, 5, lock_rule, Lock),
    "towers": Problem(towers, 10, towers_rule, Towers),
    "photo": Problem(photo, 12, photo_rule, Photo),
    "gauges": Problem(gauges, 8, gauges_rule, Gauges),
    "pipe": Problem(pipe, 40, pipe_rule, Pipe),
}
