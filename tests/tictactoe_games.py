"""Games of the shipped documents: `python tests/tictactoe_games.py 50 --opponent perfect`.

The planner decides as in a mission, with the shipped budget. The other player need not be the documents' one.
"""

import argparse
import asyncio
import random
import sys
from collections import Counter
from pathlib import Path

from aos_deploy.bundles.engine import engine_of_bundle
from aos_skills.pybullet.worlds.tictactoe.rules import (
    EMPTY_BOARD,
    best_moves,
    empty_cells,
    is_over,
    marked,
    winner,
)
from aos_solver.child.engine import Engine

BUNDLES = Path(__file__).parent.parent / "deploy" / "bundles"
SIMULATIONS = 100_000


async def game(
    engine: Engine, opponent: str, chance: random.Random, seed: int, dry_centre: float
) -> tuple[str, str]:
    """One game that the robot begins: who won (`O`, `X` or `draw`), and the moves."""
    await engine.reset_belief()
    board, moves, step = EMPTY_BOARD, "", 0
    while True:
        plan = await engine.plan(simulations=SIMULATIONS, seed=seed * 1000 + step, planner="auto")
        action = plan.best.action
        step += 1
        if action == "look":
            cells = best_moves(board, "X") if opponent == "perfect" else empty_cells(board)
            cell = chance.choice(cells)
            board, moves = marked(board, cell, "X"), f"{moves} x{cell}"
            response = board
        else:
            cell = int(action.removeprefix("draw(cell=").removesuffix(")"))
            assert board[cell] == "?", f"{action} on {board}"
            is_drawn = cell != 4 or chance.random() >= dry_centre
            board = marked(board, cell, "O") if is_drawn else board
            moves += f" o{cell}" if is_drawn else f" -{cell}"
            response = "drawn" if is_drawn else "not_drawn"
        if is_over(board):
            return winner(board) or "draw", moves.strip()
        await engine.update(action, response)


async def play(bundle: str, games: int, opponent: str, dry_centre: float) -> None:
    endings: Counter[str] = Counter()
    counts: Counter[tuple[str, str]] = Counter()
    chance = random.Random(f"{bundle} {opponent}")
    async with engine_of_bundle(BUNDLES / bundle, 1) as engine:
        for number in range(games):
            ending, moves = await game(engine, opponent, chance, number + 1, dry_centre)
            endings[ending] += 1
            counts[ending, moves] += 1
            sys.stderr.write(f"\r{number + 1} of {games} games")
    sys.stderr.write("\n")
    for (ending, moves), times in counts.most_common():
        print(f"{times:4} {ending:5} {moves}")
    print(f"{bundle}, {games} games against a {opponent} player: {dict(endings)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("games", type=int, nargs="?", default=50)
    parser.add_argument("--bundle", default="tictactoe")
    parser.add_argument("--opponent", choices=["random", "perfect"], default="perfect")
    parser.add_argument("--dry-centre", type=float, default=0.0)
    options = parser.parse_args()
    asyncio.run(play(options.bundle, options.games, options.opponent, options.dry_centre))


if __name__ == "__main__":
    main()
