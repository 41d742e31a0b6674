"""Two towers of blocks that are taken down and built anew, with grips that slip."""

import random

from .writing import Bundle, BundleWriter

_SLIPS = 0.1
_TABLE, _HELD = -1, -2
_DISCOUNT = 0.99


def _start(count: int) -> list[int]:
    """Returns what each block stands on: two towers, in an order that the number of blocks alone decides."""
    blocks = list(range(count))
    random.Random(count).shuffle(blocks)
    on = [_TABLE] * count
    for place, block in enumerate(blocks[:-1]):
        on[block] = _TABLE if place == count // 2 - 1 else blocks[place + 1]
    return on


def towers(count: int = 10) -> Bundle:
    """Blocks are picked and put on one another or on the table; all have to stand in order."""
    goal = f"(i == {count // 2 - 1} || i == {count - 1} ? {_TABLE} : i + 1)"
    placed = "".join(f"state.on[{block}] = {below};\n" for block, below in enumerate(_start(count)))
    writer = BundleWriter(
        f"towers{count}",
        f"""horizon: 80
discount: {_DISCOUNT}

state_variable: int on []
code:
state.on.assign({count}, {_TABLE});

state_variable: int held

initial_belief:
state.held = -1;
{placed}
reward_code:
bool all_on = true;
for (int i = 0; i < {count}; i++) if (state.on[i] != {goal}) all_on = false;
if (all_on) {{
    __isGoalState = true;
    __reward = 100;
}}
""",
    )
    free = f"""__reward = -0.4;
__moduleResponse = stuck;
bool is_free = state.held != block;
for (int i = 0; i < {count}; i++) if (state.on[i] == block) is_free = false;
"""
    pick = f"""{free}bool slips = AOS.Bernoulli({_SLIPS});
if (is_free && state.held < 0 && !slips) {{
    state__.on[block] = {_HELD};
    state__.held = block;
    __moduleResponse = done;
}}"""
    writer.skill("pick", pick, over={"block": str(count)})
    put = f"""{free}if (is_free && state.held >= 0) {{
    state__.on[state.held] = block;
    state__.held = -1;
    __moduleResponse = done;
}}"""
    writer.skill("put", put, over={"block": str(count)})
    lay = f"""__reward = -0.4;
__moduleResponse = stuck;
if (state.held >= 0) {{
    state__.on[state.held] = {_TABLE};
    state__.held = -1;
    __moduleResponse = done;
}}"""
    writer.skill("lay", lay)
    return writer.files
