"""The reason why an activation that ended well brought no response: AOS402, with what the result said."""

from collections.abc import Mapping
from typing import Any

from aos_middleware.workers.evaluator import MappingFault
from aos_protocol.documents import AbstractionMapping
from aos_protocol.spelling import did_you_mean, quoted, shortened

_FIELD = "response"
"""A derived mapping takes this field from a result."""


def no_response(
    mapping: AbstractionMapping, result: Mapping[str, Any], local_variables: dict[str, str]
) -> MappingFault:
    """No rule holds, or the variable whose text is the response has no value; `result` are its fields."""
    span = mapping.rules[0].span if mapping.rules else mapping.span
    if mapping.is_derived:
        message, hint = _of_derived(mapping, result)
    elif mapping.response_variable:
        message = f"the response is the text of {mapping.response_variable}, which has no value"
        hint = "See that its code assigns it, whatever the skill's result is"
    else:
        values = ", ".join(f"{name}={shortened(text, 200)}" for name, text in local_variables.items())
        message = f"no response rule of {mapping.name} holds ({values or 'no local variables'})"
        hint = "End the rules with one whose condition is True"
    return MappingFault(message, span, code="AOS402", hint=hint, local_variables=local_variables)


def _of_derived(mapping: AbstractionMapping, result: Mapping[str, Any]) -> tuple[str, str]:
    known = [rule.response for rule in mapping.rules]
    response = result.get(_FIELD)
    if response is None:
        has = f"it has {quoted(result)}" if result else "it is empty"
        has = "it is None" if _FIELD in result else has
        message = f"the result of {mapping.activation.path} has no `{_FIELD}`: {has}"
        one_of = f", one of {quoted(known)}" if known else ""
        hint = f"Have the adapter answer with it{one_of}, or write the abstraction mapping {mapping.name}.am"
        return message, hint
    path, name = mapping.activation.path, mapping.name
    message = (
        f"{path} answered with the response {shortened(repr(response), 200)}, which {name} does not know"
    )
    return message, did_you_mean(str(response), known) or f"The skill document knows {quoted(known)}"
