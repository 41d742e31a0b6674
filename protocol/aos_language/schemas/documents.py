"""The schemas of the JSON documents: the keys that the readers know, and what each may hold.

They are as strict as `aos lint`, which warns of unknown keys, with what the linter takes and a clean document
should not have left out: text for true and false, keys that have no effect any more.
"""

from aos_language.schemas.parts import (
    BLOCK,
    CODE,
    IMPORTS,
    NUMBER,
    TEXT,
    TRUTH,
    Schema,
    expression,
    list_of,
    object_of,
    said,
    shared_parts,
)
from aos_protocol.documents import ACTIVATION_KINDS

_ENVIRONMENT, _SKILL, _MAPPING, _LOW_LEVEL = "environment", "skill", "mapping", "low_level"


def plp_schema() -> Schema:
    """AOS 1.x JSON: documents that start with `PlpMain`."""
    kinds = {"Environment": _ENVIRONMENT, "PLP": _SKILL, "Glue": _MAPPING, "EnvironmentGlue": _LOW_LEVEL}
    return _schema("AOS document, AOS 1.x JSON", "PlpMain", kinds)


def gsdl_schema() -> Schema:
    """The paper's JSON: documents that start with `GsdlMain`."""
    kinds = {
        "Environment": _ENVIRONMENT,
        "GSDL": _SKILL,
        "SD": _SKILL,
        "AM": _MAPPING,
        "EnvironmentGlue": _LOW_LEVEL,
    }
    return _schema("AOS document, GSDL JSON", "GsdlMain", kinds)


def _schema(title: str, header: str, kinds: dict[str, str]) -> Schema:
    head = object_of(
        "Which project and skill the document is of.",
        Project=said(TEXT, "The project the document belongs to."),
        Name=said(TEXT, "The skill's name; for an environment any."),
        Type=said({"enum": list(kinds)}, "The kind of document."),
        Version=said(
            {"type": ["string", "number"]},
            'Text such as "1.2.0" is the document\'s version; a number means nothing.',
        ),
        Comment=TEXT,
        required=("Project", "Type"),
    )
    chosen = [
        {
            "if": {"properties": {header: {"properties": {"Type": {"const": kind}}}}},
            "then": {"$ref": f"#/$defs/{definition}"},
        }
        for kind, definition in kinds.items()
    ]
    documents = _documents()
    for document in documents.values():
        document["properties"] = {header: {"$ref": "#/$defs/header"}, **document["properties"]}
        document["properties"]["Comment"] = TEXT
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        "type": "object",
        "required": [header],
        "properties": {header: {"$ref": "#/$defs/header"}},
        "allOf": chosen,
        "$defs": {"header": head, **documents, **shared_parts()},
    }


def _documents() -> dict[str, Schema]:
    return {_ENVIRONMENT: _environment(), _SKILL: _skill(), _MAPPING: _mapping(), _LOW_LEVEL: _low_level()}


def _environment() -> Schema:
    general = object_of(
        "How far the search looks.",
        Horizon=said({"type": "integer", "minimum": 1}, "How many decisions the search looks ahead."),
        Discount=said(
            {"type": "number", "exclusiveMinimum": 0, "maximum": 1}, "What a reward one step later is worth."
        ),
        OneStateModel=said(TRUTH, "Whether `state`, `state_` and `state__` are one and the same."),
        required=("Horizon", "Discount"),
    )
    kind = object_of(
        "An enum with its values, or a compound with its fields.",
        TypeName=TEXT,
        Type={"enum": ["enum", "compound"]},
        EnumValues=said(list_of(TEXT), "The enum's values; all enums share one namespace."),
        Variables=said(list_of(_field()), "The compound's fields."),
        Comment=TEXT,
        required=("TypeName", "Type"),
    )
    monitor = object_of(
        "The model of a monitor.",
        Name=TEXT,
        AssignmentCode=said(CODE, "Sets `__moduleResponse` from `state`, the state after the step."),
        Comment=TEXT,
        required=("Name", "AssignmentCode"),
    )
    return object_of(
        "The environment: state, belief, goals, what happens by itself.",
        EnvironmentGeneral=general,
        GlobalVariableTypes=said(list_of(kind), "Enums and compound types."),
        GlobalVariablesDeclaration=said(list_of(_variable()), "The state variables."),
        InitialBeliefStateAssignments=said(BLOCK, "Draws one state of the initial belief, in `state`."),
        SpecialStates=said(list_of(_special_state()), "Goals and rewards, after each step."),
        ExtrinsicChangesDynamicModel=said(
            BLOCK, "What happens by itself in each step, before the skill acts: writes `state_`."
        ),
        SharedCode=said(CODE, "Ours: constants and functions in C++ that all model code sees."),
        SharedMappingCode=said(CODE, "Ours: constants and functions in Python that all mappings see."),
        HeuristicStateValue=said(BLOCK, "A state's worth where the search ends: `__heuristicValue`."),
        PrintStateFunc=said(BLOCK, "Writes a state to `ss`, for people."),
        Monitors=said(list_of(monitor), "Ours: what monitors say of a state, after each step."),
        required=("EnvironmentGeneral",),
    )


