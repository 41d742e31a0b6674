from .writing import Bundle, BundleWriter

_ROOMS = 8  # the parcels wait in room 0; rooms 4 to 7 are upstairs
_BATTERY = 14
_BREAKS, _MENDED = 0.05, 0.3
_TRUE = 0.8  # of the answers about a parcel
_HORIZON, _DISCOUNT = 80, 0.98


def _environment(parcels: int) -> str:
    return f"""horizon: {_HORIZON}
discount: {_DISCOUNT}

state_variable: int at

state_variable: int battery
default_value: {_BATTERY}

state_variable: bool lift_is_broken

state_variable: int receiver []
code:
state.receiver.assign({parcels}, 0);

state_variable: bool held []
code:
state.held.assign({parcels}, false);

state_variable: bool brought []
code:
state.brought.assign({parcels}, false);

initial_belief:
vector<double> free(7, 1.0);
for (int i = 0; i < {parcels}; i++) {{
    int room = AOSUtils::SampleDiscrete(free);
    free[room] = 0;
    state.receiver[i] = room + 1;
}}

extrinsic_code:
bool changes = AOS.Bernoulli(state.lift_is_broken ? {_MENDED} : {_BREAKS});
if (changes) state_.lift_is_broken = !state.lift_is_broken;

reward_code:
if (state.battery < 0) {{
    __isFailureState = true;
    __reward = -40;
}}

reward_code:
bool all = true;
for (int i = 0; i < {parcels}; i++) if (!state.brought[i]) all = false;
if (all) {{
    __isGoalState = true;
    __reward = 20;
}}
"""


def delivery(parcels: int = 6) -> Bundle:
    """Parcels with unknown receivers, who differ; a lift that breaks and is mended; a battery."""
    writer = BundleWriter(f"delivery{parcels}", _environment(parcels))
    ride = """bool takes_lift = to / 4 != state.at / 4;
state__.battery = state.battery - (takes_lift ? 2 : 1);
__reward = takes_lift ? -1 : -0.5;
if (takes_lift && state.lift_is_broken) {
    __moduleResponse = stuck;
} else {
    state__.at = to;
    __moduleResponse = arrived;
}"""
    writer.skill("ride", ride, over={"to": str(_ROOMS)})
    what = {"what": str(parcels)}
    take = f"""int carried = 0;
for (int i = 0; i < {parcels}; i++) carried += state.held[i];
if (state.at == 0 && carried < 2 && !state.held[what] && !state.brought[what]) {{
    state__.held[what] = true;
    __reward = -0.5;
    __moduleResponse = taken;
}} else {{
    __reward = -1;
    __moduleResponse = refused;
}}"""
    writer.skill("take", take, over=what)
    hand = """if (state.held[what] && state.receiver[what] == state.at) {
    state__.held[what] = false;
    state__.brought[what] = true;
    __reward = 10;
    __moduleResponse = thanks;
} else {
    __reward = -3;
    __moduleResponse = not_mine;
}"""
    writer.skill("hand", hand, over=what)
    ask = f"""__reward = -0.3;
int told = state.receiver[what];
if (!AOS.Bernoulli({_TRUE})) told = 1 + (told + AOSUtils::SampleDiscrete(vector<double>(6, 1.0))) % 7;
__moduleResponse = told == 1 ? room1 : told == 2 ? room2 : told == 3 ? room3 : told == 4 ? room4
    : told == 5 ? room5 : told == 6 ? room6 : room7;"""
    writer.skill("ask", ask, over=what)
    writer.charger(_BATTERY)
    return writer.files
