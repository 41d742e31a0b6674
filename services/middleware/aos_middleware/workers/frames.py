"""The language between the service and a mapping worker, over two pipes.

A frame is four bytes of length, most significant first, and a msgpack body. The service asks, the worker
answers each question with one frame; a question that brings no answer ends with the worker's process.
"""

from typing import Any

import msgspec

MAX_FRAME_BYTES = 64 * 1024 * 1024


class Load(msgspec.Struct, frozen=True, tag=True):
    """The module to run, once and first. Its statements may take `load_s`, each later evaluation
    `evaluation_s`. `allowed_imports` names the top-level modules it may import; None is any.
    `truths` are the local variables of the type bool."""

    python: str
    file_name: str
    load_s: float
    evaluation_s: float
    allowed_imports: tuple[str, ...] | None = None
    truths: tuple[str, ...] = ()


class Begin(msgspec.Struct, frozen=True, tag=True):
    """An activation starts: local variables anew from these parameters. Answered by Begun.

    `low_level` are low-level values that replace what the parameters have at these paths.
    """

    parameters: dict[str, Any]
    low_level: dict[str, Any] = {}


class Take(msgspec.Struct, frozen=True, tag=True):
    """Topic messages in the order in which they came: (topic, fields). Answered by Taken."""

    messages: list[tuple[str, dict[str, Any]]]


class Finish(msgspec.Struct, frozen=True, tag=True):
    """The call's result; the activation is over. Answered by Observed.

    `status` and `error` are what the rules see of a skill that has failed; then there is no result.
    """

    result: dict[str, Any]
    status: str = "succeeded"
    error: str = ""


class Done(msgspec.Struct, frozen=True, tag=True):
    """It is done."""


class Taken(msgspec.Struct, frozen=True, tag=True):
    """So many of the messages were evaluated: all of them, or up to the first one that `stops` the skill."""

    messages: int
    stops: bool = False


class Begun(msgspec.Struct, frozen=True, tag=True):
    """The fields of the call."""

    fields: dict[str, Any]


class Observed(msgspec.Struct, frozen=True, tag=True):
    """The response, None if no rule holds, and all local variables as text.

    `assigned` are the low-level values that the rule gives, by the document's paths.
    """

    response: str | None
    local_variables: dict[str, str]
    assigned: dict[str, Any] = {}


class Raised(msgspec.Struct, frozen=True, tag=True):
    """Mapping code raised at a line and column of the module, from 1; 0 where the module is not involved.

    `unset` names the local variables that the code was given as None, `field` the field of the call that
    cannot be sent.
    """

    error: str
    line: int
    column: int
    unset: tuple[str, ...] = ()
    local_variables: dict[str, str] = {}
    field: str = ""


Question = Load | Begin | Take | Finish
Answer = Done | Taken | Begun | Observed | Raised

_encoder = msgspec.msgpack.Encoder()
_questions = msgspec.msgpack.Decoder(Question)
_answers = msgspec.msgpack.Decoder(Answer)


def pack(message: Question | Answer) -> bytes:
    """The frame of a message; an exception of msgspec's or of Python's if it holds no plain data."""
    body = _encoder.encode(message)
    if len(body) > MAX_FRAME_BYTES:
        raise ValueError(f"{len(body)} bytes are too much for one message")
    return len(body).to_bytes(4, "big") + body


def read_question(body: bytes) -> Question:
    """The question in a frame's body."""
    question: Question = _questions.decode(body)
    return question


def read_answer(body: bytes) -> Answer:
    """The answer in a frame's body; msgspec.MsgspecError if it is none."""
    answer: Answer = _answers.decode(body)
    return answer