_DECLARED: dict[str, Schema] = {
    "Name": TEXT,
    "Type": TEXT,
    "UnderlineLocalVariableType": {**TEXT, "description": "The low-level type of an `anyValue`."},
    "ML_IgnoreVariable": {},
    "ML_MaxPossibleValue": {},
    "Comment": TEXT,
}


def _field() -> Schema:
    default = said(expression(), "The value at the start: an expression.")
    return object_of("A field.", Default=default, **_DECLARED, required=("Name", "Type"))


def _variable() -> Schema:
    declared = object_of(
        "A state variable.",
        **_DECLARED,
        Default=said(expression(), "The value at the start: an expression."),
        DefaultCode=said(CODE, "Statements that set the value at the start."),
        IsArray=TRUTH,
        IndexedBy=said(
            TEXT, "Ours: makes the variable an array with an element for each value of this enum."
        ),
        IsActionParameterValue=said(TRUTH, "A constant that skills may take as a parameter."),
        IsMissionParameter=said(
            TRUTH, "Ours: a constant of the mission, whose value whoever starts the mission may set."
        ),
        Parameters=said(list_of(TEXT), "Makes the variable a map: enum names, and ranges (start,stop,step)."),
        IncludeParametersCode=said(
            expression(), "For which keys `DefaultCode` runs: a condition over `par1`, `par2`, and so on."
        ),
        required=("Name", "Type"),
    )
    return {**declared, "not": {"required": ["Default", "DefaultCode"]}}


def _special_state() -> Schema:
    special = object_of(
        "A condition with a reward and flags, or code; not both.",
        StateConditionCode=said(expression(), "When it holds: an expression over `state`."),
        Reward=NUMBER,
        IsGoalState=said(TRUTH, "Whether the mission ends here."),
        IsFailureState=said(
            TRUTH,
            "Whether the mission ends here as a failure; without it the reward's sign says how it ends.",
        ),
        IsOneTimeReward=said(TRUTH, "Whether the reward is given the first time only."),
        StateFunctionCode=said(
            BLOCK, "May set `__reward`, `__isGoalState`, `__isFailureState` and `__stopEvaluatingState`."
        ),
        Comment=TEXT,
    )
    other = ("StateConditionCode", "Reward", "IsGoalState", "IsFailureState", "IsOneTimeReward")
    code = {"required": ["StateFunctionCode"], "properties": dict.fromkeys(other, False)}
    condition = {"required": ["StateConditionCode", "Reward"], "properties": {"StateFunctionCode": False}}
    return {**special, "oneOf": [condition, code]}


def _skill() -> Schema:
    preconditions = object_of(
        "When the skill may be used.",
        GlobalVariablePreconditionAssignments=said(BLOCK, "Sets `__meetPrecondition`, true at the start."),
        PlannerAssistancePreconditionsAssignments=said(
            BLOCK, "The skill's weight in play-outs: sets `__heuristicValue`."
        ),
        ViolatingPreconditionPenalty=said(NUMBER, "Added to the reward where the precondition is not met."),
    )
    parameter = object_of("A parameter.", Name=TEXT, Type=TEXT, Comment=TEXT, required=("Name", "Type"))
    return object_of(
        "A skill's model.",
        GlobalVariableModuleParameters=said(list_of(parameter), "The skill's parameters."),
        PossibleParametersValue=said(BLOCK, "Lists the parameter values in `__possibleParameters`."),
        Preconditions=preconditions,
        ModuleExecutionTimeDynamicModel=said(
            BLOCK, "How long the skill takes: sets `__moduleExecutionTime`."
        ),
        DynamicModel=object_of(
            "What the skill does to the world, costs and reports.",
            NextStateAssignments=said(BLOCK, "Writes `state__`, `__reward` and `__moduleResponse`."),
        ),
        StateGivenObservationModel=object_of(
            "What a real observation tells exactly.", Assignments=said(BLOCK, "Writes `state___`.")
        ),
        required=("DynamicModel",),
    )


