"""`reliab explore`: a web page with sliders for the tolerable region, in which a test file is placed."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.completion import metrics, results
from reliab.cli.demand import Demand, takes
from reliab.cli.options import JsonTarget, written_as
from reliab.cli.output import console, write_json

_MEGABYTE = 1e6


@dataclass(frozen=True, kw_only=True)
class ExploreDemand(Demand):
    """Options of `reliab explore`, arguments of `reliab.write_explorer`."""

    out: Annotated[
        Path,
        typer.Option("--out", metavar="FILE.html", callback=written_as(".html"), help="The page to write."),
    ] = Path("criterion.html")
    ellipses: Annotated[
        Path,
        typer.Option(
            "--ellipses",
            autocompletion=results,
            metavar="FILE.nc",
            help="Ellipses from `reliab ellipses`, or real_suite: 100 real ground motions (shipped).",
        ),
    ] = Path("real_suite")
    f: Annotated[
        float | None, typer.Option("--f", metavar="HZ", help="Natural frequency with which the page opens.")
    ] = None
    xi: Annotated[
        float | None, typer.Option("--xi", metavar="RATIO", help="Damping ratio with which the page opens.")
    ] = None
    alpha: Annotated[
        float,
        typer.Option(
            "--alpha", metavar="SHARE", help="Share of the structure's stiffness in the laboratory."
        ),
    ] = 1.0
    threshold: Annotated[
        float | None,
        typer.Option("--threshold", metavar="ERROR", help="Error of the whole test, 0.05 for 5 %."),
    ] = None
    confidence: Annotated[
        float,
        typer.Option(
            "--confidence", metavar="SHARE", help="Share of the population's ground motions, 0.95 for 95 %."
        ),
    ] = 0.95
    metric: Annotated[
        str | None,
        typer.Option(
            "--metric",
            autocompletion=metrics,
            metavar="rms|mte",
            help="Error of the whole test: RMS^R or MTE^R.",
        ),
    ] = None
    json_target: JsonTarget = None


@takes(ExploreDemand)
def explore(demand: ExploreDemand) -> None:
    """Write a web page, for use offline, of tolerable errors and of where a test dropped on it lies."""
    from reliab.api import write_explorer

    written = demand.ask(write_explorer, "json_target")
    if not write_json(written.to_dict(), demand.json_target):
        size = written.size / _MEGABYTE
        console().print(f"{written.page}: {size:.1f} MB, open it in any browser.", highlight=False)
