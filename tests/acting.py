from mappings import mapping_of_model
from projects import text_project

from aos_protocol.documents import Project


def acting(home: str, act: str, *, extrinsic: str = "", special: str = "", before: str = "") -> Project:
    """The environment `home` with extrinsic changes and a special state, and a skill with the dynamic model
    `act`; the sections `before` that stand in its document, too."""
    home += f"extrinsic_code:\n{extrinsic}\n" if extrinsic else ""
    home += f"reward_code:\n{special}\n" if special else ""
    files = {
        "home.ef": home,
        "act.sd": f"project: test\n{before}dynamic_model:\n{act}\n",
        "act.am": mapping_of_model(act),
    }
    return text_project(files)
