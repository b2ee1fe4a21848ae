"""`reliab ellipses`: the boundary of each motion, as a and b."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.options import (
    DampingRatios,
    ExperimentalFraction,
    FirstOrder,
    Frequencies,
    JsonTarget,
    MetricName,
    ModelFile,
    Motions,
    Results,
    Sets,
    Thresholds,
    WindowName,
)
from reliab.cli.output import console, table, write_json
from reliab.cli.sources import ellipse_dataset

if TYPE_CHECKING:
    import xarray as xr

_HEADINGS = {
    "motion": "left",
    "f [Hz]": "right",
    "ξ [-]": "right",
    "error [-]": "right",
    "a [-]": "right",
    "b [ms²]": "right",
    "√a [-]": "right",
    "√b [ms]": "right",
    "misfit [ms⁴]": "right",
    "points": "right",
}

Out = Annotated[
    Path | None, typer.Option("--out", metavar="FILE.nc", help="Keep the ellipses for `reliab criterion`.")
]


def ellipses(
    *,
    motions: Motions = None,
    sets: Sets = None,
    results: Results = None,
    f: Frequencies = None,
    xi: DampingRatios = None,
    threshold: Thresholds = None,
    metric: MetricName = "rms",
    window: WindowName = "record",
    alpha: ExperimentalFraction = 1.0,
    model: ModelFile = None,
    first_order: FirstOrder = False,
    out: Out = None,
    json_target: JsonTarget = None,
) -> None:
    """Fit an ellipse to the boundary of equal error of each motion."""
    dataset = ellipse_dataset(
        motions=motions,
        sets=sets,
        results=results,
        f=f,
        xi=xi,
        threshold=threshold,
        metric=metric,
        window=window,
        alpha=alpha,
        model=model,
        first_order=first_order,
    )
    if out is not None:
        from reliab.sweep import write_ellipses

        write_ellipses(dataset, out)
    rows = _rows(dataset)
    caution = dataset.attrs.get("caution")
    content = {"ellipses": rows, **({"warnings": [caution]} if caution else {})}
    if write_json(content, json_target):
        return
    shown = table(f"{len(rows)} boundaries of {metric.upper()}^R", _HEADINGS)
    for row in rows:
        shown.add_row(*_cells(row))
    console().print(shown)
    if caution:
        console().print(f"Note: {caution}", markup=False, highlight=False)


def _rows(dataset: "xr.Dataset") -> list[dict[str, Any]]:
    """One row a boundary; a and b are null where it leaves the stored grid, 0 where effects leave no room."""
    frame = dataset.isel(curve=0, drop=True).to_dataframe().reset_index()
    names = ["motion", "f", "xi", "threshold", "metric", "a", "b", "sse", "n"]
    columns = frame[names].astype(object).where(frame[names].notna(), None)
    rows = columns.to_dict(orient="records")
    return [{**{str(name): value for name, value in row.items()}, "n": int(row["n"] or 0)} for row in rows]


def _cells(row: dict[str, Any]) -> list[str]:
    where = [str(row["motion"]), f"{row['f']:g}", f"{row['xi']:g}", f"{row['threshold']:g}"]
    if row["a"] == 0.0:
        return [*where, *["no room"] * 2, "", "", "", "0"]
    if row["a"] is None:
        return [*where, *["outside the grid"] * 2, "", "", "", "0"]
    a, b = row["a"], row["b"]
    root = f"{a**0.5:.4f}" if a > 0 else "-"
    misfit = "-" if row["sse"] is None else f"{row['sse']:.3g}"
    return [*where, f"{a:.3e}", f"{b:.4g}", root, f"{b**0.5:.3f}", misfit, str(row["n"])]
