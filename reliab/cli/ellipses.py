"""`reliab ellipses`: the boundary of each motion, as a and b."""

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.demand import Demand, takes
from reliab.cli.options import (
    DampingRatios,
    Fractions,
    Frequencies,
    JsonTarget,
    MetricName,
    ModelFile,
    Motions,
    Results,
    Sets,
    Thresholds,
    WindowName,
    written_as,
)
from reliab.cli.output import console, progress_bar, table, write_json

if TYPE_CHECKING:
    from reliab.api import Boundaries

_HEADINGS = {
    "motion": "left",
    "f [Hz]": "right",
    "ξ [-]": "right",
    "α [-]": "right",
    "error [-]": "right",
    "a [-]": "right",
    "b [ms²]": "right",
    "a, lead": "right",
    "b, lead": "right",
    "a, inscribed": "right",
    "b, inscribed": "right",
    "a, inscribed, lead": "right",
    "b, inscribed, lead": "right",
    "points": "right",
}
_PAGE = 1000  # rows


@dataclass(frozen=True, kw_only=True)
class EllipsesDemand(Demand):
    """Options of `reliab ellipses`."""

    motions: Motions = None
    sets: Sets = None
    results: Results = None
    f: Frequencies = None
    xi: DampingRatios = None
    threshold: Thresholds = None
    metric: MetricName = "rms"
    window: WindowName = "record"
    alpha: Fractions = None
    model: ModelFile = None
    first_order: Annotated[
        bool,
        typer.Option(
            "--first-order",
            help="Predict ellipses from the records' spectra instead of simulating; unsafe at large errors: "
            "at 5 % the simulated b is 16 to 44 % smaller.",
        ),
    ] = False
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE.nc",
            callback=written_as(".nc"),
            help="Keep the ellipses for `reliab criterion`.",
        ),
    ] = None
    json_target: JsonTarget = None


@takes(EllipsesDemand)
def ellipses(demand: EllipsesDemand) -> None:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses."""
    from reliab.api import trace_boundaries

    traced = demand.ask(trace_boundaries, "json_target", show=progress_bar)
    if demand.json_target is not None and write_json(traced.to_dict(), demand.json_target):
        return
    _show(traced, demand.metric)
    if traced.caution:
        console().print(f"Note: {traced.caution}", markup=False, highlight=False)


def _show(traced: "Boundaries", metric: str) -> None:
    """Print one row for each boundary, page by page: a single table of very many would fill the memory."""
    title = f"{len(traced)} boundaries of {metric.upper()}^R"
    rows, terminal = traced.rows(), console()
    while page := list(itertools.islice(rows, _PAGE)):
        shown = table(title, _HEADINGS)
        for row in page:
            shown.add_row(*_cells(row))
        terminal.print(shown)
        title = ""


def _cells(row: dict[str, Any]) -> list[str]:
    where = [
        str(row["motion"]),
        f"{row['f']:g}",
        f"{row['xi']:g}",
        f"{row['alpha']:g}",
        f"{row['threshold']:g}",
    ]
    shown = [_parameters(row, suffix) for suffix in ("", "_lead", "_inscribed", "_lead_inscribed")]
    return [*where, *(cell for pair in shown for cell in pair), str(row["n"])]


def _parameters(row: dict[str, Any], suffix: str) -> tuple[str, str]:
    """Show a and b of one ellipse, or why there is none."""
    a, b, reason = (row.get(f"{name}{suffix}") for name in ("a", "b", "no_ellipse"))
    if reason is not None:
        return str(reason).replace("_", " "), ""
    return ("", "") if a is None or b is None else (f"{a:.3e}", f"{b:.4g}")
