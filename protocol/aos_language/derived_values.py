"""The values of skill parameters that are enums, where no document lists them: all values of the enum."""

import msgspec

from aos_language.cpp.keywords import CPP_KEYWORDS
from aos_protocol.documents import Assignment, Environment, Parameter, SkillModel, Snippet


def with_values_of_enums(model: SkillModel, environment: Environment | None) -> SkillModel:
    """The skill with a list of its parameters' values, as `available_parameters_code` would say it.

    It is the skill itself where that has a list, or where every parameter's type has action parameters. A
    list has no low-level values, so neither does a skill with a parameter of a compound type get one.
    """
    if environment is None or model.possible_parameters:
        return model
    enums = {enum.name for enum in environment.enums}
    compounds = {compound.name for compound in environment.compounds}
    declared = {variable.type for variable in environment.variables if variable.is_parameter_value}
    listed = [parameter for parameter in model.parameters if parameter.type not in declared]
    others = [parameter for parameter in model.parameters if parameter.type in declared]
    if (
        not listed
        or any(parameter.type not in enums for parameter in listed)
        or any(parameter.type in compounds for parameter in others)
        # An error already: C++ would only tell of it again, in code that nobody wrote.
        or not CPP_KEYWORDS.isdisjoint({*(parameter.name for parameter in model.parameters), *enums})
    ):
        return model
    lines = [f"for ({_each(parameter, declared)})" for parameter in model.parameters]
    values = ", ".join(_value(parameter, declared) for parameter in model.parameters)
    lines.append(f"__possibleParameters.push_back(std::make_tuple({values}));")
    spans = [*(parameter.span for parameter in model.parameters), listed[0].span]
    code = Snippet("\n".join(lines), tuple(spans))
    return msgspec.structs.replace(model, possible_parameters=(Assignment(listed[0].span, code=code),))


def _each(parameter: Parameter, declared: set[str]) -> str:
    if parameter.type in declared:
        return f"auto& {parameter.name} : state.{parameter.type}ObjectsForActions"
    return f"{parameter.type} {parameter.name} : state.{parameter.type}Objects"


def _value(parameter: Parameter, declared: set[str]) -> str:
    return f"{parameter.name}.second" if parameter.type in declared else parameter.name
