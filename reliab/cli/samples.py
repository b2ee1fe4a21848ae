"""`reliab samples`: tests, campaigns and frames that ship, as files to look at, to copy and to try with."""

from dataclasses import dataclass
from pathlib import Path

from reliab.cli.demand import Demand, argument, takes
from reliab.cli.output import write_line


@dataclass(frozen=True, kw_only=True)
class SamplesDemand(Demand):
    """Options of `reliab samples`, arguments of `reliab.api.copy_samples`."""

    folder: Path = argument(
        "[FOLDER]", "Where they are written; `datasets` by default.", default=Path("datasets")
    )


@takes(SamplesDemand)
def samples(demand: SamplesDemand) -> None:
    """Write the samples that ship into a folder; files of another content are not touched."""
    from reliab.api import copy_samples

    for sample in demand.ask(copy_samples):
        write_line(str(sample))
