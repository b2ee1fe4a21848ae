"""`reliab.trace_boundaries`: the boundary of each motion, traced or looked up, as rows of a and b."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import xarray as xr

from reliab.app.api.sources import EllipseSource, Files
from reliab.core.progress import Show, quietly
from reliab.core.rows import ResultWithRows
from reliab.core.vocabulary import CurveName, NoEllipse, Side
from reliab.sweep.ellipse_file import write_ellipses
from reliab.sweep.several import Names, Numbers, several
from reliab.sweep.shares import share_of

_WHERE: Final = ["motion", "f", "xi", "alpha", "threshold", "metric"]
_VALUES = ("a", "b", "sse", "n", "no_ellipse")
_SUFFIXES: Final = {
    "": (CurveName.ELLIPSE, Side.LAG),
    "_lead": (CurveName.ELLIPSE, Side.LEAD),
    "_inscribed": (CurveName.INSCRIBED, Side.LAG),
    "_lead_inscribed": (CurveName.INSCRIBED, Side.LEAD),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Boundaries(ResultWithRows):
    """Boundaries of equal error.

    Attributes
    ----------
    ellipses : xarray.Dataset
        `a` [-], `b` [ms²], `sse` [ms⁴] and `n` over motion, structure, error, curve and side, as
        :func:`reliab.ellipses` returns them.
    """

    rows_in = "ellipses"

    ellipses: xr.Dataset

    @property
    def caution(self) -> str | None:
        """What should be known of ellipses that were predicted or carried, not traced."""
        caution: str | None = self.ellipses.attrs.get("caution")
        return caution

    def __len__(self) -> int:
        return math.prod(self.ellipses.sizes.get(dimension, 1) for dimension in _WHERE)

    def rows(self) -> Iterator[dict[str, Any]]:
        """Give one row to each boundary, with both sides and both curves in columns.

        `a`, `b`, `sse`, `n` are of the ellipse of least squares for delays; those of leads end in `_lead`,
        those of the inscribed ellipse in `_inscribed` and `_lead_inscribed`. None where there is none, for
        the reason in `no_ellipse`; 0 where effects leave no room.
        """
        dataset = self.ellipses
        if "alpha" not in dataset.dims:
            dataset = dataset.expand_dims(alpha=[share_of(dataset)])
        boundaries = list(dataset[[*_WHERE]].stack(row=_WHERE)["row"].values.tolist())
        columns = {
            f"{name}{suffix}": dataset[name].sel(curve=curve, side=side).transpose(*_WHERE).values.ravel()
            for suffix, (curve, side) in _SUFFIXES.items()
            if curve in dataset["curve"].values and side in dataset["side"].values
            for name in _VALUES
            if name in dataset
        }
        for k, boundary in enumerate(boundaries):
            yield {
                **dict(zip(_WHERE, boundary, strict=True)),
                **{name: _plain(name, values[k]) for name, values in columns.items()},
            }

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers with stable keys: `ellipses`, the rows, and where there is one the `warnings`."""
        warnings = {"warnings": [self.caution]} if self.caution else {}
        return {"ellipses": list(self.rows()), **warnings}


def trace_boundaries(
    *,
    motions: Files | None = None,
    sets: Names | None = None,
    results: str | Path | None = None,
    f: Numbers | None = None,
    xi: Numbers | None = None,
    threshold: Numbers | None = None,
    metric: str = "rms",
    window: str = "record",
    alpha: Numbers | None = None,
    model: str | Path | None = None,
    first_order: bool = False,
    out: str | Path | None = None,
    show: Show = quietly,
) -> Boundaries:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses.

    Parameters
    ----------
    motions : str, pathlib.Path or sequence of these, optional
        Ground motions: records, folders or a built-in suite.
    sets : str or sequence of str, optional
        Sets of their catalogue.
    results : str or pathlib.Path, optional
        Results that :func:`reliab.simulate` stored instead, or "real_suite".
    f, xi : float or sequence of float, optional
        Natural frequencies [Hz] and damping ratios [-]; 1 Hz and 0.02 for motions, all those of results.
    threshold : float or sequence of float, optional
        Errors on the boundary [-], 0.05 by default.
    metric : {"rms", "mte"}, optional
        Error of the whole test.
    window : str, optional
        Part of the record over which the error is computed: "record", "arias" or seconds.
    alpha : float or sequence of float, optional
        Shares of the stiffness in the laboratory [-]; those of the results, or 1.
    model : str or pathlib.Path, optional
        Model with effects, in place of structures.
    first_order : bool, optional
        Whether ellipses are predicted from the spectra of motions, exact for small errors only.
    out : str or pathlib.Path, optional
        NetCDF file that keeps the ellipses.
    show : callable, optional
        Takes the name of a task and shows its progress.

    Returns
    -------
    Boundaries
        The ellipses, as a dataset and as rows.

    Raises
    ------
    InputError
        If there is not one source, it cannot serve what is asked for, or a value is not allowed.

    Examples
    --------
    >>> traced = trace_boundaries(results="real_suite", f=1, xi=0.02)
    >>> len(traced), round(next(traced.rows())["b"], 2)
    (100, 1.35)
    """
    source = EllipseSource(
        motions=motions,
        sets=None if sets is None else several(sets),
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
    traced = source.dataset(show)
    if out is not None:
        write_ellipses(traced, Path(out))
    return Boundaries(ellipses=traced)


def _plain(name: str, value: Any) -> float | int | str | None:  # noqa: ANN401 - of many types
    """Turn a value into a number or word of JSON."""
    if name.startswith("no_ellipse"):
        reason = NoEllipse(int(value))
        return None if reason is NoEllipse.NOT_SO else reason.name.lower()
    if name.startswith("n"):
        return int(value)
    return float(value) if math.isfinite(value) else None
