"""Abstraction mappings of skills whose response is the text that their service answers."""

from __future__ import annotations

__all__ = ["text_mapping"]

_MAPPING = """project: {project}

module_activation: skill
path: /{skill}
{fields}
local_variable: code
type: string
from_ros_service_response: true
code:
code = __input.code

response_local_variable: code
"""
_FIELD = """parameter: {name}
code:
the_{name}
"""
_LOCAL = """local_variable: the_{name}
action_parameter: {name}

"""


def text_mapping(project: str, skill: str, *parameters: str) -> str:
    """The mapping of a skill with these parameters."""
    fields = "".join(_FIELD.format(name=name) for name in parameters)
    fields += "\n" + "".join(_LOCAL.format(name=name) for name in parameters)
    return _MAPPING.format(project=project, skill=skill, fields=fields)
