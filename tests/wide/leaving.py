"""Problems where to leave at once returns nearly 0, and to look around costs.

Values of seen states promise much in all of them.
"""

from .writing import Bundle, BundleWriter

_DISCOUNT = 0.98

# --- a rover at sites that are hardly worth a probe ---

_GOOD, _TELLS = 0.3, 0.7


def survey(sites: int = 12) -> Bundle:
    """Few sites are good, probes tell little, and to leave ends it: that is nearly as good as anything."""
    writer = BundleWriter(
        f"survey{sites}",
        f"""horizon: 40
discount: {_DISCOUNT}

state_variable: int at

state_variable: bool has_left

state_variable: bool is_good []
code:
state.is_good.assign({sites}, false);

state_variable: bool is_taken []
code:
state.is_taken.assign({sites}, false);

initial_belief:
for (int i = 0; i < {sites}; i++) state.is_good[i] = AOS.Bernoulli({_GOOD});

reward_code:
if (state.has_left) __isGoalState = true;
""",
    )
    drive = f"""__reward = -0.5;
state__.at = std::max(0, std::min(state.at + (east == 1 ? 1 : -1), {sites - 1}));
__moduleResponse = there;"""
    writer.skill("drive", drive, over={"east": "2"})
    probe = f"""__reward = -0.5;
__moduleResponse = AOS.Bernoulli({_TELLS}) == state.is_good[state.at] ? good : bad;"""
    writer.skill("probe", probe)
    dig = """__reward = state.is_taken[state.at] ? -4 : state.is_good[state.at] ? 3 : -5;
state__.is_taken[state.at] = true;
__moduleResponse = dug;"""
    writer.skill("dig", dig)
    leave = """state__.has_left = true;
__moduleResponse = left;"""
    writer.skill("leave", leave)
    return writer.files


# --- questions that tell nothing alone ---

_NUMBERS, _LAMPS, _RIGHT = 64, 18, 0.9


def questions(lamps: int = _LAMPS) -> Bundle:
    """A number is guessed after questions, none of which is worth its cost alone. Lamps make states many."""
    writer = BundleWriter(
        f"questions{lamps}",
        f"""horizon: 30
discount: {_DISCOUNT}

state_variable: bool is_over

state_variable: int number

state_variable: bool is_lit []
code:
state.is_lit.assign({lamps}, false);

initial_belief:
state.number = AOSUtils::SampleDiscrete(vector<double>({_NUMBERS}, 1.0));
for (int i = 0; i < {lamps}; i++) state.is_lit[i] = AOS.Bernoulli(0.5);

reward_code:
if (state.is_over) __isGoalState = true;
""",
    )
    ask = f"""__reward = -0.3;
__moduleResponse = AOS.Bernoulli({_RIGHT}) == (state.number > limit) ? above : below;"""
    writer.skill("ask", ask, over={"limit": str(_NUMBERS - 1)})
    see = "__reward = -0.3;\n__moduleResponse = state.is_lit[lamp] ? lit : dark;"
    writer.skill("see", see, over={"lamp": str(lamps)})
    guess = """__reward = state.number == number ? 15 : -10;
state__.is_over = true;
__moduleResponse = guessed;"""
    writer.skill("guess", guess, over={"number": str(_NUMBERS)})
    writer.skill("leave", "state__.is_over = true;\n__moduleResponse = left;")
    return writer.files
