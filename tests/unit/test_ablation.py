import re

from ablation.losses import Losses
from ablation.mechanisms import BUNDLES, ROUTES
from places import ROOT

CPP = ROOT / "services" / "solver" / "aos_solver" / "cpp"


def switches() -> list[str]:
    text = (CPP / "aos" / "base" / "switches.hpp").read_text()
    return re.findall(r"\bof\((\w+)\)", text.partition("#define AOS_MECHANISMS(of)")[2])


def test_every_switch_is_measured_and_every_measured_one_is_a_switch():
    measured = {name for route in (*ROUTES, *BUNDLES) for name in route.mechanisms}
    assert measured == set(switches()) - {"lists"}  # whose absence is a setting of its own


def test_every_switch_is_read_where_its_mechanism_is():
    texts = "".join(path.read_text() for path in CPP.rglob("*.[ch]pp") if path.name != "switches.hpp")
    assert [name for name in switches() if f"switches::{name}" not in texts] == []


def test_a_loss_is_that_of_the_same_models_and_tells_the_family_that_loses_most():
    route = ROUTES[0]._replace(mechanisms=("exact",))
    losses = Losses([route])
    for model, with_it, without in (("late/1", 0.01, 0.03), ("keys+/2", 0.02, 0.08), ("keys/3", 0.0, 0.0)):
        entries = [(route.variant(), with_it), (route.variant("exact"), without)]
        planners = [{"planner": planner, "regret": regret} for planner, regret in entries]
        losses.add(model, {"planners": planners})
    losses.add("ties/4", {"obstacle": "hardly anything is to be gained"})
    (row,) = losses.rows()
    assert (row["models"], row["regret with"], row["regret without"]) == (3, 1.0, 3.67)
    assert row["loss"].startswith("2.67 ")
    assert row["worst family"] == "keys 3.0"
