"""`reliab ellipses`: the boundary of each motion, as a and b."""

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.ellipse_source import EllipseSource
from reliab.cli.options import (
    DampingRatios,
    FirstOrder,
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
)
from reliab.cli.output import console, table, write_json

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr

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
_WHERE = ["motion", "f", "xi", "alpha", "threshold", "metric"]
_PAGE = 1000  # rows
_NAMES = ("a", "b", "sse", "n", "no_ellipse")

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
    alpha: Fractions = None,
    model: ModelFile = None,
    first_order: FirstOrder = False,
    out: Out = None,
    json_target: JsonTarget = None,
) -> None:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses."""
    source = EllipseSource(
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
    dataset = source.dataset()
    if out is not None:
        from reliab.sweep import write_ellipses

        write_ellipses(dataset, out)
    caution = dataset.attrs.get("caution")
    if json_target is not None:
        content = {"ellipses": list(_rows(dataset)), **({"warnings": [caution]} if caution else {})}
        if write_json(content, json_target):
            return
    _print(dataset, metric)
    if caution:
        console().print(f"Note: {caution}", markup=False, highlight=False)


def _print(dataset: "xr.Dataset", metric: str) -> None:
    """Print one row for each boundary, page by page: a single table of very many would fill the memory."""
    count = math.prod(dataset.sizes.get(dimension, 1) for dimension in _WHERE)
    title = f"{count} boundaries of {metric.upper()}^R"
    rows, terminal = _rows(dataset), console()
    while page := list(itertools.islice(rows, _PAGE)):
        shown = table(title, _HEADINGS)
        for row in page:
            shown.add_row(*_cells(row))
        terminal.print(shown)
        title = ""


def _rows(dataset: "xr.Dataset") -> "Iterator[dict[str, Any]]":
    """Give one row to each boundary, both sides and both curves beside each other.

    `a`, `b`, `sse`, `n` are of the ellipse of least squares for delays; those of leads end in `_lead`, those
    of the inscribed ellipse in `_inscribed` and `_lead_inscribed`. Null where there is none, for the reason
    in `no_ellipse`; 0 where effects leave no room.
    """
    from reliab.sweep import share_of

    if "alpha" not in dataset.dims:
        dataset = dataset.expand_dims(alpha=[share_of(dataset)])
    boundaries = list(dataset[[*_WHERE]].stack(row=_WHERE)["row"].values.tolist())
    columns = {
        f"{name}{suffix}": dataset[name].sel(chosen).transpose(*_WHERE).values.ravel()
        for suffix, chosen in _columns(dataset)
        for name in _NAMES
        if name in dataset
    }
    for k, boundary in enumerate(boundaries):
        yield {
            **dict(zip(_WHERE, boundary, strict=True)),
            **{name: _plain(name, values[k]) for name, values in columns.items()},
        }


def _columns(dataset: "xr.Dataset") -> list[tuple[str, dict[str, str]]]:
    """Suffix of the keys of each curve and side that the dataset holds, and where they lie."""
    from reliab.vocabulary import CurveName, Side

    suffixes = {
        "": (CurveName.ELLIPSE, Side.LAG),
        "_lead": (CurveName.ELLIPSE, Side.LEAD),
        "_inscribed": (CurveName.INSCRIBED, Side.LAG),
        "_lead_inscribed": (CurveName.INSCRIBED, Side.LEAD),
    }
    return [
        (suffix, {"curve": str(curve), "side": str(side)})
        for suffix, (curve, side) in suffixes.items()
        if curve in dataset["curve"].values and side in dataset["side"].values
    ]


def _plain(name: str, value: Any) -> float | int | str | None:  # noqa: ANN401 - of many types
    """Turn a value into a number or word of JSON."""
    from reliab.vocabulary import NoEllipse

    if name.startswith("no_ellipse"):
        reason = NoEllipse(int(value))
        return None if reason is NoEllipse.NOT_SO else reason.name.lower()
    if name.startswith("n"):
        return int(value)
    return float(value) if math.isfinite(value) else None


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
