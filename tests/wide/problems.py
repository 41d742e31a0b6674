from .writing import Bundle, BundleWriter


def parcels(count: int = 14) -> Bundle:
    """Many parcels, each for one of three places: scan them (noisy), open them (dear), send them off."""
    writer = BundleWriter(
        f"parcels{count}",
        f"""horizon: 80
discount: 0.97

state_variable: int place []
code:
state.place.assign({count}, 0);

state_variable: bool gone []
code:
state.gone.assign({count}, false);

initial_belief:
for (int i = 0; i < {count}; i++) state.place[i] = AOSUtils::SampleDiscrete(vector<double>{{0.5, 0.3, 0.2}});

reward_code:
bool over = true;
for (int i = 0; i < {count}; i++) if (!state.gone[i]) over = false;
if (over) {{
    __isGoalState = true;
    __reward = 5;
}}
""",
    )
    one = {"parcel": str(count)}
    told = "__moduleResponse = {0} == 0 ? first : {0} == 1 ? second : third;"
    guarded = "if (state.gone[parcel]) {{\n    __moduleResponse = not_there;\n}} else {{\n{0}\n}}"
    scan = (
        "int seen = state.place[parcel];\n"
        "if (!AOS.Bernoulli(0.7)) "
        "seen = (seen + 1 + AOSUtils::SampleDiscrete(vector<double>{0.5, 0.5})) % 3;\n"
    )
    writer.skill("scan", "__reward = -0.4;\n" + guarded.format(scan + told.format("seen")), over=one)
    opened = told.format("state.place[parcel]")
    writer.skill("open", "__reward = -2;\n" + guarded.format(opened), over=one)
    send = (
        "__reward = state.place[parcel] == where ? 6 : -8;\n"
        "state__.gone[parcel] = true;\n"
        "__moduleResponse = sent;"
    )
    over = one | {"where": "3"}
    writer.skill("send", "__reward = -1;\n" + guarded.format(send), over=over)
    return writer.files


def clutter(count: int = 40) -> Bundle:
    """A thing in one of many spots, each of them covered or not: look, lift the cover, pick."""
    writer = BundleWriter(
        f"clutter{count}",
        f"""horizon: {2 * count + 20}
discount: 0.985

state_variable: int place

state_variable: bool covered []
code:
state.covered.assign({count}, false);

state_variable: bool found

initial_belief:
state.place = AOSUtils::SampleDiscrete(vector<double>({count}, {1 / count!r}));
for (int i = 0; i < {count}; i++) state.covered[i] = AOS.Bernoulli(0.4);

reward_code:
if (state.found) {{
    __isGoalState = true;
    __reward = 60;
}}
""",
    )
    spot = {"spot": str(count)}
    look = """__reward = -0.5;
if (state.covered[spot]) {
    __moduleResponse = covered;
} else {
    __moduleResponse = AOS.Bernoulli(spot == state.place ? 0.9 : 0.03) ? thing : nothing;
}"""
    writer.skill("look", look, over=spot)
    lift = "__reward = -1;\nstate__.covered[spot] = false;\n__moduleResponse = lifted;"
    writer.skill("lift", lift, over=spot)
    pick = """if (spot == state.place && !state.covered[spot]) {
    state__.found = true;
    __moduleResponse = picked;
} else {
    __reward = -10;
    __moduleResponse = empty;
}"""
    writer.skill("pick", pick, over=spot)
    return writer.files


def open_field(light: int = 9) -> Bundle:
    """A robot in the open that measures its place better in the north, and shall stop in the south."""
    writer = BundleWriter(
        f"open-field{light}",
        """horizon: 60
discount: 0.97

state_variable: double x

state_variable: double y

state_variable: bool has_stopped

initial_belief:
state.x = AOS.SampleUniform(0, 4);
state.y = AOS.SampleUniform(0, 4);

reward_code:
if (state.has_stopped) {
    bool is_there = pow(state.x - 9, 2) + pow(state.y - 1, 2) < 1;
    __reward = is_there ? 100 : -100;
    __isGoalState = is_there;
    __isFailureState = !is_there;
}
""",
    )
    move = f"""state__.x = state.x + (direction == 1) - (direction == 3) + AOS.SampleNormal(0, 0.1);
state__.y = state.y + (direction == 0) - (direction == 2) + AOS.SampleNormal(0, 0.1);
double deviation = 0.3 + 0.5 * fabs({light} - state__.y);
__moduleResponse = moved;
__observed.east = AOS.SampleNormal(state__.x, deviation);
__observed.north = AOS.SampleNormal(state__.y, deviation);"""
    writer.skill("move", move, over={"direction": "4"})
    writer.skill("stop", "state__.has_stopped = true;\n__moduleResponse = stopped;")
    return writer.files
