import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from tests.hostile.attempt import Attempt


def who_plays() -> str:
    """Returns who the process is: root, root without user namespaces, or a user."""
    if os.getuid() != 0:
        return "user"
    namespaces = Path("/proc/sys/user/max_user_namespaces")
    return "closed" if namespaces.exists() and int(namespaces.read_text()) == 0 else "root"


def line(number: int, attempt: Attempt) -> str:
    told = "-" if attempt.told_s is None else f"{attempt.told_s:.1f} s"
    return f"{number}: {attempt.kind} that {attempt.name}, {attempt.way}: {told}  {'; '.join(attempt.faults)}"


def summary(attempts: Sequence[Attempt], in_time_s: float) -> str:
    """The number of each kind, of those that broke a promise, and the latest word."""
    kinds = Counter(attempt.kind for attempt in attempts)
    counted = ", ".join(f"{count} of {kind}s" for kind, count in kinds.items())
    all_s = [attempt.told_s for attempt in attempts if attempt.told_s is not None]
    return (
        f"{who_plays()}: {counted}: {sum(bool(attempt.faults) for attempt in attempts)} broke a promise; "
        f"{sum(one_s <= in_time_s for one_s in all_s)} of {len(all_s)} were told within {in_time_s:g} s, "
        f"the last after {max(all_s, default=0.0):.1f} s; "
        f"{sum(attempt.processor_s for attempt in attempts):.0f} s of processor time"
    )
