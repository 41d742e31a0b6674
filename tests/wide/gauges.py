"""Gauges that are read by a camera, which dust blinds bit by bit, and which may break."""

from .writing import Bundle, BundleWriter

_BAD, _DUST, _BREAKS, _SHARP, _BLUR = 0.3, 0.25, 0.02, 0.95, 0.13


def gauges(count: int = 8) -> Bundle:
    """Each gauge is to be reported as fine or bad; a plate at the base tells of the camera."""
    writer = BundleWriter(
        f"gauges{count}",
        f"""horizon: 50
discount: 0.98

state_variable: int at
default_value: {count}

state_variable: int dust

state_variable: bool is_broken

state_variable: bool is_bad []
code:
state.is_bad.assign({count}, false);

state_variable: bool is_told []
code:
state.is_told.assign({count}, false);

initial_belief:
for (int i = 0; i < {count}; i++) state.is_bad[i] = AOS.Bernoulli({_BAD});

extrinsic_code:
if (AOS.Bernoulli({_DUST})) state_.dust = std::min(state.dust + 1, 3);
if (AOS.Bernoulli({_BREAKS})) state_.is_broken = true;

reward_code:
bool is_over = true;
for (int i = 0; i < {count}; i++) if (!state.is_told[i]) is_over = false;
if (is_over) __isGoalState = true;
""",
    )
    sharp = f"double sharp = state.is_broken ? 0.5 : {_SHARP} - {_BLUR} * state.dust;\n"
    drive = "__reward = -0.4;\nstate__.at = place;\n__moduleResponse = there;"
    writer.skill("drive", drive, over={"place": str(count + 1)})
    read = f"""__reward = -0.2;
{sharp}bool is_bad = AOS.Bernoulli(sharp) == state.is_bad[std::min(state.at, {count - 1})];
__moduleResponse = state.at == {count} ? nothing : is_bad ? bad : fine;"""
    writer.skill("read", read)
    check = f"""__reward = -0.2;
{sharp}__moduleResponse = state.at == {count} && AOS.Bernoulli(sharp) ? clear : blurred;"""
    writer.skill("check", check)
    wipe = "__reward = -0.6;\nstate__.dust = 0;\n__moduleResponse = wiped;"
    writer.skill("wipe", wipe)
    swap = f"""__reward = -2;
if (state.at == {count}) {{ state__.dust = 0; state__.is_broken = false; }}
__moduleResponse = state.at == {count} ? swapped : refused;"""
    writer.skill("swap", swap)
    report = f"""int gauge = std::min(state.at, {count - 1});
bool can = state.at < {count} && !state.is_told[gauge];
__reward = !can ? -1 : state.is_bad[gauge] == (bad == 1) ? 3 : -5;
if (can) state__.is_told[gauge] = true;
__moduleResponse = told;"""
    writer.skill("report", report, over={"bad": "2"})
    return writer.files
