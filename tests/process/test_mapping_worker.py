import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from typing import Any

import pytest
import pytest_asyncio
from mapping_documents import emitted
from mapping_runs import HEAD
from processes import descendants, until_ended

from aos_middleware.workers.evaluator import EvaluationLimits, Evaluator, MappingFault
from aos_middleware.workers.frames import Load, pack

RESULT = (
    HEAD
    + """\
response: done
response_rule: True
local_variable: value
from_ros_service_response: true
code:
"""
)
RESULT_LINE = 9
"""The line of the document on which the code after RESULT begins."""

Start = Callable[..., Evaluator]


@pytest_asyncio.fixture
async def evaluator(tmp_path) -> AsyncIterator[Start]:
    """Makes evaluators of documents' texts; their workers end with the test."""
    made: list[Evaluator] = []

    def make(text: str, **limits: Any) -> Evaluator:
        wanted = EvaluationLimits(**{"evaluation_s": 20.0, **limits})
        made.append(Evaluator(emitted(text), tmp_path / "logs" / "mapping.log", wanted))
        return made[-1]

    yield make
    for evaluator in made:
        await evaluator.close()


async def fault_of(evaluator: Evaluator, result: dict[str, object] | None = None) -> MappingFault:
    try:
        await evaluator.begin({})
        await evaluator.finish(result or {})
    except MappingFault as fault:
        return fault
    pytest.fail("the mapping raised nothing")


async def works(evaluator: Evaluator) -> bool:
    return await evaluator.begin({}) == {}


async def test_an_activation_goes_through_the_worker(evaluator: Start):
    mapping = evaluator(
        HEAD
        + """\
parameter: x
code:
goal_x
response: near
response_rule: success and distance < 1.0
local_variable: goal_x
action_parameter: goal.x
local_variable: success
from_ros_service_response: true
code:
success = __input.success
local_variable: distance
topic: /distance
message_type: Float
code:
return abs(goal_x - __input.data)
"""
    )
    assert await mapping.begin({"goal": {"x": 2.0}}) == {"x": 2.0}
    await mapping.take([("/distance", {"data": 5.0}), ("/distance", {"data": 1.5})])
    observed = await mapping.finish({"success": True})
    assert observed.response == "near"
    assert observed.local_variables == {"goal_x": "2.0", "success": "true", "distance": "0.5"}


async def test_an_exception_names_the_documents_line_and_the_worker_goes_on(evaluator: Start):
    mapping = evaluator(RESULT + "value = 1\nvalue = __input.sucess\n")
    fault = await fault_of(mapping, {"success": True})
    pid = mapping.pid
    assert fault.code == "AOS401"
    assert "did you mean 'success'" in str(fault)
    assert fault.hint == "Mend the abstraction mapping of look, or what its adapter gives"
    assert (fault.diagnostics[0].span.file, fault.diagnostics[0].span.line) == ("look.am", RESULT_LINE + 1)
    assert await works(mapping)
    assert mapping.pid == pid


@pytest.mark.parametrize("code", ["while True:\n    pass", "len(str(7 ** 10 ** 8))"])
async def test_code_that_does_not_finish_is_stopped_at_its_line(evaluator: Start, code):
    mapping = evaluator(RESULT + f"{code}\nvalue = 1\n", evaluation_s=1.0)
    fault = await fault_of(mapping)
    assert fault.code == "AOS403"
    assert "took more than 1 s" in str(fault)
    assert fault.diagnostics[0].span.line in (RESULT_LINE, RESULT_LINE + 1)
    assert await works(mapping)


async def test_a_topics_endless_loop_is_stopped_at_its_line(evaluator: Start):
    mapping = evaluator(
        HEAD + "local_variable: level\ntopic: /level\nmessage_type: Int\ncode:\nwhile __input.x:\n    pass\n",
        evaluation_s=1.0,
    )
    await mapping.begin({})
    await mapping.take([("/level", {"x": 0})])
    with pytest.raises(MappingFault) as fault:
        await mapping.take([("/level", {"x": 1})])
    assert fault.value.code == "AOS403"
    assert fault.value.diagnostics[0].span.line in (8, 9)


async def test_a_crash_names_the_documents_line(evaluator: Start):
    mapping = evaluator(RESULT + "import ctypes\nctypes.string_at(0)\nvalue = 1\n")
    fault = await fault_of(mapping)
    assert fault.code == "AOS401"
    assert "by signal 11" in str(fault)
    assert fault.diagnostics[0].span.line == RESULT_LINE + 1
    assert await works(mapping)


@pytest.mark.parametrize("code", ["os._exit(0)", "os.kill(os.getpid(), 9)", "os.closerange(3, 64)"])
async def test_code_that_ends_its_process_is_a_fault_and_a_new_worker_is_started(evaluator: Start, code):
    mapping = evaluator(RESULT + f"import os\n{code}\nvalue = 1\n")
    fault = await fault_of(mapping)
    assert fault.code == "AOS401"
    assert await works(mapping)


async def test_a_killed_worker_is_replaced_for_the_next_activation(evaluator: Start):
    mapping = evaluator(RESULT + "value = 1\n")
    await mapping.begin({})
    assert mapping.pid is not None
    workers = descendants(mapping.pid)
    os.kill(mapping.pid, signal.SIGKILL)
    await until_ended(workers)
    with pytest.raises(MappingFault, match="the worker was killed by signal 9") as fault:
        await mapping.finish({})
    assert fault.value.code == "AOS401"
    await mapping.begin({})
    assert (await mapping.finish({})).response == "done"


