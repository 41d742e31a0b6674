"""Plants that dry out and a tank: nothing is rewarded, what is neglected costs."""

from .writing import Bundle, BundleWriter

_TANK = 6  # fillings that the robot carries


def _environment(bays: int) -> str:
    plants = 2 * bays
    return f"""horizon: 60
discount: 0.97

state_variable: int at
default_value: {bays}

state_variable: int tank
default_value: {_TANK}

state_variable: int moisture []
code:
state.moisture.assign({plants}, 3);

state_variable: bool is_thirsty []
code:
state.is_thirsty.assign({plants}, false);

initial_belief:
for (int i = 0; i < {plants}; i++) {{
    state.moisture[i] = 2 + AOS.SampleDiscrete({{0.4, 0.4, 0.2}});
    state.is_thirsty[i] = AOS.Bernoulli(0.3);
}}

extrinsic_code:
for (int i = 0; i < {plants}; i++) {{
    bool dries = AOS.Bernoulli(state.is_thirsty[i] ? 0.14 : 0.05);
    if (dries && state.moisture[i] > 0) state_.moisture[i] = state.moisture[i] - 1;
}}

reward_code:
for (int i = 0; i < {plants}; i++) __reward -= state.moisture[i] == 0 ? 1 : 0;
"""


def greenhouse(bays: int = 5) -> Bundle:
    """Two plants in each bay dry out, some of them sooner; the robot drives, waters, probes and refills."""
    plants = 2 * bays
    writer = BundleWriter(f"greenhouse{bays}", _environment(bays))
    drive = """__reward = -0.3;
if (AOS.Bernoulli(0.95)) state__.at = place;
__moduleResponse = state__.at == place ? arrived : blocked;"""
    writer.skill("drive", drive, over={"place": str(bays + 1)})
    water = """__reward = -0.2;
if (plant / 2 != state.at || state.tank == 0) {
    __moduleResponse = refused;
} else {
    // The valve sticks in one of ten cases, and nobody notices.
    if (AOS.Bernoulli(0.9)) state__.moisture[plant] = 4;
    state__.tank = state.tank - 1;
    __moduleResponse = watered;
}"""
    writer.skill("water", water, over={"plant": str(plants)})
    probe = """__reward = -0.1;
bool seems_dry = AOS.Bernoulli(0.85) == (state.moisture[plant] <= 1);
__moduleResponse = plant / 2 != state.at ? refused : seems_dry ? dry : moist;"""
    writer.skill("probe", probe, over={"plant": str(plants)})
    refill = f"""__reward = -0.5;
if (state.at == {bays}) state__.tank = {_TANK};
__moduleResponse = state.at == {bays} ? full : refused;"""
    writer.skill("refill", refill)
    return writer.files
