"""A drone with a battery takes a photo in an unknown cell and comes back; a wind blows east.

The values of all its states can be computed without observations, and promise far too much.
"""

from .writing import Bundle, BundleWriter

_DISCOUNT = 0.98
_CHARGE, _WIND, _FELT = 70, 0.15, 0.95
_SEEN = 0.85  # what is below the drone, or up to two cells away; else nothing is seen


def _environment(size: int) -> str:
    return f"""horizon: 70
discount: {_DISCOUNT}

state_variable: int x

state_variable: int y

state_variable: int charge
default_value: {_CHARGE}

state_variable: int at_x

state_variable: int at_y

state_variable: bool has_photo

state_variable: bool has_landed

initial_belief:
state.at_x = AOSUtils::SampleDiscrete(vector<double>({size}, 1.0));
state.at_y = AOSUtils::SampleDiscrete(vector<double>({size}, 1.0));

reward_code:
if (state.has_landed) {{
    bool is_home = state.x == 0 && state.y == 0;
    __reward = is_home ? (state.has_photo ? 60 : 0) : -15;
    __isGoalState = is_home;
    __isFailureState = !is_home;
}} else if (state.charge <= 0) {{
    __reward = -20;
    __isFailureState = true;
}}
"""


def photo(size: int = 12) -> Bundle:
    """The drone starts at home, in a corner."""
    writer = BundleWriter(f"photo{size}", _environment(size))
    fly = f"""__reward = -0.2;
bool is_blown = AOS.Bernoulli({_WIND});
state__.x = std::max(0, std::min(state.x + (direction == 1) - (direction == 3) + is_blown, {size - 1}));
state__.y = std::max(0, std::min(state.y + (direction == 0) - (direction == 2), {size - 1}));
state__.charge = state.charge - 1;
__moduleResponse = AOS.Bernoulli({_FELT}) == is_blown ? blown : calm;"""
    writer.skill("fly", fly, over={"direction": "4"})
    look = f"""__reward = -0.2;
state__.charge = state.charge - 1;
int distance = std::max(abs(state.x - state.at_x), abs(state.y - state.at_y));
__moduleResponse = !AOS.Bernoulli({_SEEN}) || distance > 2 ? unseen : distance == 0 ? below : near;"""
    writer.skill("look", look)
    locate = """__reward = -0.2;
state__.charge = state.charge - 1;
__moduleResponse = state.x < 4 ? west : state.x < 8 ? middle : east;"""
    writer.skill("locate", locate)
    take = """bool is_there = state.x == state.at_x && state.y == state.at_y;
__reward = is_there ? -0.2 : -2;
state__.charge = state.charge - 1;
if (is_there) state__.has_photo = true;
__moduleResponse = is_there ? taken : missed;"""
    writer.skill("take", take)
    writer.skill("land", "state__.has_landed = true;\n__moduleResponse = landed;")
    return writer.files
