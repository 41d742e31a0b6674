import base64
import json
import shutil

import pytest
from commands import aos
from models import built_bundle
from places import BUNDLES

from aos_deploy.bundles.pictures import picture_findings
from aos_language.load import load_bundle, load_files, read_bundle_files
from aos_middleware.workers.picture import Drawn, draw, likeliest_state
from aos_protocol.errors import DocumentError
from aos_protocol.messages import BeliefSummary, Marginal

HEAD = "def draw(state, belief, step):\n"
SVG = '<svg xmlns="http://www.w3.org/2000/svg"/>'
PNG = base64.b64decode(
    b"iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
BELIEF = BeliefSummary(
    (
        Marginal("at", {"lab": 0.75, "hall": 0.25}),
        Marginal("count", {"2": 1.0}),
        Marginal("lit", {"true": 1.0}),
        Marginal("depth", {"0.1": 0.01, "0.2": 0.01}, 0.98, (0.1, 0.8, 1.5, 2.0, 2.5)),
    ),
    *(0.5, 0.25, 0.0, 2, True),
)
STEP = {"number": 3, "action": "go(to=lab)", "response": "arrived"}


def test_the_likeliest_value_of_each_variable_is_plain_data():
    assert likeliest_state(BELIEF) == {"at": "lab", "count": 2, "lit": True, "depth": 1.5}


async def test_a_picture_is_an_svg_or_a_png_of_state_belief_and_step():
    text = (
        HEAD
        + "    print('this goes nowhere')\n"
        + "    words = f\"{state['at']} {belief['at']['hall']} {step['response']} {state['count'] + 1}\"\n"
        + "    return f'<svg xmlns=\"http://www.w3.org/2000/svg\"><text>{words}</text></svg>'\n"
    )
    drawn = await draw(text, BELIEF, STEP)
    assert drawn == Drawn(SVG.replace("/>", "><text>lab 0.25 arrived 3</text></svg>").encode(), is_svg=True)
    assert await draw(f"{HEAD}    return {PNG!r}", BELIEF, STEP) == Drawn(PNG, is_svg=False)


@pytest.mark.parametrize(
    ("body", "line", "said"),
    [
        ("    x = 1\n    return x / 0", 3, "ZeroDivisionError"),
        ("    return state['lion']", 2, "KeyError: 'lion'"),
        ("    return 7", 1, "draw has returned int"),
        ("    return '<p/>'", 1, "no SVG"),
        (f"    return {SVG[:-2]!r} + '>' + ' ' * 2_000_000 + '</svg>'", 1, "bytes, and may have"),
        ("    while True: pass", 2, "more than 1 s of processor time"),
        ("    sum(iter(int, 1))", 1, "more than 2 s of processor time"),
        ("    import os; os._exit(3)", 1, "with status 3"),
        ("    import os; os.kill(os.getpid(), 11)", 1, "ended its process"),
        ("    raise SystemExit('no')", 2, "SystemExit: no"),
        (
            "    import os\n"
            "    for descriptor in range(3, 9):\n"
            "        try: os.write(descriptor, b'x' * 3_000_000)\n"
            "        except OSError: pass",
            1,
            "it has written more than",
        ),
        ("    x = [0] * 10**12", 2, "MemoryError"),
        ("    return open('/etc/passwd').read()", 2, "PermissionError"),
        ("    import socket; socket.socket()", 2, "PermissionError"),
    ],
)
async def test_code_that_draws_nothing_is_told_at_its_line_and_harms_nobody(body, line, said):
    with pytest.raises(DocumentError) as caught:
        await draw(HEAD + body + "\n", BELIEF, STEP)
    (found,) = caught.value.diagnostics
    assert (caught.value.code, found.code, found.span.file) == ("AOS148", "AOS148", "picture.py")
    assert found.span.line == line
    assert said in found.message


@pytest.mark.parametrize(
    ("text", "place", "said"),
    [
        ("def draw(state, belief, step):\n    return (\n", "2:12", "no valid Python"),
        ("def paint(): pass\n", "1:1", "there is no function draw"),
        ("\ndef draw(state): pass\n", "2:1", "does not take a state, a belief and a step"),
    ],
)
def test_a_picture_that_is_no_python_is_a_warning_of_lint(text, place, said):
    files = {**read_bundle_files(BUNDLES / "errand")[0], "picture.py": text.encode()}
    loaded = load_files(files)
    assert loaded.project is not None
    (found,) = loaded.diagnostics
    assert (found.code, str(found.span), found.is_error) == ("AOS148", f"picture.py:{place}", False)
    assert said in found.message


def test_lint_tells_once_what_is_wrong_with_a_picture(tmp_path):
    shutil.copytree(BUNDLES / "errand", tmp_path / "errand")
    (tmp_path / "errand" / "picture.py").write_text("def draw(state, belief, step):\n    return (\n")
    told = aos("lint", tmp_path / "errand", "--format", "json")
    found = [each["code"] for each in json.loads(told.stdout)["diagnostics"]]
    assert found.count("AOS148") == 1


async def test_lint_draws_the_beginning_of_a_mission():
    files = read_bundle_files(BUNDLES / "errand")[0]
    built = await built_bundle(BUNDLES / "errand")
    assert await picture_findings(files, built) == ()
    wrong = {**files, "picture.py": f"{HEAD}    return state['lion']\n".encode()}
    (found,) = await picture_findings(wrong, built)
    assert (str(found.span), found.message) == ("picture.py:2:12", "KeyError: 'lion'")


def test_another_picture_is_another_revision_and_the_same_model():
    files = read_bundle_files(BUNDLES / "errand")[0]
    before, after = (
        load_bundle(BUNDLES / "errand"),
        load_files({**files, "picture.py": HEAD.encode() + b" pass"}),
    )
    assert "picture.py" in before.files
    assert before.digest != after.digest
    assert before.project == after.project
