"""Prints what planners decide on bundles with budgets in simulations, so that two versions can be compared.

  python -m tests.decisions > before.txt
  python -m tests.decisions --bundle deploy/bundles/bench/tiger --planner pomcp --steps 10
  diff before.txt after.txt

A line is a decision of a simulated mission, with every number to its last bit, and without times. The same
version prints the same lines on every machine. With CXX="g++ -DAOS_CHECKED" an engine ends where it looks
beyond a list of its own.
"""

import argparse
import asyncio
import sys
from pathlib import Path

import msgspec

from aos_deploy.bundles.engine import engine_of_bundle
from aos_protocol.errors import AosError
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine
from aos_solver.child.questions.missions import UNRESTRICTED, Planner, Restriction
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission

BUNDLES = Path(__file__).parents[1] / "deploy" / "bundles"
USUAL = (
    "armadillo-finer",
    "../armadillo-finer-blind.yaml",
    "cleanlab",
    "errand",
    "tictactoe",
    "turtlebot",
    "turtlebot-noisy",
    "bench/laser",
    "bench/lightdark",
    "bench/lightdark-normal",
    "bench/maint10",
    "bench/navigation",
    "bench/pocman",
    "bench/rocksample-7-8",
    "bench/ship10",
    "bench/tag",
    "bench/tiger",
)
PLANNERS: tuple[Planner, ...] = ("auto", "pomcp", "despot", "sarsop")
NEVER = 2.0
"""A probability that no belief reaches: a mission ends when its world does."""
TIMES = ("seconds", "cpu_seconds", "preparation_s", "search_s")


class Recorded(Search, frozen=True, kw_only=True):
    """A search that keeps the plans that it makes."""

    plans: list[Plan]

    async def run(self, engine: Engine, step: int, within: Restriction = UNRESTRICTED) -> Plan:
        """Decide as a search does, and keep the plan."""
        plan = await super().run(engine, step, within)
        self.plans.append(plan)
        return plan


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.decisions",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--bundle", action="append", type=Path, metavar="DIR", help="may be repeated")
    parser.add_argument("--planner", action="append", choices=PLANNERS, help="may be repeated")
    parser.add_argument("--simulations", type=int, default=300, metavar="N", help="of a decision")
    parser.add_argument("--steps", type=int, default=4, metavar="N", help="of a mission")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    asyncio.run(_print_all(arguments))
    return 0


async def _print_all(arguments: argparse.Namespace) -> None:
    limits = MissionLimits(goal_probability=NEVER, step_limit=arguments.steps, stop_below_value=None)
    for bundle in arguments.bundle or [BUNDLES / name for name in USUAL]:
        async with engine_of_bundle(bundle, arguments.seed) as engine:
            for planner in arguments.planner or PLANNERS:
                plans: list[Plan] = []
                search = Recorded(
                    simulations=arguments.simulations, seed=arguments.seed, planner=planner, plans=plans
                )
                try:
                    await simulate_mission(engine, search, limits)
                except AosError as error:
                    print(bundle.name, planner, f"error: {error}")
                for step, plan in enumerate(plans, start=1):
                    print(bundle.name, planner, step, _text_of(plan))
                sys.stdout.flush()


def _text_of(plan: Plan) -> str:
    told = msgspec.to_builtins(plan)
    return msgspec.json.encode({name: told[name] for name in told if name not in TIMES}).decode()


if __name__ == "__main__":
    sys.exit(main())
