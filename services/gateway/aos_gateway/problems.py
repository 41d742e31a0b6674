"""Errors as problem details (RFC 9457), with the AOS code, what to do, and the places in documents."""

from http import HTTPStatus

import msgspec

from aos_protocol.diagnostics import Diagnostic
from aos_protocol.errors import CODES, AosError

PROBLEM_TYPE = "application/problem+json"

_BY_CODE = {
    "AOS501": HTTPStatus.NOT_FOUND,
    "AOS515": HTTPStatus.CONFLICT,
    "AOS516": HTTPStatus.UNPROCESSABLE_ENTITY,
    "AOS601": HTTPStatus.GATEWAY_TIMEOUT,
    "AOS602": HTTPStatus.BAD_REQUEST,
    "AOS606": HTTPStatus.INTERNAL_SERVER_ERROR,
    "AOS802": HTTPStatus.CONFLICT,
    "AOS901": HTTPStatus.BAD_REQUEST,
    "AOS902": HTTPStatus.NOT_FOUND,
    "AOS903": HTTPStatus.UNAUTHORIZED,
    "AOS904": HTTPStatus.FORBIDDEN,
    "AOS905": HTTPStatus.CONFLICT,
}
_BY_HUNDRED = {
    "1": HTTPStatus.UNPROCESSABLE_ENTITY,
    "2": HTTPStatus.UNPROCESSABLE_ENTITY,
    "5": HTTPStatus.CONFLICT,
    "6": HTTPStatus.SERVICE_UNAVAILABLE,
    "8": HTTPStatus.UNPROCESSABLE_ENTITY,
}


class Problem(msgspec.Struct, frozen=True, omit_defaults=True):
    """The body of every answer that is no success.

    `type` names the code as a URN, `title` is the code's meaning, `detail` what happened. `hint` says what to
    do. `place` is that of the first finding, as `file:line:column`; `diagnostics` are all of them.
    """

    type: str
    title: str
    status: int
    detail: str
    code: str
    hint: str = ""
    place: str = ""
    diagnostics: tuple[Diagnostic, ...] = ()


def status_of(code: str) -> HTTPStatus:
    """The HTTP status of an error."""
    return _BY_CODE.get(code) or _BY_HUNDRED.get(code[3:4], HTTPStatus.INTERNAL_SERVER_ERROR)


def problem_of(error: AosError, status: HTTPStatus | None = None) -> Problem:
    """The problem that stands for an error. Its status is the code's where none is given."""
    first = next((found for found in error.diagnostics if found.is_error), None) or next(
        iter(error.diagnostics), None
    )
    return Problem(
        type=f"urn:aos:{error.code}",
        title=CODES.get(error.code, "an error"),
        status=status or status_of(error.code),
        detail=error.message,
        code=error.code,
        hint=error.hint,
        place=str(first.span) if first is not None else "",
        diagnostics=error.diagnostics,
    )
