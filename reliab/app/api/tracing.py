"""`trace_boundaries`: the boundary of each motion, traced or looked up, as rows of a and b."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Final, Unpack

import xarray as xr

from reliab.app import questions
from reliab.app.api.sources import EllipseSource
from reliab.app.declaration import asks
from reliab.core.columns import PLACE_COLUMNS, Columns
from reliab.core.plain_values import Keys, ResultWithRows
from reliab.core.vocabulary import CurveName, NoEllipse, Side
from reliab.sweep.ellipse_dataset import write_ellipses
from reliab.sweep.shares import share_of

_PLACE: Final = ["motion", "f", "xi", "alpha", "threshold", "metric"]
_VALUES = ("a", "b", "sse", "n", "no_ellipse")
_HEADINGS = {"_lead": ", lead", "_inscribed": ", inscribed", "_lead_inscribed": ", inscribed, lead"}
_SUFFIXES: Final = {
    "": (CurveName.ELLIPSE, Side.LAG),
    "_lead": (CurveName.ELLIPSE, Side.LEAD),
    "_inscribed": (CurveName.INSCRIBED, Side.LAG),
    "_lead_inscribed": (CurveName.INSCRIBED, Side.LEAD),
}


def _parameter(name: str, ending: str, form: str) -> Callable[[Mapping[str, Any]], str]:
    """Write a or b of one ellipse of a row, or in place of a why there is none."""

    def write(row: Mapping[str, Any]) -> str:
        value, reason = row.get(f"{name}{ending}"), row.get(f"no_ellipse{ending}")
        if reason is not None:
            return str(reason).replace("_", " ") if name == "a" else ""
        return "" if value is None else format(value, form)

    return write


@dataclass(frozen=True, kw_only=True, eq=False)
class Boundaries(ResultWithRows):
    """Boundaries of equal error."""

    rows_in = "ellipses"
    keys: ClassVar[Keys] = {"ellipses": "rows", "warnings?": "warnings"}
    table_columns: ClassVar[Columns] = {
        "motion": ("motion", ""),
        **PLACE_COLUMNS,
        "a [-]": ("", _parameter("a", "", ".3e")),
        "b [ms²]": ("", _parameter("b", "", ".4g")),
        **{
            f"{name}{heading}": ("", _parameter(name, ending, form))
            for ending, heading in _HEADINGS.items()
            for name, form in (("a", ".3e"), ("b", ".4g"))
        },
        "points": ("n", "d"),
    }
    plot_columns = ("a", "b")

    # `a` [-], `b` [ms²], `sse` [ms⁴] and `n` over motion, structure, error, curve and side, as
    # :func:`reliab.ellipses` returns them
    ellipses: xr.Dataset

    @property
    def warnings(self) -> list[str]:
        """What should be known of ellipses that were predicted or carried, not traced."""
        return [text for name, text in self.ellipses.attrs.items() if name == "caution"]

    def __len__(self) -> int:
        return math.prod(self.ellipses.sizes.get(dimension, 1) for dimension in _PLACE)

    def rows(self) -> Iterator[dict[str, Any]]:
        """Give one row to each boundary, with both sides and both curves in columns.

        `a`, `b`, `sse`, `n` are of the ellipse of least squares for delays; those of leads end in `_lead`,
        those of the inscribed ellipse in `_inscribed` and `_lead_inscribed`. None where there is none, for
        the reason in `no_ellipse`; 0 where effects leave no room.
        """
        dataset = self.ellipses
        if "alpha" not in dataset.dims:
            dataset = dataset.expand_dims(alpha=[share_of(dataset)])
        boundaries = list(dataset[[*_PLACE]].stack(row=_PLACE)["row"].values.tolist())
        columns = {
            f"{name}{suffix}": dataset[name].sel(curve=curve, side=side).transpose(*_PLACE).values.ravel()
            for suffix, (curve, side) in _SUFFIXES.items()
            if curve in dataset["curve"].values and side in dataset["side"].values
            for name in _VALUES
            if name in dataset
        }
        for k, boundary in enumerate(boundaries):
            yield {
                **dict(zip(_PLACE, boundary, strict=True)),
                **{name: _plain(name, values[k]) for name, values in columns.items()},
            }


@asks(questions.TracingQuestion)
def trace_boundaries(**request: Unpack[questions.TracingQuestion]) -> Boundaries:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses.

    >>> traced = trace_boundaries(results="real_suite", f=1, xi=0.02)
    >>> len(traced), round(next(traced.rows())["b"], 2)
    (100, 1.35)
    """
    ellipses = EllipseSource.from_question(request).dataset()
    if request["out"] is not None:
        write_ellipses(ellipses, Path(request["out"]))
    return Boundaries(ellipses=ellipses)


def _plain(name: str, value: Any) -> float | int | str | None:  # noqa: ANN401 - of many types
    """Turn a value into a number or word of JSON."""
    if name.startswith("no_ellipse"):
        reason = NoEllipse(int(value))
        return None if reason is NoEllipse.NOT_SO else reason.name.lower()
    if name.startswith("n"):
        return int(value)
    return float(value) if math.isfinite(value) else None
