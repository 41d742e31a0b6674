"""A robot with a battery and a bin that keeps rooms clean and is paid for nothing."""

from .writing import Bundle, BundleWriter

_BATTERY, _CHARGE = 24, 8
_BIN = 4
_BUSY, _QUIET = 0.12, 0.04  # how often a room becomes dirtier
_MOVES, _CLEANS, _BROUGHT_HOME = 0.9, 0.85, 0.1
_DISCOUNT = 0.97


def _environment(rooms: int) -> str:
    return f"""horizon: 60
discount: {_DISCOUNT}

state_variable: int at

state_variable: int battery
default_value: {_BATTERY}

state_variable: int bin

state_variable: int dirt []
code:
state.dirt.assign({rooms}, 0);

state_variable: bool is_busy []
code:
state.is_busy.assign({rooms}, false);

initial_belief:
for (int i = 0; i < {rooms}; i++) {{
    state.dirt[i] = AOS.SampleDiscrete({{0.5, 0.3, 0.2}});
    state.is_busy[i] = AOS.Bernoulli(0.4);
}}

extrinsic_code:
for (int i = 0; i < {rooms}; i++) {{
    bool more = AOS.Bernoulli(state.is_busy[i] ? {_BUSY} : {_QUIET});
    if (more && state.dirt[i] < 3) state_.dirt[i] = state.dirt[i] + 1;
}}
// Somebody finds the robot with an empty battery, and brings it home.
bool is_found = AOS.Bernoulli({_BROUGHT_HOME});
if (state.battery == 0 && state.at > 0 && is_found) {{
    state_.at = 0;
    state_.battery = {_CHARGE};
}}

reward_code:
for (int i = 0; i < {rooms}; i++) __reward -= 0.25 * state.dirt[i];
if (state.battery == 0 && state.at > 0) __reward -= 1;
"""


def cleaning(rooms: int = 7) -> Bundle:
    """Rooms along a corridor become dirty unseen; a robot goes, looks, cleans, and charges at its dock."""
    writer = BundleWriter(f"cleaning{rooms}", _environment(rooms))
    go = f"""__reward = -0.05;
if (state_.battery == 0) {{
    __moduleResponse = refused;
}} else {{
    bool moves = AOS.Bernoulli({_MOVES});
    if (moves) state__.at = std::clamp(state_.at + (onward ? 1 : -1), 0, {rooms});
    state__.battery = state_.battery - 1;
    __moduleResponse = moves ? moved : slipped;
}}"""
    writer.skill("go", go, over={"onward": "2"})
    clean = f"""__reward = -0.1;
if (state_.battery < 2 || state_.at == 0 || state_.bin == {_BIN}) {{
    __moduleResponse = refused;
}} else {{
    int room = state_.at - 1;
    if (AOS.Bernoulli({_CLEANS})) state__.dirt[room] = std::max(state_.dirt[room] - 2, 0);
    state__.bin = state_.bin + 1;
    state__.battery = state_.battery - 2;
    __moduleResponse = cleaned;
}}"""
    writer.skill("clean", clean)
    look = """__reward = -0.02;
if (state_.at == 0) {
    __moduleResponse = refused;
} else {
    bool is_dirty = state_.dirt[state_.at - 1] > 0;
    __moduleResponse = AOS.Bernoulli(0.85) == is_dirty ? dirty : tidy;
}"""
    writer.skill("look", look)
    home = "__moduleResponse = state_.at == 0 ? done : refused;\n"
    writer.skill("empty_bin", f"__reward = -0.1;\nif (state_.at == 0) state__.bin = 0;\n{home}")
    charge = f"if (state_.at == 0) state__.battery = std::min(state_.battery + {_CHARGE}, {_BATTERY});\n"
    writer.skill("charge", charge + home)
    return writer.files
