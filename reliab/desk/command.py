"""`reliab desk`: the whole product in the browser, on this computer alone."""

from pathlib import Path
from typing import Annotated, TypedDict

from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say, write_json
from reliab.app.declaration import argument, group
from reliab.app.options import OUTPUT
from reliab.core.errors import InputError


@group
class _Desk(TypedDict, total=False):
    """What the desk is asked.

    folder: Folder with your tests, rigs and campaigns; all that the desk writes lies in it.
    port: Port of this computer's own address; by default any that is free.
    no_browser: Print the address, and do not open the browser.
    """

    folder: Annotated[Path, argument("[FOLDER]", default=Path())]
    port: Annotated[int, OUTPUT.option("PORT", default=0, limits={"min": 0, "max": 65535})]
    no_browser: Annotated[bool, OUTPUT.flag()]


@takes(_Desk)
def desk(request: Request) -> None:
    """Judge, follow, compare and diagnose tests in the browser; nothing leaves this computer."""
    try:
        from reliab.desk.server import serve_desk
    except ModuleNotFoundError as error:
        raise InputError(
            "The desk needs Panel, which is not installed",
            value=f"no module {error.name}",
            remedy='Install it with: pip install "reliab[desk]"',
        ) from error

    def tell(address: str) -> None:
        if not write_json({"address": address}, request.json_target):
            say(f"The desk answers at {address}", "Press Ctrl+C to end it.")

    serve_desk(
        request.folder,
        port=request.port,
        browser=not request.no_browser,
        say=tell,
        name_options=request.write_as_options,
    )
