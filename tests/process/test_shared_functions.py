from models import engine_of_text

WRITTEN_OUT = {
    "cart.ef": """project: cart
horizon: 5
define_type: Place
enum_members: Dock, Door, Ramp
state_variable: Place at
state_variable: int load [Place]
initial_belief:
state.at = AOS.Bernoulli(0.5) ? Door : Dock;
state.load[Ramp] = AOS.SampleDiscrete({0.25, 0.5, 0.25});
reward_code:
if (state.at == Ramp && state.load[Ramp] + state.load[Door] < 3) __reward = 4;
""",
    "push.sd": """project: cart
dynamic_model:
if (AOS.Bernoulli(state.at == Dock ? 0.5 : 0.75)) state__.at = Place((state.at + 1) % 3);
if (AOS.Bernoulli(0.125)) state__.load[state__.at]++;
__moduleResponse = AOS.Bernoulli(0.875) == (state__.at == Ramp) ? ramp : elsewhere;
__reward = -1;
""",
    "unload.sd": """project: cart
dynamic_model:
if (state.load[state.at] > 0) state__.load[state.at]--;
__reward = -2;
""",
}
SHARED = {
    "cart.ef": WRITTEN_OUT["cart.ef"]
    .replace(
        "define_type: Place",
        """shared_code:
constexpr double gain = 0.125;
const vector<double> loads = {0.25, 0.5, 0.25};
bool moves(Place from) { return AOS.Bernoulli(from == Dock ? 0.5 : 0.75); }
bool sees(bool is_so) { return is_so == AOSUtils::SampleDiscrete({gain, 1 - gain}); }
int carried(const auto& state) { return state.load[Ramp] + state.load[Door]; }
void advance(auto& state__, Place from) {
    if (moves(from)) state__.at = Place((from + 1) % 3);
    if (AOS.Bernoulli(gain)) state__.load[state__.at]++;
}
define_type: Place""",
    )
    .replace("AOS.SampleDiscrete({0.25, 0.5, 0.25})", "AOSUtils::SampleDiscrete(loads)")
    .replace("state.load[Ramp] + state.load[Door] < 3", "carried(state) < 3"),
    "push.sd": """project: cart
dynamic_model:
advance(state__, state.at);
__moduleResponse = sees(state__.at == Ramp) ? ramp : elsewhere;
__reward = -1;
""",
    "unload.sd": WRITTEN_OUT["unload.sd"],
}


async def test_values_are_exact_and_the_same():
    values = []
    for files in (WRITTEN_OUT, SHARED):
        async with engine_of_text(files) as engine:
            exact = await engine.exact_values()
            summary = await engine.summary()
            values.append({action.action: action.q for action in exact.actions})
            names = {marginal.variable for marginal in summary.marginals}
            assert {"at", "load[Dock]", "load[Ramp]"} <= names
    assert values[0] == values[1]
    assert len(set(values[0].values())) == 2
