from hostile.bus.cell import STEPS, cell
from hostile.bus.forgeries import FORGERIES, faults_of


def test_a_mission_goes_its_way_whatever_others_make_up(tmp_path):
    with cell(tmp_path) as mission:
        faults = {forgery.name: faults_of(mission, forgery) for forgery in FORGERIES}
        assert {name: found for name, found in faults.items() if found} == {}
        mission.go_on()
    assert mission.exit_code == 0
    assert mission.summary["ending"] == "goal"
    assert mission.moved == ["step"] * STEPS
