"""The traces of missions in a simulated world besides actions: how fast they were, and pictures."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from aos_lab.trials.trial import Trial


def simulated_speed(trials: Sequence[Trial]) -> float | None:
    """Simulated seconds for each second of processor time, pictures included; None where nobody counted."""
    simulated = used = 0.0
    for trial in trials:
        lines = list(_lines(trial))
        if lines and all("processor_s" in line for line in lines):
            simulated += lines[-1]["time_s"]
            used += sum(line["processor_s"] for line in lines)
    return simulated / used if used else None


def keep_picture(runs: Path, seeds: Sequence[int], target: Path) -> Path | None:
    """The first mission with pictures as it looked at its end, without loss; None where there are none."""
    for seed in seeds:
        pictures = sorted(runs.glob(f"seed-{seed}/*/pictures/*.png"))
        if pictures:
            from PIL import Image  # Whoever has pictures has it.

            target.parent.mkdir(parents=True, exist_ok=True)
            with Image.open(pictures[-1]) as picture:
                picture.save(target, lossless=True)
            return target
    return None


def _lines(trial: Trial) -> Iterator[dict[str, Any]]:
    """The lines of a world's record, of which the model's states are none."""
    for state in trial.states:
        if state.startswith("{"):
            yield json.loads(state)
