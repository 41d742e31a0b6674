from collections.abc import Mapping, Sequence


def mapping_text(
    *responses: str,
    project: str = "test",
    skill: str = "act",
    parameters: Sequence[str] = (),
    reports: Mapping[str, str] | None = None,
    response_from: str = "",
) -> str:
    """The mapping of a skill that is called at the path of its name.

    A response is `NAME: RULE`, or a name, which stands for the response where the service answers this name
    as `answer`. Parameters are fields of the call. Reports are fields of the result that are observed: a
    name and its type; the answer alone where none are named. With `response_from` the response is the text
    of that field of the result.
    """
    observed = {} if reports is None and response_from else dict(reports or {"answer": "string"})
    if any(":" not in response for response in responses):
        observed.setdefault("answer", "string")
    if response_from:
        observed.setdefault(response_from, "string")
    sections = [f"project: {project}", *map(_rule, responses)]
    fields = "".join(f"\nparameter: {name}\ncode:\n{name}" for name in parameters)
    sections.append(f"module_activation: skill\npath: /{skill}{fields}")
    sections += [f"local_variable: {name}\naction_parameter: {name}" for name in parameters]
    sections += [_report(name, kind) for name, kind in observed.items()]
    if response_from:
        sections.append(f"response_local_variable: {response_from}")
    return "\n\n".join(sections) + "\n"


def mapping_of_model(code: str) -> str:
    """The mapping of a model with this code: with `done` if it gives a response, else without rules."""
    return mapping_text(*(["done"] if "__moduleResponse" in code else []))


def _rule(response: str) -> str:
    name, colon, rule = response.partition(":")
    return f"response: {name}\nresponse_rule: {rule.strip() if colon else f'answer == {name!r}'}"


def _report(name: str, kind: str) -> str:
    source = f"from_ros_service_response: true\ncode:\n{name} = __input.{name}"
    return f"local_variable: {name}\ntype: {kind}\n{source}"
