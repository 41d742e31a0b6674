"""The meaning of each word of SDL and of each built-in of model code, in one sentence: for editors and
docs."""

from collections.abc import Mapping

_BLOCK_PARTS = {
    "assignment": "Opens another assignment of this block, with a name if wanted.",
    "temporary_variable": "`int n`, or `enum Ending { Good, Bad } ending`: a variable of this block.",
    "loop_previous": "`Type item`: repeats for each state variable of a compound type, in `state`.",
    "loop_next": "`Type item`: as `loop_previous:`, in the copy that the block writes.",
    "loop_condition": "For which items the loop's body runs; without it for all.",
    "loop_body": "The code that runs for each item.",
    "code": "The code of this assignment.",
}
_VARIABLE_PARTS = {
    "code": "Statements that set the value at the start; they may read and write `state`.",
    "default_value": "An expression for the value at the start; instead of `code:`.",
    "key_types": "Makes the variable a map: enum names and ranges (start,stop,step), between commas.",
    "ml_max_value": "For AOS's learning planner; has no effect here.",
    "ml_ignore": "For AOS's learning planner; has no effect here.",
}
_PARAMETER_PARTS = {
    "code": "Statements that set the value where nobody sets it; they write `state.name`.",
    "default_value": "An expression for the value where nobody sets it; instead of `code:`.",
}
_IMPORTS = "`from: module import: name, name` or `import: module`: names for the expressions."
_PROJECT = "The project the document belongs to; the first line of every file."
_VERSION = "The document's version, one to four numbers: a changed document is taken only with a higher one."

Meaning = tuple[str, Mapping[str, str]]

SECTIONS: Mapping[str, Mapping[str, Meaning]] = {
    ".ef": {
        "project": (_PROJECT, {}),
        "version": (_VERSION, {}),
        "horizon": ("How many decisions the search looks ahead, from each new step.", {}),
        "discount": ("What a reward one step later is worth, at most 1; 0.9999 if not given.", {}),
        "define_type": (
            "A type: an enum if it has `enum_members:`, else a compound.",
            {
                "variable": "`type name default`: a field of the compound; the default may be left out.",
                "enum_members": "The enum's values between commas, from 0; all enums share one namespace.",
            },
        ),
        "shared_code": (
            "Constants and functions in C++ that all model code of the project sees. "
            "A function may draw with `AOS.Bernoulli(p)` and its like.",
            {},
        ),
        "shared_mapping_code": (
            "Constants and functions in Python that all mappings of the project see.",
            {},
        ),
        "state_variable": (
            "`type name`, or `type name []` for an array: a part of the robot's and the world's state.",
            _VARIABLE_PARTS,
        ),
        "action_parameter": ("`type name`: a constant that skills may take as a parameter.", _VARIABLE_PARTS),
        "mission_parameter": (
            "`type name`: a constant of the mission, read as `state.name`. "
            "Whoever starts the mission may set it.",
            _PARAMETER_PARTS,
        ),
        "one_state_model": ("`true`: `state`, `state_` and `state__` are one and the same.", {}),
        "initial_belief": ("Draws one state of the belief at the start; the last one counts.", _BLOCK_PARTS),
        "reward_code": (
            "A special state: looks at the state after the step; may set `__reward`, `__isGoalState`, "
            "`__isFailureState` and `__stopEvaluatingState`.",
            _BLOCK_PARTS,
        ),
        "special_state": (
            "A special state as a condition with a reward, where `reward_code:` is code.",
            {
                "state_condition": "When it holds: an expression over `state`.",
                "reward": "What is added to the reward where the condition holds.",
                "is_goal_state": "`true`: the mission ends here.",
                "is_failure_state": "`true`: the mission ends here as a failure; `false`: it does not. "
                "Without it the reward's sign says how it ends.",
                "is_one_time_reward": "`true`: the reward is given the first time only.",
            },
        ),
        "extrinsic_code": (
            "What happens by itself in every step, before the skill acts: reads `state`, writes `state_`.",
            _BLOCK_PARTS,
        ),
        "heuristic_code": (
            "The worth of a state where the search stops looking: sets `__heuristicValue`.",
            _BLOCK_PARTS,
        ),
        "print_code": ("Writes a state to `ss`, for people.", _BLOCK_PARTS),
        "monitor": (
            "The model of a monitor: the response that it gives after each step, whatever the skill.",
            {"code": "Sets `__moduleResponse` from `state`, the state after the step."},
        ),
    },
    ".sd": {
        "project": (_PROJECT, {}),
        "version": (_VERSION, {}),
        "parameter": (
            "`type name`: a parameter of the skill; it takes each `action_parameter` of exactly this type.",
            {},
        ),
        "available_parameters_code": (
            "Lists the skill's parameter values: `__possibleParameters.push_back(std::make_tuple(...))`.",
            _BLOCK_PARTS,
        ),
        "precondition": (
            "When the skill may be used: sets `__meetPrecondition`, which starts as true.",
            _BLOCK_PARTS,
        ),
        "violate_penalty": ("Added to the reward where the precondition is not met.", {}),
        "rollout_policy": ("The skill's weight in random play-outs: sets `__heuristicValue`.", _BLOCK_PARTS),
        "execution_time": (
            "How long the skill takes, a whole number: sets `__moduleExecutionTime`.",
            _BLOCK_PARTS,
        ),
        "dynamic_model": (
            "What the skill does: writes `state__`, `__reward` and `__moduleResponse`.",
            _BLOCK_PARTS,
        ),
        "state_given_observation": (
            "What a real observation tells exactly: writes `state___` from the mapping's local variables.",
            _BLOCK_PARTS,
        ),
    },
    ".am": {
        "project": (_PROJECT, {}),
        "version": (_VERSION, {}),
        "response": (
            "A response of the skill; the first one whose rule holds is the observation.",
            {
                "response_rule": "A Python expression over local variables; `True` or nothing always holds.",
                "assign_variable": "An anyValue that gets a new low-level value with this response.",
                "value": "The new low-level value: a Python expression over local variables.",
            },
        ),
        "response_local_variable": ("The local variable whose text is the response.", {}),
        "monitor": (
            "In place of `module_activation:`: the monitor of the environment document that this mapping is.",
            {},
        ),
        "stop_when": (
            "A Python expression over local variables, looked at with each topic message: "
            "the first time it is `True` the skill is cancelled.",
            {},
        ),
        "module_activation": (
            "`ros_service`, `ros_action` or `skill`: how the skill is called.",
            {
                "imports": _IMPORTS,
                "path": "The service's path; the deploy file binds it to an adapter.",
                "srv": "The type of the ROS service or action.",
                "max_duration": "How long the call may take, in seconds.",
                "parameter": "A field of the call; its value stands below `code:`.",
                "code": "The field's value: a Python expression over local variables.",
            },
        ),
        "local_variable": (
            "A value from a parameter, from the call's result or from a topic; set anew for each activation.",
            {
                "imports": _IMPORTS,
                "type": "The value's type.",
                "topic": "The topic whose messages give the value.",
                "message_type": "The type of the topic's messages.",
                "initial_value": "The value until the first message: a Python expression.",
                "action_parameter": "The skill parameter that gives the value: `name` or `name.field`.",
                "from_ros_service_response": "`true`: the call's result gives the value.",
                "from_ros_reservice_response": "Another spelling of `from_ros_service_response`.",
                "is_heavy_variable": "`true`: the value is large; has no effect here.",
                "code": "For a result: assigns it from `__input`. For a topic: returns the new value.",
            },
        ),
    },
    ".lf": {
        "project": (_PROJECT, {}),
        "version": (_VERSION, {}),
        "define_type": (
            "A low-level type: the Python side of `anyValue`.",
            {"variable": "`type name`: a field of the type."},
        ),
        "constant": (
            "`type name`: a low-level value that the environment's code may give to an `anyValue`.",
            {"code": "Python that sets the constant or its fields."},
        ),
    },
}
"""The meaning of each section and of its parts, by suffix and section."""

