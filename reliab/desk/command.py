"""`reliab desk`: the whole product in the browser, on this computer alone."""

from dataclasses import dataclass
from pathlib import Path

from reliab.app.cli.demand import Demand, argument, flag, option, takes
from reliab.app.cli.options import JSON_TARGET
from reliab.app.cli.output import say, write_json
from reliab.core.errors import InputError


@dataclass(frozen=True, kw_only=True)
class DeskDemand(Demand):
    """Options of `reliab desk`."""

    folder: Path = argument(
        "[FOLDER]",
        "Folder with your tests, rigs and campaigns; all that the desk writes lies in it.",
        default=Path(),
    )
    port: int = option(
        "PORT",
        "Port of this computer's own address; by default any that is free.",
        default=0,
        min=0,
        max=65535,
    )
    no_browser: bool = flag("Print the address, and do not open the browser.")
    json_target: str | None = JSON_TARGET


@takes(DeskDemand)
def desk(demand: DeskDemand) -> None:
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
        if not write_json({"address": address}, demand.json_target):
            say(f"The desk answers at {address}", "Press Ctrl+C to end it.")

    serve_desk(
        demand.folder, port=demand.port, browser=not demand.no_browser, say=tell, in_options=demand.in_options
    )
