"""The words of SDL: of each kind of file the sections with their parts, and what each means.

Readers, the editor, its colours and the page of the languages go by this table.
"""

from collections.abc import Mapping

from aos_language.reading.sdl_text import Body, Grammar, Word

_IMPORTS = "`from: module import: name, name` or `import: module`: names for the expressions."
_PROJECT = "The project the document belongs to; the first line of every file."
_VERSION = "The document's version, one to four numbers: a changed document is taken only with a higher one."

_BLOCK_PARTS = {
    "assignment": Word("Opens another assignment of this block, with a name if wanted."),
    "temporary_variable": Word("`int n`, or `enum Ending { Good, Bad } ending`: a variable of this block."),
    "loop_previous": Word("`Type item`: repeats for each state variable of a compound type, in `state`."),
    "loop_next": Word("`Type item`: as `loop_previous:`, in the copy that the block writes."),
    "loop_condition": Word("For which items the loop's body runs; without it for all.", Body.CPP),
    "loop_body": Word("The code that runs for each item.", Body.CPP),
    "code": Word("The code of this assignment.", Body.CPP),
}
_VARIABLE_PARTS = {
    "code": Word("Statements that set the value at the start; they may read and write `state`.", Body.CPP),
    "default_value": Word("An expression for the value at the start; instead of `code:`.", Body.CPP),
    "key_types": Word("Makes the variable a map: enum names and ranges (start,stop,step), between commas."),
    "ml_max_value": Word("For AOS's learning planner; has no effect here."),
    "ml_ignore": Word("For AOS's learning planner; has no effect here."),
}
_PARAMETER_PARTS = {
    "code": Word("Statements that set the value where nobody sets it; they write `state.name`.", Body.CPP),
    "default_value": Word("An expression for the value where nobody sets it; instead of `code:`.", Body.CPP),
}

