import pytest
from texts import encoded

from aos_language.load import load_files
from aos_protocol.diagnostics import Severity

ENVIRONMENT = """project: shop
horizon: 3
define_type: Item
variable: anyValue place of Place
state_variable: int sold
action_parameter: Item cup
code:
state.cup.place = home;
reward_code:
if (state.sold > 3) { __reward = 1; __isGoalState = true; }
"""
LOW_LEVEL = """project: shop
define_type: Place
variable: float x
constant: Place home
code:
import math
home.x = math.pi
"""
SKILL = """project: shop
parameter: Item item

dynamic_model:
state__.sold = state.sold + 1;
__moduleResponse = AOS.Bernoulli(0.5) ? sold : refused;
"""
MAPPING = """project: shop
response: sold
response_rule: {rule}
response: refused
response_rule: {second}

module_activation: skill
imports: {imports}
path: /sell
parameter: what
code:
{field}

local_variable: item
action_parameter: item

local_variable: answer
from_ros_service_response: true
code:
{code}

local_variable: heard
topic: /heard
initial_value: {initial}
code:
{topic}
"""
RIGHT = {
    "rule": "answer and heard",
    "second": "True",
    "imports": "import: json",
    "field": "item",
    "code": "answer = __input.answer",
    "initial": "None",
    "topic": "return __input.text",
}


def finding_texts(**texts: str) -> list[str]:
    files = {
        "shop.ef": ENVIRONMENT,
        "shop.lf": texts.pop("low_level", LOW_LEVEL),
        "sell.sd": SKILL,
        "sell.am": MAPPING.format(**{**RIGHT, **texts}),
    }
    found = load_files(encoded(files)).diagnostics
    return [
        f"{finding.span}: {finding.severity}: {finding.message}. {finding.hint}"
        for finding in found
        if finding.code != "AOS133"
    ]


@pytest.mark.parametrize(
    "texts",
    [
        {},
        {"rule": "(n := len(answer)) and heard", "second": "n > 3"},
        {"rule": "any(part in answer for part in heard)"},
        {"rule": "(lambda text: text)(answer) == heard"},
        {"rule": "__skill_status == 'failed' and __skill_error"},
        {"rule": "json.loads(answer) == heard"},
        {"rule": "answer == home.x or heard == Place or math.pi"},
        {"imports": "from: shops import: *", "rule": "anything(answer, heard)"},
        {"imports": "from: shops import: Basket as Bag, Till", "rule": "Bag(answer) == Till(heard)"},
        {"field": "[each for each in item]"},
        {"code": "import re\nfor part in re.split(',', __input.answer):\n    answer = part"},
        {"code": "try:\n    answer = numpy.mean(__input.answer)\nexcept NameError:\n    answer = 0"},
        {"code": "def first(text):\n    return text[0]\nanswer = first(__input.answer)"},
        {"code": "with open('x') as file:\n    answer = file.read()"},
        {"code": "from os.path import *\nanswer = join('a', __input.answer)"},
        {"code": "match __input.answer:\n    case [one, *rest]:\n        answer = (one, rest)"},
        {"initial": "home.x if parameters else Place"},
        {"topic": "return heard if __input.text is None else item"},
        {"topic": "input = __input\nreturn input.text"},
    ],
)  # fmt: skip
def test_what_python_allows_is_not_told(texts):
    assert finding_texts(**texts) == []


