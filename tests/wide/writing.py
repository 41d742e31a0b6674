"""Documents and mappings of a bundle, from its skills."""

Bundle = dict[str, str]  # file name to text


def _mapping(
    project: str, skill: str, parameters: list[str], responses: list[str], numbers: list[str]
) -> str:
    lines = [f"project: {project}", "", "module_activation: skill", f"path: /{skill}", "max_duration: 60"]
    for name in parameters:
        lines += [f"parameter: the_{name}", "code:", f"chosen_{name}", ""]
    for name in parameters:
        lines += [f"local_variable: chosen_{name}", f"action_parameter: {name}", ""]
    lines += [
        "local_variable: code",
        "type: string",
        "from_ros_service_response: true",
        "code:",
        "code = __input.code",
        "",
    ]
    for name in numbers:
        lines += [f"local_variable: {name}", "type: float", "from_ros_service_response: true", "code:"]
        lines += [f"{name} = __input.{name}", ""]
    for response in responses:
        lines += [f"response: {response}", f'response_rule: code == "{response}"']
    return "\n".join(lines) + "\n"


class BundleWriter:
    """Collects the documents of a bundle."""

    def __init__(self, project: str, environment: str) -> None:
        self.project = project
        self.files: Bundle = {"e.ef": f"project: {project}\n{environment}"}

    def skill(
        self,
        name: str,
        responses: list[str],
        model: str,
        *,
        over: dict[str, str] | None = None,
        numbers: list[str] | None = None,
    ) -> None:
        over = over or {}
        values = "".join(f"parameter: int {parameter}\n" for parameter in over)
        loops = "".join(
            f"for (int {parameter} = 0; {parameter} < {count}; {parameter}++) "
            for parameter, count in over.items()
        )
        listed = (
            "available_parameters_code:\n"
            f"{loops}__possibleParameters.push_back(std::make_tuple({', '.join(over)}));\n"
            if over
            else ""
        )
        self.files[f"{name}.sd"] = f"project: {self.project}\n{values}\n{listed}\ndynamic_model:\n{model}\n"
        self.files[f"{name}.am"] = _mapping(self.project, name, list(over), responses, numbers or [])

    def charger(self, battery: int) -> None:
        """A skill that fills the battery where `at` is 0."""
        model = f"""__reward = -0.5;
if (state.at == 0) {{
    state__.battery = {battery};
    __moduleResponse = charged;
}} else {{
    __moduleResponse = refused;
}}"""
        self.skill("charge", ["charged", "refused"], model)
