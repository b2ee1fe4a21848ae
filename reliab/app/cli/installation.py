"""`reliab fetch`, `samples` and `info`: what ships, what is fetched, and the facts about an installation."""

from dataclasses import dataclass
from pathlib import Path

from reliab.app.cli.demand import Demand, argument, takes
from reliab.app.cli.options import JSON_TARGET
from reliab.app.cli.output import write_json, write_line


@dataclass(frozen=True, kw_only=True)
class FetchDemand(Demand):
    """Options of `reliab fetch`, arguments of `reliab.app.api.fetch_dataset`."""

    source: str = argument("FILE|https://…", "The file in the project's sources, or its https address.")


@takes(FetchDemand)
def fetch(demand: FetchDemand) -> None:
    """Fetch data that are too large for the package, results.nc of real_suite, and compare their checksum."""
    from reliab.app.api.installation import fetch_dataset

    write_line(f"{demand.ask(fetch_dataset)}: the checksum is as listed")


@dataclass(frozen=True, kw_only=True)
class SamplesDemand(Demand):
    """Options of `reliab samples`, arguments of `reliab.app.api.copy_samples`."""

    folder: Path = argument(
        "[FOLDER]", "Folder for the samples; `datasets` by default.", default=Path("datasets")
    )


@takes(SamplesDemand)
def samples(demand: SamplesDemand) -> None:
    """Write the samples that come with reliab into a folder; files with other content are not overwritten."""
    from reliab.app.api.installation import copy_samples

    for sample in demand.ask(copy_samples):
        write_line(str(sample))


@dataclass(frozen=True, kw_only=True)
class InfoDemand(Demand):
    """Options of `reliab info`."""

    json_target: str | None = JSON_TARGET


@takes(InfoDemand)
def info(demand: InfoDemand) -> None:
    """Print versions, shipped data and where compiled code is kept, for a bug report."""
    from reliab.app.api.installation import describe_installation

    content = demand.ask(describe_installation, "json_target")
    if write_json(content, demand.json_target):
        return
    for name, value in content.items():
        if isinstance(value, dict):
            write_line(f"{name}:")
            for key, text in value.items():
                write_line(f"  {key}: {text}")
        else:
            write_line(f"{name}: {value}")
