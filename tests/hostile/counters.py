"""The documents of a robot whose one skill counts, for tests that need any mission."""

_ENVIRONMENT = """project: PROJECT
horizon: 2
discount: 0.9

state_variable: int count

initial_belief:
state.count = 0;

reward_code:
if (state.count >= STEPS) { __reward = 10; __isGoalState = true; }
"""
_SKILL = """project: PROJECT

dynamic_model:
state__.count = state.count + 1;
CODE
EARNS__moduleResponse = done;
"""
_MAPPING = """project: PROJECT

module_activation: skill
path: /SKILL
response: done
response_rule: True
"""


def counting(
    project: str, skill: str = "step", *, code: str = "", steps: str = "STEPS", reward: int = 0
) -> dict[str, str]:
    """The files by name. The mission is over after so many steps. The skill runs the code, from line 5 on."""
    files = {f"{project}.ef": _ENVIRONMENT, f"{skill}.sd": _SKILL, f"{skill}.am": _MAPPING}
    words = {"PROJECT": project, "SKILL": skill, "STEPS": steps, "CODE\n": f"{code}\n" if code else ""}
    words["EARNS"] = f"__reward = {reward};\n" if reward else ""
    for word, text in words.items():
        files = {name: file.replace(word, text) for name, file in files.items()}
    return files
