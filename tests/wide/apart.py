"""Problems that the planner was not made with: the documents, in the sizes that are asked for."""

from collections.abc import Callable

from .delivery import delivery
from .writing import Bundle, BundleWriter


def plant(count: int = 16) -> Bundle:
    """Machines that may be worn or broken: listen (noisy), open, oil, replace; then start the plant, once."""
    writer = BundleWriter(
        f"plant{count}",
        f"""horizon: 100
discount: 0.995

state_variable: int fault []
code:
state.fault.assign({count}, 0);

state_variable: bool runs

initial_belief:
vector<double> odds{{0.6, 0.25, 0.15}};
for (int i = 0; i < {count}; i++) state.fault[i] = AOSUtils::SampleDiscrete(odds);

reward_code:
if (state.runs) {{
    __isGoalState = true;
    __reward = 60;
    for (int i = 0; i < {count}; i++) __reward -= state.fault[i] == 0 ? 0 : state.fault[i] == 1 ? 4 : 10;
}}
""",
    )
    one = {"machine": str(count)}
    tells = "__moduleResponse = {0} == 0 ? fine : {0} == 1 ? worn : broken;"
    listen = (
        "__reward = -0.2;\nint heard = state.fault[machine];\n"
        "if (!AOS.Bernoulli(0.65)) "
        "heard = (heard + 1 + AOSUtils::SampleDiscrete(vector<double>{0.5, 0.5})) % 3;\n"
    )
    responses = ["fine", "worn", "broken"]
    writer.skill("listen", responses, listen + tells.format("heard"), over=one)
    writer.skill("open", responses, "__reward = -1.5;\n" + tells.format("state.fault[machine]"), over=one)
    oil = (
        "__reward = -1;\nif (state.fault[machine] == 1) state__.fault[machine] = 0;\n__moduleResponse = done;"
    )
    writer.skill("oil", ["done"], oil, over=one)
    replace = "__reward = -5;\nstate__.fault[machine] = 0;\n__moduleResponse = done;"
    writer.skill("replace", ["done"], replace, over=one)
    writer.skill("start", ["started"], "state__.runs = true;\n__moduleResponse = started;")
    return writer.files


def drone(size: int = 12) -> Bundle:
    """A drone that drifts with an unknown wind, has ranges to beacons, and shall land on a pad."""
    writer = BundleWriter(
        f"drone{size}",
        f"""horizon: 50
discount: 0.98

state_variable: double x

state_variable: double y

state_variable: double wind_x

state_variable: double wind_y

state_variable: bool has_landed

initial_belief:
state.x = AOS.SampleUniform(0, {size});
state.y = AOS.SampleUniform(0, {size});
state.wind_x = AOS.SampleNormal(0, 0.3);
state.wind_y = AOS.SampleNormal(0, 0.3);

reward_code:
if (state.has_landed) {{
    bool is_there = pow(state.x - {size // 2}, 2) + pow(state.y - {size // 2}, 2) < 1.44;
    __reward = is_there ? 60 : -60;
    __isGoalState = is_there;
    __isFailureState = !is_there;
}}
""",
    )
    drift = """state__.x = state.x + state.wind_x + AOS.SampleNormal(0, 0.1);
state__.y = state.y + state.wind_y + AOS.SampleNormal(0, 0.1);
"""
    fly = f"""__reward = -0.5;
{drift}state__.x = state__.x + (direction == 1) - (direction == 3);
state__.y = state__.y + (direction == 0) - (direction == 2);
__moduleResponse = flown;"""
    writer.skill("fly", ["flown"], fly, over={"direction": "4"})
    measure = f"""__reward = -0.2;
{drift}double beacon_x = beacon == 1 ? {size} : 0;
double beacon_y = beacon == 2 ? {size} : 0;
double range = sqrt(pow(state__.x - beacon_x, 2) + pow(state__.y - beacon_y, 2));
__moduleResponse = measured;
__observed.metres = AOS.SampleNormal(range, 0.3);"""
    writer.skill("measure", ["measured"], measure, over={"beacon": "3"}, numbers=["metres"])
    writer.skill("land", ["landed"], "state__.has_landed = true;\n__moduleResponse = landed;")
    return writer.files


