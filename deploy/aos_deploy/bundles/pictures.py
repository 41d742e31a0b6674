"""The trial of a bundle's `picture.py` by `aos lint`: it draws the state at the beginning of a mission."""

from collections.abc import Mapping

from aos_language.reading.picture_file import PICTURE
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.errors import DocumentError
from aos_solver.building.build import BuiltModel
from aos_solver.child.engine import Engine


async def picture_findings(files: Mapping[str, bytes], built: BuiltModel) -> tuple[Diagnostic, ...]:
    """Says why the initial belief cannot be drawn, at the line; nothing where there is no `picture.py`."""
    if PICTURE not in files:
        return ()
    from aos_middleware.workers.picture import draw

    async with await Engine.start(built, seed=1) as engine:
        belief = await engine.summary()
        skills = list(engine.description.actions)[:1]
    step = {
        "number": 0,
        "action": skills[0].name if skills else "",
        "skill": skills[0].skill if skills else "",
        "parameters": skills[0].parameters if skills else {},
        "status": "",
        "response": "",
    }
    try:
        await draw(files[PICTURE].decode("utf-8", "replace"), belief, step)
    except DocumentError as error:
        return error.diagnostics
    return ()
