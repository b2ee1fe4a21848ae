"""`reliab explore`: a web page with sliders for the tolerable region."""

from dataclasses import dataclass
from pathlib import Path

from reliab.app.cli.completion import metrics, results
from reliab.app.cli.demand import Demand, option, takes
from reliab.app.cli.options import JSON_TARGET, written_as
from reliab.app.cli.output import say, write_json

_MEGABYTE = 1e6


@dataclass(frozen=True, kw_only=True)
class ExploreDemand(Demand):
    """Options of `reliab explore`, arguments of `reliab.write_explorer`."""

    out: Path = option(
        "FILE.html", "The page to write.", default=Path("criterion.html"), callback=written_as(".html")
    )
    ellipses: Path = option(
        "FILE.nc",
        "Ellipses from `reliab ellipses`, or real_suite: 100 real ground motions (shipped).",
        default=Path("real_suite"),
        autocompletion=results,
    )
    f: float | None = option("HZ", "Natural frequency with which the page opens.")
    xi: float | None = option("RATIO", "Damping ratio with which the page opens.")
    alpha: float = option("SHARE", "Share of the structure's stiffness in the laboratory.", default=1.0)
    threshold: float | None = option("ERROR", "Largest acceptable error of the whole test, 0.05 for 5 %.")
    confidence: float = option(
        "SHARE", "Share of the population's ground motions, 0.95 for 95 %.", default=0.95
    )
    metric: str | None = option("rms|mte", "Error of the whole test: RMS^R or MTE^R.", autocompletion=metrics)
    json_target: str | None = JSON_TARGET


@takes(ExploreDemand)
def explore(demand: ExploreDemand) -> None:
    """Write a web page, for use offline, with sliders that show tolerable errors before a test."""
    from reliab.app.api.explorer import write_explorer

    written = demand.ask(write_explorer, "json_target")
    if not write_json(written.to_dict(), demand.json_target):
        size = written.size / _MEGABYTE
        say(f"{written.page}: {size:.1f} MB, open it in any browser.")
