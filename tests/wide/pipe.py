"""A boat looks for a leak along a pipe: a sample tells little, the battery drains unevenly, and home pays."""

from .writing import Bundle, BundleWriter

_CHARGE, _FOUND, _LOST = 90, 60, -60
_END = f"""bool is_home = state.x == 0;
if (state.has_landed) {{
    __reward = !is_home ? {_LOST} : state.has_it ? {_FOUND} : 0;
    __isGoalState = is_home;
    __isFailureState = !is_home;
}} else if (state.charge <= 0) {{
    __reward = {_LOST};
    __isFailureState = true;
}}
"""
_DRAIN = "AOS.SampleUniform(0.9, 1.1)"
_SIGMA = 1.0
_REACH = 4.0


def pipe(size: int = 40) -> Bundle:
    """A leak somewhere along a pipe; a sample is a number, larger near the leak."""
    integers = "state_variable: int x\n\nstate_variable: int leak\n\n"
    charge = f"state_variable: double charge\ndefault_value: {_CHARGE}\n\n"
    flags = "state_variable: bool has_it\n\nstate_variable: bool has_landed\n\n"
    start = f"state.leak = AOS.SampleDiscrete(std::vector<double>({size}, 1.0));"
    environment = f"horizon: 90\ndiscount: 0.99\n\n{integers}{charge}{flags}"
    writer = BundleWriter(f"pipe{size}", f"{environment}initial_belief:\n{start}\n\nreward_code:\n{_END}")
    writer.skill("land", "state__.has_landed = true;\n__moduleResponse = landed;")
    sail = f"""__reward = -0.2;
int by = speed == 0 ? -5 : speed == 1 ? -1 : speed == 2 ? 1 : 5;
state__.x = std::max(0, std::min(state.x + by, {size - 1}));
state__.charge = state.charge - (abs(by) > 1 ? 3 : 1) * {_DRAIN};
__moduleResponse = sailed;"""
    writer.skill("sail", sail, over={"speed": "4"})
    sample = f"""__reward = -0.2;
state__.charge = state.charge - {_DRAIN};
double strength = 3 * std::exp(-abs(state.x - state.leak) / {_REACH / 2});
__observed.value = AOS.SampleNormal(strength, {_SIGMA});
__moduleResponse = sampled;"""
    writer.skill("sample", sample)
    plug = f"""bool is_there = state.x == state.leak;
__reward = is_there ? -0.2 : -3;
state__.charge = state.charge - 2 * {_DRAIN};
if (is_there) state__.has_it = true;
__moduleResponse = is_there ? plugged : missed;"""
    writer.skill("plug", plug)
    return writer.files