def _mapping() -> Schema:
    assignment = object_of(
        "A new low-level value.",
        VarName=said(TEXT, "An anyValue: `parameter.field`, or `variable.field`."),
        Value=said(CODE, "A Python expression over local variables."),
        required=("VarName", "Value"),
    )
    rule = object_of(
        "A response and when it is given.",
        Response=TEXT,
        ConditionCodeWithLocalVariables=said(
            expression(), "A Python expression over local variables; empty: it always holds."
        ),
        AssignGlobalVariables=said(list_of(assignment), "What changes behind anyValues with this response."),
        Comment=TEXT,
        required=("Response",),
    )
    responses = object_of(
        "What the skill reports.",
        ResponseRules=said(list_of(rule), "The first rule that holds gives the response."),
        FromStringLocalVariable=said(TEXT, "The local variable whose text is the response."),
        Comment=TEXT,
    )
    field = object_of(
        "A field of the call.",
        ServiceFieldName=TEXT,
        AssignServiceFieldCode=said(expression(), "A Python expression over local variables."),
        Comment=TEXT,
        required=("ServiceFieldName", "AssignServiceFieldCode"),
    )
    service = {
        "ServicePath": said(TEXT, "The path; the deploy file binds it to an adapter."),
        "ServiceName": said(TEXT, "The service's type."),
        "ServiceParameters": list_of(field),
        "ImportCode": IMPORTS,
    }
    activation = object_of(
        "How the skill is called.",
        RosService=object_of("A ROS service.", **service, required=("ServicePath", "ServiceName")),
        RosAction=object_of("A ROS action.", **service, required=("ServicePath", "ServiceName")),
        Skill=object_of("A skill that is neither.", **service, required=("ServicePath",)),
        MaxDuration=said({"type": "number", "exclusiveMinimum": 0}, "How long the call may take, in s."),
    )
    activation["anyOf"] = [{"required": [word]} for word in ACTIVATION_KINDS.values()]
    mapping = object_of(
        "The abstraction mapping of a skill, or of a monitor.",
        GlueFramework={},
        ModuleResponse=responses,
        ModuleActivation=activation,
        Monitor=said(TEXT, "In place of ModuleActivation: the monitor of the environment that this is."),
        StopWhen=said(
            expression(), "A Python expression over local variables: the skill is cancelled when it holds."
        ),
        LocalVariablesInitialization=list_of(_local_variable()),
    )
    mapping["oneOf"] = [{"required": ["ModuleActivation"]}, {"required": ["Monitor"]}]
    return mapping


def _local_variable() -> Schema:
    variable = object_of(
        "A value from a parameter, from the call's result or from a topic.",
        LocalVariableName=TEXT,
        InputLocalVariable=said(TEXT, "The name of a variable that takes a skill parameter."),
        VariableType=TEXT,
        FromGlobalVariable=said(TEXT, "The skill parameter: `name` or `name.field`."),
        FromROSServiceResponse=said(TRUTH, "Whether the code assigns it from the result, `__input`."),
        RosTopicPath=said(TEXT, "The topic whose messages give the value."),
        TopicMessageType=TEXT,
        InitialValue=said(expression(), "The value until the first message: a Python expression."),
        AssignmentCode=said(CODE, "Assigns the value from `__input`; for a topic returns it."),
        ImportCode=IMPORTS,
        IsHeavyVariable=TRUTH,
        Comment=TEXT,
    )
    variable["anyOf"] = [{"required": ["LocalVariableName"]}, {"required": ["InputLocalVariable"]}]
    return variable


def _low_level() -> Schema:
    kind = object_of(
        "A low-level type.",
        TypeName=TEXT,
        Variables=list_of(object_of("A field.", Name=TEXT, Type=TEXT, required=("Name", "Type"))),
        required=("TypeName",),
    )
    constant = object_of(
        "A low-level value for the environment's code.",
        Name=TEXT,
        Type=TEXT,
        InitCode=said(CODE, "Python that sets the constant or its fields."),
        required=("Name", "Type", "InitCode"),
    )
    return object_of(
        "The Python values behind `anyValue`.", LocalVariableTypes=list_of(kind), Constants=list_of(constant)
    )
