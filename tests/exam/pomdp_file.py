"""Problems as `.pomdp` files, for other solvers.

There an observation depends on the state that an action leads to. Where here it depends on more, such states
are written once for each sensing that they are reached by.
"""

from .problem import RUNNING, Problem


def pomdp_text(problem: Problem) -> str:
    """The problem in Cassandra's format; the last state is the end, which is worth nothing."""
    actions = range(len(problem.world.actions))
    sensings_of: dict[tuple[int, int], set[int]] = {}  # by action and next state
    for (_, action), row in problem.rows.items():
        for _, after, sensing, _ in row:
            sensings_of.setdefault((action, after), set()).add(sensing)
    copies: dict[tuple[int, int], int] = {}  # by state and which of its sensings: as many as any action needs
    for state in range(len(problem.states)):
        most = max((len(sensings_of.get((action, state), ())) for action in actions), default=1)
        if problem.states[state][1] == RUNNING:
            for copy in range(max(most, 1)):
                copies[state, copy] = len(copies)
    end = len(copies)
    observations = sorted({observation for sensing in problem.sensings for observation, _ in sensing})
    index = {observation: number for number, observation in enumerate(observations)}
    starts = [0.0] * (end + 1)
    for state, odds in problem.starts:
        starts[copies[state, 0]] += odds
    lines = [
        f"# {problem.name}",
        f"discount: {problem.world.discount!r}",
        "values: reward",
        f"states: {end + 1}",
        f"actions: {len(problem.world.actions)}",
        f"observations: {len(observations) + 1}",
        "start: " + " ".join(map(repr, starts)),
        f"T: * : {end} : {end} 1.0",
        f"O: * : * : {len(observations)} 0.0",
        f"O: * : {end} : {len(observations)} 1.0",
    ]
    for (state, copy), number in copies.items():
        for action in actions:
            sensings = sorted(sensings_of.get((action, state), ()))
            if not sensings:
                lines.append(f"O: {action} : {number} : 0 1.0")
                continue
            for observation, odds in problem.sensings[sensings[min(copy, len(sensings) - 1)]]:
                lines.append(f"O: {action} : {number} : {index[observation]} {odds!r}")
    for (state, _), number in copies.items():
        for action in actions:
            reward = 0.0
            moves: dict[int, float] = {}
            for odds, after, sensing, gained in problem.rows[state, action]:
                reward += odds * gained
                target = end
                if problem.states[after][1] == RUNNING:
                    target = copies[after, sorted(sensings_of[action, after]).index(sensing)]
                moves[target] = moves.get(target, 0.0) + odds
            lines += [f"T: {action} : {number} : {after} {odds!r}" for after, odds in moves.items()]
            if reward != 0:
                lines.append(f"R: {action} : {number} : * : * {reward!r}")
    return "\n".join([*lines, ""])
