"""A box on one of three shelves that expires; moves and grips fail by thresholds of continuous draws."""

from .writing import Bundle, BundleWriter

_ODDS = (0.5, 0.3, 0.2)
_LOOK = 0.85


def shelf(steps: int = 7) -> Bundle:
    writer = BundleWriter(
        "shelf",
        f"""horizon: 10
discount: 0.95

state_variable: int box

state_variable: int at

state_variable: int left
default_value: {steps}

state_variable: bool has_it

initial_belief:
vector<double> odds{{{", ".join(map(str, _ODDS))}}};
state.box = AOSUtils::SampleDiscrete(odds);

extrinsic_code:
state_.left = state.left - 1;

reward_code:
if (state.has_it) {{
    __reward = 30;
    __isGoalState = true;
}}
if (state.left <= 0) __isFailureState = true;
""",
    )
    go = """__reward = -1;
bool fails = AOS.SampleNormal(0, 1) > 1.0;
if (!fails) state__.at = shelf;
__moduleResponse = fails ? failed : there;"""
    writer.skill("go", go, over={"shelf": "3"})
    look = f"""__reward = -0.5;
bool is_it = state.at == state.box;
__moduleResponse = AOS.Bernoulli({_LOOK}) == is_it ? box_there : no_box;"""
    writer.skill("look", look)
    grab = """bool holds = state.at == state.box && AOS.SampleUniform(0, 1) < 0.8;
__reward = holds ? -1 : -4;
if (holds) state__.has_it = true;
__moduleResponse = holds ? got : missed;"""
    writer.skill("grab", grab)
    return writer.files
