"""`reliab fetch`: bring a file that is too large for the wheel to the user's data folder."""

from dataclasses import dataclass

from reliab.cli.demand import Demand, argument, takes
from reliab.cli.output import write_line


@dataclass(frozen=True, kw_only=True)
class FetchDemand(Demand):
    """Options of `reliab fetch`, arguments of `reliab.api.fetch_dataset`."""

    source: str = argument("FILE|https://…", "The file in the project's sources, or its https address.")


@takes(FetchDemand)
def fetch(demand: FetchDemand) -> None:
    """Bring shipped data that the wheel leaves out, results.nc of real_suite, and compare its checksum."""
    from reliab.api import fetch_dataset

    write_line(f"{demand.ask(fetch_dataset)}: checksum as listed")