def _courier_environment(addresses: int) -> str:
    return f"""horizon: 60
discount: 0.98

state_variable: int at

state_variable: int odometer

state_variable: int charge
default_value: 30

state_variable: bool home []
code:
state.home.assign({addresses + 1}, false);

state_variable: bool served []
code:
state.served.assign({addresses + 1}, false);

initial_belief:
for (int i = 1; i <= {addresses}; i++) state.home[i] = AOS.Bernoulli(0.5);

extrinsic_code:
for (int i = 1; i <= {addresses}; i++) if (AOS.Bernoulli(0.04)) state_.home[i] = !state.home[i];

reward_code:
if (state.charge < 0) {{
    __isFailureState = true;
    __reward = -40;
}}

reward_code:
bool all = true;
for (int i = 1; i <= {addresses}; i++) if (!state.served[i]) all = false;
if (all) {{
    __isGoalState = true;
    __reward = 10;
}}
"""


def courier(addresses: int = 6) -> Bundle:
    """A courier with a battery and an odometer without an end; people come and go."""
    writer = BundleWriter(f"courier{addresses}", _courier_environment(addresses))
    go = """int way = abs(place - state.at) + 1;
state__.at = place;
state__.odometer = state.odometer + way;
state__.charge = place == 0 ? 30 : state.charge - way;
__reward = -0.3 * way;
__moduleResponse = arrived;"""
    writer.skill("go", ["arrived"], go, over={"place": str(addresses + 1)})
    ring = """__reward = -0.2;
if (state.at == 0) {
    __moduleResponse = silence;
} else {
    __moduleResponse = AOS.Bernoulli(state.home[state.at] ? 0.9 : 0.1) ? steps : silence;
}"""
    writer.skill("ring", ["steps", "silence"], ring)
    hand_over = """if (state.at > 0 && state.home[state.at] && !state.served[state.at]) {
    state__.served[state.at] = true;
    __reward = 10;
    __moduleResponse = handed_over;
} else {
    __reward = -4;
    __moduleResponse = nobody;
}"""
    writer.skill("hand_over", ["handed_over", "nobody"], hand_over)
    return writer.files


def _arms_environment(count: int) -> str:
    return f"""horizon: 80
discount: 0.98

state_variable: bool good []
code:
state.good.assign({2 * count}, false);

state_variable: bool gone []
code:
state.gone.assign({2 * count}, false);

state_variable: int held []
code:
state.held.assign(2, -1);

state_variable: int joined

initial_belief:
for (int i = 0; i < {2 * count}; i++) state.good[i] = AOS.Bernoulli(0.6);

reward_code:
if (state.joined >= 4) {{
    __isGoalState = true;
    __reward = 20;
}}
"""


def arms(count: int = 8) -> Bundle:
    """Two arms with bolts and plates, good or bad: pick, inspect, put away, and join two good ones."""
    writer = BundleWriter(f"arms{count}", _arms_environment(count))
    arm = {"arm": "2"}
    pick = f"""__reward = -0.5;
int which = arm * {count} + part;
if (state.held[arm] >= 0 || state.gone[which]) {{
    __moduleResponse = refused;
}} else {{
    state__.held[arm] = which;
    state__.gone[which] = true;
    __moduleResponse = picked;
}}"""
    writer.skill("pick", ["picked", "refused"], pick, over=arm | {"part": str(count)})
    inspect = """__reward = -0.3;
if (state.held[arm] < 0) {
    __moduleResponse = empty;
} else {
    __moduleResponse = AOS.Bernoulli(state.good[state.held[arm]] ? 0.85 : 0.2) ? looks_good : looks_bad;
}"""
    writer.skill("inspect", ["looks_good", "looks_bad", "empty"], inspect, over=arm)
    put = "__reward = -0.5;\nstate__.held[arm] = -1;\n__moduleResponse = done;"
    writer.skill("put_away", ["done"], put, over=arm)
    join = """if (state.held[0] < 0 || state.held[1] < 0) {
    __reward = -2;
    __moduleResponse = nothing;
} else if (state.good[state.held[0]] && state.good[state.held[1]]) {
    __reward = 10;
    state__.joined = state.joined + 1;
    state__.held[0] = -1;
    state__.held[1] = -1;
    __moduleResponse = holds;
} else {
    __reward = -10;
    state__.held[0] = -1;
    state__.held[1] = -1;
    __moduleResponse = broke;
}"""
    writer.skill("join", ["holds", "broke", "nothing"], join)
    return writer.files


APART: dict[str, Callable[[int], Bundle]] = {
    "plant": plant,
    "drone": drone,
    "courier": courier,
    "arms": arms,
    "delivery": delivery,
}
APART_SIZES = {"plant": 16, "drone": 12, "courier": 6, "arms": 8, "delivery": 6}
