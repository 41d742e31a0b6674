from .writing import Bundle, BundleWriter

_WIDE = 4  # rooms in a row; the dock is room 0
_JAMS, _FORCED = 0.25, 0.6
_BATTERY = 24
_SEES, _MISTAKES = 0.9, 0.05
_HEARS = (0.9, 0.5, 0.15)  # by the distance in rooms of the nearer person
_DISCOUNT = 0.985


def _environment(high: int) -> str:
    rooms = _WIDE * high
    return f"""horizon: 80
discount: {_DISCOUNT}

state_variable: int at

state_variable: int battery
default_value: {_BATTERY}

state_variable: int person []
code:
state.person.assign(2, 0);

state_variable: bool is_helped []
code:
state.is_helped.assign(2, false);

// The door to the east of a room, and the one to the south.
state_variable: bool is_jammed []
code:
state.is_jammed.assign({2 * rooms}, false);

initial_belief:
for (int i = 0; i < 2; i++) state.person[i] = 1 + AOSUtils::SampleDiscrete(vector<double>({rooms - 1}, 1.0));
for (int i = 0; i < {2 * rooms}; i++) state.is_jammed[i] = AOS.Bernoulli({_JAMS});

reward_code:
if (state.battery < 0) {{
    __isFailureState = true;
    __reward = -40;
}}

reward_code:
if (state.is_helped[0] && state.is_helped[1]) {{
    __isGoalState = true;
    __reward = 10;
}}
"""


def rescue(high: int = 3) -> Bundle:
    writer = BundleWriter(f"rescue{high}", _environment(high))
    way = f"""int x = state.at % {_WIDE}, y = state.at / {_WIDE};
int to_x = x + (direction == 1) - (direction == 3), to_y = y + (direction == 2) - (direction == 0);
bool is_wall = to_x < 0 || to_x >= {_WIDE} || to_y < 0 || to_y >= {high};
int door = 2 * (std::min(y, to_y) * {_WIDE} + std::min(x, to_x)) + (to_y != y ? 1 : 0);
"""
    go = f"""{way}state__.battery = state.battery - 1;
__reward = -0.3;
if (is_wall || state.is_jammed[door]) {{
    __moduleResponse = blocked;
}} else {{
    state__.at = to_y * {_WIDE} + to_x;
    __moduleResponse = moved;
}}"""
    writer.skill("go", go, over={"direction": "4"})
    force = f"""{way}state__.battery = state.battery - 3;
__reward = -1;
if (!is_wall && AOS.Bernoulli({_FORCED})) {{
    state__.is_jammed[door] = false;
    __moduleResponse = opened;
}} else {{
    __moduleResponse = stuck;
}}"""
    writer.skill("force", force, over={"direction": "4"})
    listen = f"""__reward = -0.2;
double odds = {_MISTAKES};
for (int i = 0; i < 2; i++) {{
    int across = state.person[i] % {_WIDE} - state.at % {_WIDE};
    int far = abs(across) + abs(state.person[i] / {_WIDE} - state.at / {_WIDE});
    double heard = far == 0 ? {_HEARS[0]} : far == 1 ? {_HEARS[1]} : far == 2 ? {_HEARS[2]} : {_MISTAKES};
    if (!state.is_helped[i]) odds = std::max(odds, heard);
}}
__moduleResponse = AOS.Bernoulli(odds) ? voice : silence;"""
    writer.skill("listen", listen)
    here = "bool is_here = false;\n" + (
        "for (int i = 0; i < 2; i++) is_here |= state.person[i] == state.at && !state.is_helped[i];\n"
    )
    look = f"""__reward = -0.2;
{here}__moduleResponse = AOS.Bernoulli(is_here ? {_SEES} : {_MISTAKES}) ? somebody : nobody;"""
    writer.skill("look", look)
    assist = f"""{here}__reward = is_here ? 20 : -3;
for (int i = 0; i < 2; i++) if (state.person[i] == state.at) state__.is_helped[i] = true;
__moduleResponse = is_here ? helped : nobody;"""
    writer.skill("assist", assist)
    writer.charger(_BATTERY)
    return writer.files