async def test_a_frozen_worker_is_no_fault_of_the_code_and_is_replaced(evaluator: Start):
    mapping = evaluator(RESULT + "value = 1\n", evaluation_s=3.0)
    await mapping.begin({})
    assert mapping.pid is not None
    for process in descendants(mapping.pid):
        os.kill(process, signal.SIGSTOP)
    with pytest.raises(MappingFault, match="the worker was frozen by a signal"):
        await mapping.finish({})
    await mapping.begin({})
    await mapping.finish({})


async def test_memory_beyond_the_limit_is_an_exception(evaluator: Start):
    mapping = evaluator(RESULT + "value = 'a' * (1 << 30)\n", address_space_bytes=512 * 1024**2)
    fault = await fault_of(mapping)
    assert "MemoryError" in str(fault)
    assert fault.diagnostics[0].span.line == RESULT_LINE


async def test_a_module_that_cannot_be_loaded_names_the_import(evaluator: Start):
    mapping = evaluator(HEAD.replace("path:", "imports: import: no_such_module_at_all\npath:"))
    with pytest.raises(MappingFault, match="No module named 'no_such_module_at_all'") as fault:
        await mapping.start()
    assert fault.value.diagnostics[0].span.line == 3
    assert mapping.pid is None


@pytest.mark.parametrize(
    ("value", "why"),
    [("object()", "a value of type object is no plain data"), ("2 ** 80", "can't serialize ints")],
)
async def test_what_cannot_be_sent_is_refused_at_its_field(evaluator: Start, value, why):
    mapping = evaluator(HEAD + f"parameter: a\ncode:\n1\nparameter: b\ncode:\n{value}\n")
    fault = await fault_of(mapping)
    assert f"the field b of the call cannot be sent: {why}" in str(fault)
    assert (fault.code, fault.diagnostics[0].span.line) == ("AOS401", HEAD.count("\n") + 6)


async def test_prints_go_to_the_mappings_log_and_not_into_the_answers(evaluator: Start, tmp_path):
    code = "import os, sys\nprint('from print')\nsys.stdout.write('from write ')\n"
    code += "os.write(1, b'from descriptor')\nvalue = sys.stdin.read()\n"
    mapping = evaluator(RESULT + code)
    await mapping.begin({})
    assert (await mapping.finish({})).local_variables == {"value": '""'}
    printed = (tmp_path / "logs" / "mapping.log").read_text()
    assert printed == "from print\nfrom write from descriptor"


async def test_a_flood_of_prints_is_cut_off_and_harms_nothing(evaluator: Start, tmp_path):
    mapping = evaluator(RESULT + "print('x' * 700_000)\nprint('y' * 700_000)\nprint('z')\nvalue = 1\n")
    await mapping.begin({})
    assert (await mapping.finish({})).response == "done"
    printed = (tmp_path / "logs" / "mapping.log").read_text()
    assert len(printed) < 1_500_000
    assert printed.endswith("(the rest is left out)\n")


async def test_a_cancelled_evaluation_leaves_no_answer_for_the_next(evaluator: Start):
    mapping = evaluator(RESULT + "import time\ntime.sleep(__input.s)\nvalue = 1\n")
    await mapping.begin({})
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.1):
            await mapping.finish({"s": 3})
    await mapping.begin({})
    assert (await mapping.finish({"s": 0})).response == "done"


async def test_mapping_code_starts_no_process(evaluator: Start, tmp_path):
    code = "import subprocess\nvalue = subprocess.Popen(['sleep', '600'], start_new_session=True).pid\n"
    mapping = evaluator(RESULT + code)
    await mapping.begin({})
    with pytest.raises(MappingFault, match="PermissionError"):
        await mapping.finish({})


def test_a_worker_whose_middleware_was_killed_ends_without_a_word():
    heard_by_nobody, answers = os.pipe()
    os.close(heard_by_nobody)
    worker = subprocess.run(
        [sys.executable, "-I", "-m", "aos_middleware.workers.worker"],
        input=pack(Load("", "mapping.py", load_s=20.0, evaluation_s=20.0)),
        stdout=answers,
        stderr=subprocess.PIPE,
        check=False,
    )
    os.close(answers)
    assert (worker.returncode, worker.stderr) == (0, b"")


@pytest.mark.parametrize(
    "answer",
    [
        r"b'\x93\xa8Observed\xa1\xff\x80'",
        r"b'\x82\xa4type\xa8Observed\xa8response' + b'\x91' * 100000",
        r"b'\x82\xa4type\xa8Observed\xa8response\xa1\xff'",
    ],
)
async def test_code_that_answers_in_the_place_of_its_worker_is_a_fault_of_the_mapping(
    evaluator: Start, answer
):
    code = f"""import os
frame = {answer}
for pipe in range(3, 16):
    try: os.write(pipe, len(frame).to_bytes(4, 'big') + frame)
    except OSError: pass
value = 1
"""
    fault = await fault_of(evaluator(RESULT + code))
    assert "the worker sent no message" in fault.message
