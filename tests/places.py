"""Places of what the tests use."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DEPLOY = ROOT / "deploy"
BUNDLES = DEPLOY / "bundles"
DATA = ROOT / "tests" / "data"
PROBLEMS = DATA / "problems"
BIN = Path(sys.executable).parent
"""The folder of our commands."""