@pytest.mark.parametrize(
    ("texts", "place", "rest"),
    [
        ({"rule": "answr and heard"}, "sell.am:3:16", "`answr`. Did you mean `answer`?"),
        ({"rule": "heard and\n  answer == zebra"}, "sell.am:4:13", "`zebra`. The local"),
        ({"rule": "answer == true"}, "sell.am:3:26", "`true`. Python writes `True`"),
        ({"rule": "state.sold > 1"}, "sell.am:3:16", "`state`. A mapping knows"),
        ({"rule": "__input.answer"}, "sell.am:3:16", "`__input`. It is there in"),
        ({"second": "unknown_name"}, "sell.am:5:16", "`unknown_name`. The local"),
        ({"field": "itm"}, "sell.am:12:1", "`itm`. Did you mean `item`?"),
        ({"code": "answer = np.mean(__input.answer)"}, "sell.am:20:10", "`np`."),
        ({"code": "if __input.ok:\n    answer = reply"}, "sell.am:21:14", "`reply`."),
        ({"code": "try:\n    answer = reply\nexcept KeyError:\n    pass"}, "sell.am:21:14", "`reply`."),
        ({"initial": "heard"}, "sell.am:24:16", "`heard`."),
        ({"topic": "return input_.text"}, "sell.am:26:8", "`input_`. Did you mean `__input`?"),
        ({"topic": "return msg.text"}, "sell.am:26:8", "`msg`. What has come is `__input`"),
        ({"low_level": LOW_LEVEL.replace("import math\n", "")},
         "shop.lf:6:10", "`math`."),
    ],
)  # fmt: skip
def test_a_name_that_nothing_gives_is_an_error_at_its_place(texts, place, rest):
    (found,) = finding_texts(**texts)
    assert found.startswith(f"{place}: error: no local variable gives {rest}")


def test_code_of_a_topic_that_would_reach_the_next_activation_is_refused():
    (found,) = finding_texts(topic="global count\ncount += 1\nreturn count")
    assert found.startswith("sell.am:26:1: error: `global count` would reach the next activation")


def test_a_message_that_is_made_by_position_is_told_before_the_run():
    imports = "from: geometry_msgs.msg import: Point"
    assert finding_texts(imports=imports, rule="Point(x=answer) == heard") == []
    (found,) = finding_texts(imports=imports, rule="Point(answer) == heard")
    assert found.startswith("sell.am:3:16: warning: Point is given fields by position")


@pytest.mark.parametrize(
    ("rule", "column", "hint"),
    [
        ("answer && heard", 24, "Python writes `and`, `or`, `not`"),
        ("answer = heard", 23, "To compare, write `==`"),
    ],
)
def test_an_operator_that_no_rule_has_is_told_with_the_right_one(rule, column, hint):
    (found,) = finding_texts(rule=rule)
    assert found.startswith(f"sell.am:3:{column}: error: this is not Python")
    assert found.endswith(hint)


def test_a_rule_that_is_never_tried_fails_in_no_run():
    warned = "sell.am:5:16: warning: no local variable gives `unknown_name`."
    assert any(text.startswith(warned) for text in finding_texts(rule="True", second="unknown_name"))


def test_a_request_from_elsewhere_in_documents_to_plan_with_is_a_warning():
    mapping = (
        "project: shop\nresponse: sold\nresponse_rule: True\nmodule_activation: skill\n"
        "path: /sell\nparameter: what\ncode:\nPoint(x=goal_x)\n"
    )
    files = {"shop.ef": ENVIRONMENT, "shop.lf": LOW_LEVEL, "sell.sd": SKILL, "sell.am": mapping}
    loaded = load_files(encoded(files))
    (error,) = (finding for finding in loaded.diagnostics if finding.severity is Severity.ERROR)
    assert "goal_x" not in error.message
    warned = [finding.message for finding in loaded.diagnostics if finding.severity is Severity.WARNING]
    assert "no local variable gives `goal_x`" in warned


def test_the_function_input_in_the_place_of_the_message_is_told():
    (only,) = finding_texts(topic="return input.text")
    assert "`input` is a function of Python, which has no message. Write `__input`" in only


def test_what_a_module_of_python_does_not_have_is_told():
    (of_rule,) = finding_texts(rule="json.loas(answer)")
    assert of_rule == "sell.am:3:21: warning: the module json has no `loas`. Did you mean `loads`?"
    code = "import math\ntry:\n    answer = math.sqr(2)\nexcept KeyError:\n    answer = 2"
    (of_code,) = finding_texts(code=code)
    assert of_code.startswith("sell.am:22:19: warning: the module math has no `sqr`.")
    assert not finding_texts(code=code.replace("KeyError", "AttributeError"))
