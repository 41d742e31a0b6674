"""Problems whose states cannot be listed, each beside what a rule by hand returns."""

import sys
from pathlib import Path

# `python -m tests.wide` and pytest find the same modules.
sys.path.append(str(Path(__file__).resolve().parents[1]))
