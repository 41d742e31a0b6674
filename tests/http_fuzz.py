"""Requests made up by schemathesis from the gateway's OpenAPI document: no answer may be a server's error.

  python -m tests.http_fuzz --examples 100

Each answer also has the status, the type and the shape that the document says. The gateway is asked about a
mission that is over, and then about one that waits for its robot. Requests are the same in each run, but for
the names of the missions. Exit code 1: an answer was another one.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from gateway import Gateway, gateway, played, slow_system  # noqa: E402

_CHECKS = "not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance"
# Nothing is learned from answers: they name times and processes, and the next requests would depend on them.
_SETTINGS = """\
phases.examples.enabled = false
phases.stateful.enabled = false
phases.coverage.extra-data-sources.responses = false
phases.fuzzing.extra-data-sources.responses = false
phases.fuzzing.error-feedback.enabled = false
generation.deterministic = true
generation.max-examples = {examples}
dictionaries.run.values = ["{run}"]
dictionaries.step.values = [1, 2]
dictionaries.service.values = ["solver"]
parameters."path.run" = {{ dictionary = "run", probability = 0.7 }}
parameters."path.mission" = {{ dictionary = "run", probability = 0.7 }}
parameters."path.step" = {{ dictionary = "step", probability = 0.7 }}
parameters."path.service" = {{ dictionary = "service", probability = 0.7 }}
"""
_ENDLESS = "/v1/events"


def fuzz(served: Gateway, run: str, examples: int) -> subprocess.CompletedProcess[str]:
    """Asks about a run, each operation by its limits and so many times at random; returns what was found.

    The exit code is 0 if all answers were right.
    """
    settings = served.folder / "schemathesis.toml"
    settings.write_text(_SETTINGS.format(examples=examples, run=run))
    command = [
        *(sys.executable, "-m", "schemathesis.cli", "--no-color", "--config-file", str(settings), "run"),
        *("--checks", _CHECKS, "--exclude-path", _ENDLESS, "--continue-on-failure", "--warnings", "off"),
        *("--header", f"Authorization: Bearer {served.token}"),
        f"http://127.0.0.1:{served.port}/v1/openapi.json",
    ]
    return subprocess.run(command, cwd=served.folder, capture_output=True, text=True, check=False)


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.http_fuzz",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--examples", type=int, default=100, help="random requests to each operation")
    examples = parser.parse_args().examples
    is_well = True
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        run = played(folder)
        with gateway(folder) as served:
            is_well &= _told("a mission that is over", fuzz(served, run.name, examples))
        with slow_system(folder) as living, gateway(folder) as served:
            is_well &= _told("a mission that goes on", fuzz(served, living.name, examples))
    return 0 if is_well else 1


def _told(what: str, found: subprocess.CompletedProcess[str]) -> bool:
    print(f"--- {what}", found.stdout, found.stderr, sep="\n", flush=True)
    return found.returncode == 0


if __name__ == "__main__":
    sys.exit(main())
