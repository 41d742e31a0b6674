"""The time that aos-up takes from its start to the first decision, on this machine, now.

    python tests/start_times.py [DEPLOY] [--times N]

Measures three states of the cache of compiled models: empty; with the engine, as set-up leaves it; with the
model too. Seconds count from the start of the process; `ready` is when all services were.
"""

import argparse
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIMIT_S = 900


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("deploy", nargs="?", default=str(ROOT / "deploy" / "armadillo.yaml"))
    parser.add_argument("--times", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        for state, prefix in (("empty", "*"), ("engine", "model-*"), ("model", "none-*")):
            starts = [one_start(options.deploy, scratch, prefix) for _ in range(options.times)]
            decision_s = sorted(total for total, _ in starts)
            ready_s = statistics.median(ready for _, ready in starts)
            listed = " ".join(f"{total:.2f}" for total in decision_s)
            sys.stdout.write(
                f"{state:6}  first decision after {statistics.median(decision_s):.2f} s ({listed}), "
                f"ready after {ready_s:.2f} s\n"
            )


def one_start(deploy: str, scratch: Path, forgotten: str) -> tuple[float, float]:
    """Seconds to the first decision and until the services were ready."""
    for entry in (scratch / "cache").glob(forgotten):
        subprocess.run(["rm", "-rf", entry], check=True)
    command = [str(Path(sys.executable).with_name("aos-up")), deploy, "--json"]
    command += ["--listen", "tcp/127.0.0.1:0", "--runs", str(scratch / "runs")]
    environment = {**os.environ, "AOS_CACHE_DIR": str(scratch / "cache")}
    began_s = time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as aos_up:
        assert aos_up.stdout is not None
        total_s = next(time.monotonic() - began_s for line in aos_up.stdout if is_decision(line))
        aos_up.send_signal(signal.SIGINT)
        aos_up.communicate(timeout=LIMIT_S)
    summary = json.loads((scratch / "runs" / "latest" / "summary.json").read_bytes())
    return total_s, summary["services_ready_s"] + total_s - summary["first_decision_s"]


def is_decision(line: str) -> bool:
    event = json.loads(line)
    return bool(event["event"] == "decision")


if __name__ == "__main__":
    main()
