"""Tries the whole matrix of the table: each party, act and key. The tests try a twentieth of it.

python -m tests.hostile.bus
"""

import sys
import tempfile
from pathlib import Path

from .matrix import PARTIES, attempts, wrong
from .routed import routed


def main() -> int:
    """Exit code 0 where every promise was kept."""
    tried = list(attempts())
    with tempfile.TemporaryDirectory(prefix="aos-bus-") as folder, routed(Path(folder), PARTIES) as router:
        found = list(wrong(router, tried))
    allowed = sum(attempt.is_allowed for attempt in tried)
    print(f"matrix: {allowed} allowed and {len(tried) - allowed} denied attempts, {len(found)} otherwise")
    for line in found:
        print(f"  {line}")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
