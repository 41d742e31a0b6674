"""Whole missions of deploy files in physics: `python tests/physical_missions.py turtlebot --seeds 20`.

Runs `aos-up` once for each seed on a free port, and prints for each how it ended, what was done, what the
world came to, and how fast it was simulated while skills ran, pictures included.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
BIN = Path(sys.executable).parent
PATIENCE_S = 1800.0
NOT_SHOWN = {"step", "path", "time_s", "drawn_faults", "base", "robot", "believed", "cans"}


def on_a_free_port(name: str, folder: Path) -> Path:
    """A shipped deploy file with its paths, elsewhere, with runs of its own."""
    text = (ROOT / "deploy" / f"{name}.yaml").read_text()
    for old, new in {
        "bundles/": f"{ROOT}/deploy/bundles/",
        "world: worlds/": f"world: {ROOT}/deploy/worlds/",
        "runs: ../runs": "runs: runs",
    }.items():
        assert old in text, f"{name}.yaml has no {old}"
        text = text.replace(old, new)
    path = folder / f"{name}.yaml"
    path.write_text(text)
    return path


def mission(deploy_file: Path, seed: int) -> dict[str, Any]:
    """Runs one; the fields of its line."""
    command = [BIN / "aos-up", deploy_file, "--json", "--seed", str(seed)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    run = max((deploy_file.parent / "runs").iterdir(), key=lambda path: path.stat().st_mtime)
    summary = json.loads((run / "summary.json").read_text())
    if summary["ending"] not in ("goal", "over", "failure", "nothing_worthwhile", "step_limit"):
        raise RuntimeError(f"{deploy_file.name}, seed {seed}: {ended.stderr}")
    world = [json.loads(line) for line in (run / "world.jsonl").read_text().splitlines()]
    show = [BIN / "aos", "decisions", "--run", run, "--json", "--no-follow"]
    records = [json.loads(line) for line in subprocess.check_output(show, text=True).splitlines()]
    outcomes = [record["outcome"] for record in records if record.get("outcome")]
    running_s = sum(outcome["ended_ns"] - outcome["started_ns"] for outcome in outcomes) / 1e9
    return {
        "seed": seed,
        "ending": summary["ending"],
        "steps": [
            f"{action} > {response}"
            for action, response in zip(summary["actions"], summary["responses"], strict=True)
        ],
        "truth": {key: value for key, value in world[-1].items() if key not in NOT_SHOWN},
        "faults": [fault for entry in world for fault in entry["drawn_faults"]],
        "simulated_s": world[-1]["time_s"],
        "speed": round(world[-1]["time_s"] / running_s, 1),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("name", help="of a file in deploy, without .yaml")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--json", action="store_true", help="one JSON object a line")
    options = parser.parse_args()
    endings: Counter[str] = Counter()
    first: Counter[str] = Counter()
    speeds = []
    with tempfile.TemporaryDirectory() as folder:
        deploy_file = on_a_free_port(options.name, Path(folder))
        for seed in range(options.first_seed, options.first_seed + options.seeds):
            line = mission(deploy_file, seed)
            endings[line["ending"]] += 1
            first[line["steps"][0].split(" > ")[0] if line["steps"] else "none"] += 1
            speeds.append(line["speed"])
            if options.json:
                print(json.dumps(line), flush=True)
            else:
                print(f"{seed}: {line['ending']}, {line['simulated_s']} s, {line['speed']} times real time")
                print(f"   {', '.join(line['steps'])}")
                print(f"   {line['truth']} {Counter(line['faults'])}", flush=True)
    speeds.sort()
    print(
        f"{options.name}: {dict(endings)}, first {dict(first)}, "
        f"median speed {speeds[len(speeds) // 2]} times real time",
        file=sys.stderr,
    )


if __name__ == "__main__":
    main()
