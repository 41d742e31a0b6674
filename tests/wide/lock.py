"""A lock of dials that opens when all of them are right, with a noisy probe of each."""

from .writing import Bundle, BundleWriter

_DIGITS = 6
_TRUE = 0.8
_DISCOUNT = 0.98


def _environment(count: int) -> str:
    return f"""horizon: 60
discount: {_DISCOUNT}

state_variable: int digit []
code:
state.digit.assign({count}, 0);

state_variable: int dial []
code:
state.dial.assign({count}, 0);

state_variable: bool is_open

initial_belief:
vector<double> odds({_DIGITS}, 1.0);
for (int i = 0; i < {count}; i++) state.digit[i] = AOSUtils::SampleDiscrete(odds);

reward_code:
if (state.is_open) __isGoalState = true;
"""


def lock(count: int = 5) -> Bundle:
    """Dials are turned and probed one by one; a pull opens the lock, or costs."""
    writer = BundleWriter(f"lock{count}", _environment(count))
    one = {"which": str(count)}
    turn = f"""__reward = -0.2;
state__.dial[which] = (state.dial[which] + (up == 1 ? 1 : {_DIGITS - 1})) % {_DIGITS};
__moduleResponse = turned;"""
    writer.skill("turn", turn, over=one | {"up": "2"})
    probe = f"""__reward = -0.3;
int told = state.dial[which] < state.digit[which] ? 0 : state.dial[which] == state.digit[which] ? 1 : 2;
if (!AOS.Bernoulli({_TRUE})) told = (told + 1 + AOSUtils::SampleDiscrete(vector<double>{{0.5, 0.5}})) % 3;
__moduleResponse = told == 0 ? below : told == 1 ? right : above;"""
    writer.skill("probe", probe, over=one)
    pull = f"""int right = 0;
for (int i = 0; i < {count}; i++) right += state.dial[i] == state.digit[i];
if (right == {count}) {{
    __reward = 60;
    state__.is_open = true;
    __moduleResponse = opened;
}} else {{
    __reward = -5;
    __moduleResponse = stuck;
}}"""
    writer.skill("pull", pull)
    return writer.files
