Bundle = dict[str, str]  # file name to text


class BundleWriter:
    def __init__(self, project: str, environment: str):
        self.project = project
        self.files: Bundle = {"e.ef": f"project: {project}\n{environment}"}

    def skill(self, name: str, model: str, *, over: dict[str, str] | None = None):
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

    def charger(self, battery: int):
        model = f"""__reward = -0.5;
if (state.at == 0) {{
    state__.battery = {battery};
    __moduleResponse = charged;
}} else {{
    __moduleResponse = refused;
}}"""
        self.skill("charge", model)
