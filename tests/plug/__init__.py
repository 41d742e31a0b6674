"""Figures about documents that change while a mission runs: `make plug`."""

import sys
from pathlib import Path

# `python -m tests.plug` and pytest find the same modules.
sys.path.append(str(Path(__file__).resolve().parents[1]))