BUILT_INS: Mapping[str, str] = {
    "state": "The state before the step.",
    "state_": "The state after the extrinsic changes.",
    "state__": "The state after the skill: what the dynamic model writes.",
    "state___": "The state that a real observation corrects.",
    "__reward": "The reward of this code; all rewards of a step are added.",
    "__isGoalState": "Whether the mission ends in this state.",
    "__isFailureState": "Whether it ends as a failure. Code without this word lets the reward's sign say.",
    "__stopEvaluatingState": "Whether this special state is not looked at again.",
    "__meetPrecondition": "Whether the skill may be used; true at the start.",
    "__heuristicValue": "A skill's weight in play-outs, or a state's worth where the search ends.",
    "__possibleParameters": "The list of the skill's parameter values, as tuples.",
    "__moduleExecutionTime": "How long the skill takes.",
    "__moduleResponse": "The response the skill gives: one that its mapping names.",
    "__moduleResponseStr": "The response as any text.",
    "__observed": "Numbers beside the response: `__observed.NAME = AOS.SampleNormal(mean, deviation)`.",
    "__input": "The call's result, or the topic's message.",
    "AOS.Bernoulli": "`AOS.Bernoulli(p)`: true with probability p.",
    "AOS.SampleDiscrete": "`AOS.SampleDiscrete(Enum, {weights})`: a value, by normalised weights.",
    "AOS.SampleNormal": "`AOS.SampleNormal(mean, deviation)`: a draw from a normal distribution.",
    "AOS.SampleUniform": "`AOS.SampleUniform(low, high)`: a draw from a uniform distribution.",
    "AOS.SetNull": "Takes an `anyValue` away.",
    "AOS.IsInitialized": "Whether an `anyValue` is there.",
    "AOS.Initialize": "Says that an `anyValue` is there.",
    "AOS.Uninitialize": "Says that an `anyValue` is not there any more.",
    "AOSUtils::SampleDiscrete": "An index drawn with the given probabilities; -1 for what they miss to 1.",
}
"""Names that the system gives to model code and mapping code."""
