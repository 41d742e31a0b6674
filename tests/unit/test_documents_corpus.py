from pathlib import Path

import pytest

from aos_language.load import LoadedBundle, load_bundle

pytestmark = pytest.mark.corpus

WARNINGS = {
    "armadillo-finer": [
        "IROS.environment.json:107:9 AOS137",
        "IROS.environment.json:112:9 AOS137",
        "IROS.serve_can_to_person glue.json:16:30 AOS117",
    ],
    "armadillo-rough": [
        "IROS.basic_pick.json:34:122 AOS122",
        "IROS.environment.json:107:9 AOS137",
        "IROS.environment.json:112:9 AOS137",
        "IROS.serve_can_to_person glue.json:16:30 AOS117",
    ],
    "paper-example-json": [
        "aosPaper.environment.json:75:50 AOS127",
        "aosPaper.environment.json:96:22 AOS133",
    ],
    "paper-example-sdl": [
        f"example.ef:{place} AOS127"
        for place in ("14:34", "17:22", "20:22", "23:22", "26:111", "29:113", "32:111")
    ],
    "sampling-rate": [
        "plps_domain.move_to_point glue.json:17:53 AOS118",
        "plps_domain.move_to_point glue.json:21:53 AOS118",
        "plps_domain.move_to_point.json:10:22 AOS140",
        "plps_domain.move_to_point.json:14:22 AOS140",
        "plps_domain.move_to_point.json:22:124 AOS127",
        "plps_domain.observe_can glue.json:17:53 AOS118",
        "plps_domain.observe_can glue.json:21:53 AOS118",
        "plps_domain.pick glue.json:17:53 AOS118",
        "plps_domain.pick glue.json:21:53 AOS118",
        "plps_domain.pick.json:13:61 AOS127",
        "plps_domain.pick.json:16:18 AOS102",
    ],
    "sarsop-simple": [
        "inc_half.am:5:16 AOS118",
        "inc_half.am:13:10 AOS110",
        "inc_half.am:13:23 AOS110",
        "inc_half.am:13:36 AOS110",
        "inc_half.sd:2:1 AOS125",
        "inc_half.sd:9:1 AOS125",
        "inc_one.am:5:16 AOS118",
        "inc_one.am:13:10 AOS110",
        "inc_one.am:13:23 AOS110",
        "inc_one.am:13:36 AOS110",
        "simple_sarsop.ef:7:12 AOS127",
        "simple_sarsop.ef:14:1 AOS137",
    ],
    "tic-tac-toe-json": [],
    "tic-tac-toe-sdl": [],
    "turtlebot-visit": [
        "turtleBotVisitLocations.environment.json:84:48 AOS127",
        "turtleBotVisitLocations.environment.json:157:52 AOS127",
    ],
    "wildfire": [
        *(f"cut_out glue.json:34:{column} AOS110" for column in (57, 70, 83)),
        *(f"cut_out.json:{line}:22 AOS140" for line in (10, 14)),
        "environment.json:4:18 AOS139",
        *(f"environment.json:{line}:29 AOS141" for line in (29, 34, 39)),
        *(f"put_out glue.json:34:{column} AOS110" for column in (57, 70, 83)),
        *(f"put_out.json:{line}:22 AOS140" for line in (10, 14)),
    ],
}


def findings(loaded: LoadedBundle) -> list[str]:
    return [f"{diagnostic.span} {diagnostic.code}" for diagnostic in loaded.diagnostics]


@pytest.mark.parametrize("name", WARNINGS)
def test_an_original_bundle_loads_with_these_warnings(corpus: Path, name):
    loaded = load_bundle(corpus / name)
    assert loaded.project is not None
    assert not loaded.has_errors
    assert findings(loaded) == WARNINGS[name]


def test_the_last_dynamic_model_of_a_file_counts(corpus: Path):
    project = load_bundle(corpus / "sarsop-simple").project
    (block,) = project.skill("inc_half").model.dynamic_model
    assert "bool b = AOS.Bernoulli(0.2);" in block.code.code
