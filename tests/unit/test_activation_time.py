from types import SimpleNamespace
from typing import Any

from mapping_documents import emitted
from scripted_missions import Clock

from aos_middleware.activations.activation import _Activation
from aos_protocol.keys import Keys
from aos_protocol.messages import Activate, ActivationId

LOOK = "project: fetch\nresponse: seen\nresponse_rule: True\nmodule_activation: skill\npath: /look\n"


async def test_the_start_of_a_mappings_process_takes_nothing_of_it():
    clock = Clock()

    async def start():
        clock.now_s += 9.0

    async def begin(*_: Any) -> dict[str, Any]:
        return {}

    low_level = SimpleNamespace(arguments=lambda *_: ())
    around: Any = SimpleNamespace(bus=None, keys=Keys("r"), clock=clock, published={}, low_level=low_level)
    evaluator: Any = SimpleNamespace(emitted=emitted(LOOK), start=start, begin=begin)
    request = Activate(ActivationId("m", 1), "look", {}, 5.0)
    activation = _Activation(request, evaluator, around, is_taken_up=False)
    await activation._fields()
    assert activation.call._ends_at_s == 14.0
