"""A lamp with a button: documents of which no more is needed than that they are some."""

LAMP = {
    "lamp.ef": """project: lamp
horizon: 3
state_variable: bool is_on
reward_code:
if (state.is_on) __reward = 1;
""",
    "press.sd": """project: lamp
dynamic_model:
state__.is_on = !state.is_on;
__moduleResponse = clicked;
""",
}
