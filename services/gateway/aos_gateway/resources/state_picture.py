"""The picture of a mission's state at a step, drawn by the bundle's `picture.py` when somebody looks."""

import asyncio

from aos_gateway.operations import Content
from aos_gateway.resources.documents import picture_of
from aos_gateway.resources.reading import decision
from aos_gateway.runs.run import KeptRun
from aos_gateway.shared import Gateway
from aos_protocol.errors import GatewayError

_NEVER_CHANGES_S = 3600


async def state_picture(gateway: Gateway, mission: str, step: str) -> Content:
    """The picture that the bundle's picture.py draws of the likeliest state after a step, as SVG or PNG."""
    view = await decision(gateway, mission, step)
    record = view.observed or view.decided
    found = await gateway.shelf.run_of_mission(mission)
    if record is None or not isinstance(found, KeptRun):
        raise GatewayError(f"the documents of {mission} are not on this machine")
    source = await asyncio.to_thread(picture_of, found, record.revision)
    if source is None:
        hint = "A bundle may have a picture.py; see docs/page.md"
        raise GatewayError(f"the documents of {mission} draw no state", hint=hint)
    drawn = await gateway.drawings.of(record, source)
    media = "image/svg+xml" if drawn.is_svg else "image/png"
    return Content(drawn.data, media, _NEVER_CHANGES_S if view.observed is not None else 0)