GRAMMARS: Mapping[str, Grammar] = {
    ".ef": {
        "project": Word(_PROJECT),
        "version": Word(_VERSION),
        "horizon": Word("How many decisions the search looks ahead, from each new step."),
        "discount": Word("What a reward one step later is worth, at most 1; 0.9999 if not given."),
        "define_type": Word(
            "A type: an enum if it has `enum_members:`, else a compound.",
            parts={
                "variable": Word(
                    "`type name default`: a field of the compound; the default may be left out."
                ),
                "enum_members": Word(
                    "The enum's values between commas, from 0; all enums share one namespace.", is_list=True
                ),
            },
        ),
        "state_variable": Word(
            "`type name`, or `type name []` for an array: a part of the robot's and the world's state.",
            parts=_VARIABLE_PARTS,
        ),
        "action_parameter": Word(
            "`type name`: a constant that skills may take as a parameter.", parts=_VARIABLE_PARTS
        ),
        "mission_parameter": Word(
            "`type name`: a constant of the mission, read as `state.name`. Whoever starts the "
            "mission may set it.",
            parts=_PARAMETER_PARTS,
        ),
        "one_state_model": Word("`true`: `state`, `state_` and `state__` are one and the same."),
        "shared_code": Word(
            "Constants and functions in C++ that all model code of the project sees. A function "
            "may draw with `AOS.Bernoulli(p)` and its like.",
            Body.CPP,
        ),
        "shared_mapping_code": Word(
            "Constants and functions in Python that all mappings of the project see.", Body.PYTHON
        ),
        "initial_belief": Word(
            "Draws one state of the belief at the start; the last one counts.", Body.CPP, parts=_BLOCK_PARTS
        ),
        "reward_code": Word(
            "A special state: looks at the state after the step; may set `__reward`, "
            "`__isGoalState`, `__isFailureState` and `__stopEvaluatingState`.",
            Body.CPP,
            parts=_BLOCK_PARTS,
        ),
        "special_state": Word(
            "A special state as a condition with a reward, where `reward_code:` is code.",
            parts={
                "state_condition": Word("When it holds: an expression over `state`.", Body.CPP),
                "reward": Word("What is added to the reward where the condition holds."),
                "is_goal_state": Word("`true`: the mission ends here."),
                "is_failure_state": Word(
                    "`true`: the mission ends here as a failure; `false`: it does not. Without it the "
                    "reward's sign says how it ends."
                ),
                "is_one_time_reward": Word("`true`: the reward is given the first time only."),
            },
        ),
        "extrinsic_code": Word(
            "What happens by itself in every step, before the skill acts: reads `state`, writes `state_`.",
            Body.CPP,
            parts=_BLOCK_PARTS,
        ),
        "heuristic_code": Word(
            "The worth of a state where the search stops looking: sets `__heuristicValue`.",
            Body.CPP,
            parts=_BLOCK_PARTS,
        ),
        "print_code": Word("Writes a state to `ss`, for people.", Body.CPP, parts=_BLOCK_PARTS),
        "monitor": Word(
            "The model of a monitor: the response that it gives after each step, whatever the skill.",
            parts={"code": Word("Sets `__moduleResponse` from `state`, the state after the step.", Body.CPP)},
        ),
    },
    ".sd": {
        "project": Word(_PROJECT),
        "version": Word(_VERSION),
        "parameter": Word(
            "`type name`: a parameter of the skill; it takes each `action_parameter` of exactly this type."
        ),
        "available_parameters_code": Word(
            "Lists the skill's parameter values: `__possibleParameters.push_back(std::make_tuple(...))`.",
            Body.CPP,
            parts=_BLOCK_PARTS,
        ),
        "precondition": Word(
            "When the skill may be used: sets `__meetPrecondition`, which starts as true.",
            Body.CPP,
            parts=_BLOCK_PARTS,
        ),
        "violate_penalty": Word("Added to the reward where the precondition is not met."),
        "rollout_policy": Word(
            "The skill's weight in random play-outs: sets `__heuristicValue`.", Body.CPP, parts=_BLOCK_PARTS
        ),
        "execution_time": Word(
            "How long the skill takes, a whole number: sets `__moduleExecutionTime`.",
            Body.CPP,
            parts=_BLOCK_PARTS,
        ),
        "dynamic_model": Word(
            "What the skill does: writes `state__`, `__reward` and `__moduleResponse`.",
            Body.CPP,
            parts=_BLOCK_PARTS,
        ),
        "state_given_observation": Word(
            "What a real observation tells exactly: writes `state___` from the mapping's local variables.",
            Body.CPP,
            parts=_BLOCK_PARTS,
        ),
    },
    ".am": {
        "project": Word(_PROJECT),
        "version": Word(_VERSION),
        "response": Word(
            "A response of the skill; the first one whose rule holds is the observation.",
            parts={
                "response_rule": Word(
                    "A Python expression over local variables; `True` or nothing always holds.", Body.PYTHON
                ),
                "assign_variable": Word("An anyValue that gets a new low-level value with this response."),
                "value": Word(
                    "The new low-level value: a Python expression over local variables.", Body.PYTHON
                ),
            },
        ),
        "response_local_variable": Word("The local variable whose text is the response."),
        "stop_when": Word(
            "A Python expression over local variables, looked at with each topic message: the "
            "first time it is `True` the skill is cancelled.",
            Body.PYTHON,
        ),
        "monitor": Word(
            "In place of `module_activation:`: the monitor of the environment document that this mapping is."
        ),
        "module_activation": Word(
            "`ros_service`, `ros_action` or `skill`: how the skill is called.",
            parts={
                "imports": Word(_IMPORTS),
                "path": Word("The service's path; the deploy file binds it to an adapter."),
                "srv": Word("The type of the ROS service or action."),
                "max_duration": Word("How long the call may take, in seconds."),
                "parameter": Word("A field of the call; its value stands below `code:`."),
                "code": Word("The field's value: a Python expression over local variables.", Body.PYTHON),
            },
        ),
        "local_variable": Word(
            "A value from a parameter, from the call's result or from a topic; set anew for each activation.",
            parts={
                "imports": Word(_IMPORTS),
                "type": Word("The value's type."),
                "topic": Word("The topic whose messages give the value."),
                "message_type": Word("The type of the topic's messages."),
                "initial_value": Word("The value until the first message: a Python expression.", Body.PYTHON),
                "action_parameter": Word("The skill parameter that gives the value: `name` or `name.field`."),
                "from_ros_service_response": Word("`true`: the call's result gives the value."),
                "from_ros_reservice_response": Word(
                    "Another spelling of `from_ros_service_response`.", canonical="from_ros_service_response"
                ),
                "is_heavy_variable": Word("`true`: the value is large; has no effect here."),
                "code": Word(
                    "For a result: assigns it from `__input`. For a topic: returns the new value.",
                    Body.PYTHON,
                ),
            },
        ),
    },
    ".lf": {
        "project": Word(_PROJECT),
        "version": Word(_VERSION),
        "define_type": Word(
            "A low-level type: the Python side of `anyValue`.",
            parts={"variable": Word("`type name`: a field of the type.")},
        ),
        "constant": Word(
            "`type name`: a low-level value that the environment's code may give to an `anyValue`.",
            parts={"code": Word("Python that sets the constant or its fields.", Body.PYTHON)},
        ),
    },
}
"""The words of each kind of file: those of AOS 2.0, and ours for what JSON can say and it cannot; the
language page marks ours."""
