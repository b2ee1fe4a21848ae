"""Weights of a population's motions, so that they stand for the earthquakes that a site expects.

A target is a table in CSV with the columns `quantity`, `low`, `high` and `share`: for each quantity its
classes, low < value ≤ high, and the share of motions that is expected in each. Quantities are `magnitude`,
`distance` from the rupture [km], `length` [s] and `significant_duration` (5 to 95 % of the Arias intensity)
[s]. Of the motions that ship only the set is known, far field (more than 10 km, FEMA P-695) or near field, so
that classes of distance end at 10 km. Weights are raked: motions of
a class share its weight, one quantity after the other, until all shares are met (Deming and Stephan 1940).

Motions with weights w are worth (Σw)²/Σw² equal ones (Kish 1965). The population is drawn again with that
many motions, each in proportion to its weight and evenly along a: any method then learns from no more than
the weights leave.

Deming, W. E. and Stephan, F. F. (1940). On a least squares adjustment of a sampled frequency table when the
expected marginal totals are known. *Annals of Mathematical Statistics* 11(4), 427-444.
Kish, L. (1965). *Survey Sampling*, section 11.7.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.file_limits import LIMITS
from reliab.core.files import decoding, ordinary
from reliab.core.shipped import shipped
from reliab.criterion.ellipse_table import CUT
from reliab.criterion.scope import magnitudes_of

_COLUMNS: Final = ("quantity", "low", "high", "share")
_QUANTITIES: Final = ("magnitude", "distance", "length", "significant_duration")
_SETS: Final = "real_suite/sets.csv"
_NEAR: Final = 10.0  # km, to which near-field records reach (FEMA P-695, Appendix A)
_MEASURES: Final = "real_suite/measures.csv"
_REMEDY: Final = "Write lines such as magnitude,6.5,7.0,0.6"
_ROUNDING: Final = 0.01  # by which shares may miss 1
_ROUNDS: Final = 1000
_CONVERGED: Final = 1e-6
_FEWEST_MOTIONS: Final = 20.0
_FEWEST_EARTHQUAKES: Final = 5.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Weights:
    """Weights of motions, with what the weighted motions are worth."""

    values: Array  # Of each motion, with the sum 1, shape (motions,)
    motions: float  # Number of equal motions that they are worth
    earthquakes: float  # The same of earthquakes
    quantities: tuple[str, ...]  # That the target states

    @classmethod
    def from_table(cls, ellipses: xr.Dataset, path: str | Path) -> Self:
        """Weigh the motions of a population by the target in a file."""
        target = _read(path)
        known = {name: _values_of(name, ellipses, str(path)) for name in target}
        classes = {
            name: (np.array(table["share"]), _members(known[name], table, str(path)))
            for name, table in target.items()
        }
        values = _raked(classes, str(path))
        events = ellipses["event"].values
        of_events = np.array([values[events == event].sum() for event in np.unique(events)])
        motions, earthquakes = (float(1.0 / np.square(part).sum()) for part in (values, of_events))
        if motions < _FEWEST_MOTIONS or earthquakes < _FEWEST_EARTHQUAKES:
            raise InputError(
                f"Weighted motions must be worth at least {_FEWEST_MOTIONS:g} equal ones of "
                f"{_FEWEST_EARTHQUAKES:g} earthquakes",
                value=f"{motions:.1f} of {earthquakes:.1f}",
                remedy="Widen the classes of the target, or give `motions` of such earthquakes",
                where=str(path),
            )
        return cls(values=values, motions=motions, earthquakes=earthquakes, quantities=tuple(target))

    def drawn(self, ellipses: xr.Dataset) -> xr.Dataset:
        """Draw the population again, with as many motions as the weighted ones are worth."""
        count = round(self.motions)
        log_a: xr.DataArray = np.log(ellipses["a"].where(ellipses["a"] > 0.0))  # type: ignore[assignment]
        others = [name for name in log_a.dims if name != "motion"]
        order = np.argsort(np.nan_to_num(log_a.mean(others).values, nan=np.inf), kind="stable")
        upper = np.cumsum(self.values[order])
        places = order[np.searchsorted(upper, (np.arange(count) + 0.5) / count * upper[-1])]
        drawn = ellipses.isel(motion=places).drop_vars(CUT, errors="ignore")
        names = [f"{name}#{number}" for number, name in enumerate(drawn["motion"].values, start=1)]
        words = f"weighted: {ellipses.sizes['motion']} motions are worth {count}"
        before = ellipses.attrs.get("carried_to")
        return drawn.assign_coords(motion=names).assign_attrs(
            carried_to=f"{before}, {words}" if before else words
        )


def _read(path: str | Path) -> dict[str, pd.DataFrame]:
    """Classes and shares of each quantity."""
    with decoding("A target must be a readable table in CSV", remedy=_REMEDY, where=path):
        LIMITS["weights"].require_small(ordinary(path))
        table = pd.read_csv(path)
    if list(table.columns) != list(_COLUMNS):
        raise _wrong(
            f"A target has the columns {', '.join(_COLUMNS)}", ", ".join(map(str, table.columns)), path
        )
    numbers = table[["low", "high", "share"]].apply(pd.to_numeric, errors="coerce")
    if table.empty or numbers.isna().to_numpy().any() or not (numbers["low"] < numbers["high"]).all():
        raise _wrong("Each class of a target has a low end, a greater high end and a share", "another", path)
    found = {}
    for name, rows in numbers.groupby(table["quantity"].astype(str), sort=False):
        if name not in _QUANTITIES:
            raise _wrong(f"A quantity is one of {', '.join(_QUANTITIES)}", str(name), path)
        total = rows["share"].sum()
        if (rows["share"] < 0.0).any() or abs(total - 1.0) > _ROUNDING:
            raise _wrong("The shares of a quantity must be positive and add up to 1", f"{total:g}", path)
        ordered = rows.sort_values("low")
        if name == "distance" and not ((ordered["high"] == _NEAR) | (ordered["low"] == _NEAR)).all():
            raise InputError(
                f"Classes of distance must end or begin at {_NEAR:g} km: no more is known of the motions",
                value=", ".join(f"{row.low:g} to {row.high:g}" for row in ordered.itertuples()),
                remedy=f"Write two lines, distance,0,{_NEAR:g},0.3 and distance,{_NEAR:g},1000,0.7",
                where=str(path),
            )
        if (ordered["low"].to_numpy()[1:] < ordered["high"].to_numpy()[:-1]).any():
            raise _wrong("The classes of a quantity must not overlap", str(name), path)
        found[str(name)] = ordered
    return found


def _wrong(rule: str, value: str, path: str | Path) -> InputError:
    return InputError(rule, value=value, remedy=_REMEDY, where=str(path))


def _values_of(name: str, ellipses: xr.Dataset, path: str) -> Array:
    """Look up a quantity of each motion."""
    values: Array | None = None
    if name == "length" and "duration" in ellipses.coords:
        values = ellipses["duration"].values.astype(np.float64)
    elif name == "magnitude":
        magnitudes = magnitudes_of(ellipses["event"].values.tolist())
        values = None if magnitudes is None else np.array(magnitudes)
    elif name == "distance":
        sets = _of_motions(_SETS, "set", ellipses)
        values = None if sets is None else np.where(sets == "near_field", _NEAR, np.nextafter(_NEAR, np.inf))
    elif name == "significant_duration":
        values = _of_motions(_MEASURES, "significant_duration", ellipses)
    if values is None:
        raise InputError(
            f"To weigh by {name.replace('_', ' ')}, that of every motion must be known",
            value="motions of which it is not",
            remedy="Weigh the motions that ship, `ellipses=real_suite`, or leave the quantity out",
            where=path,
        )
    return values


def _of_motions(file: str, column: str, ellipses: xr.Dataset) -> NDArray[Any] | None:
    """Look up a column of a shipped table for each motion; None unless it holds all of them."""
    table = pd.read_csv(shipped("datasets", file)).set_index("motion")[column]
    motions = ellipses["motion"].values.tolist()
    return table.loc[motions].to_numpy() if set(motions) <= set(table.index) else None


def _members(values: Array, table: pd.DataFrame, path: str) -> NDArray[np.bool_]:
    """Whether each motion belongs to each class, shape (classes, motions)."""
    low, high = (table[name].to_numpy()[:, None] for name in ("low", "high"))
    members = (values > low) & (values <= high)
    empty = ~members.any(axis=1) & (table["share"].to_numpy() > 0.0)
    if empty.any():
        row = table.iloc[int(np.flatnonzero(empty)[0])]
        raise InputError(
            "Each class with a share must hold motions of the population",
            value=f"none in {row['low']:g} to {row['high']:g}, which has the share {row['share']:g}",
            remedy="Widen the class, or give `motions` of such earthquakes",
            where=path,
        )
    return members


def _raked(classes: Mapping[str, tuple[Array, NDArray[np.bool_]]], path: str) -> Array:
    """Weights whose sums over the classes of every quantity are the shares."""
    weights = np.ones(next(iter(classes.values()))[1].shape[1])
    for _ in range(_ROUNDS):
        before = weights
        for shares, members in classes.values():
            sums = members @ weights
            factors = np.divide(shares / shares.sum(), sums, out=np.zeros_like(sums), where=sums > 0.0)
            weights = weights * (factors @ members)
        if weights.sum() > 0.0 and np.abs(weights - before).max() < _CONVERGED / weights.size:
            return np.asarray(weights / weights.sum())
    raise InputError(
        "The shares of several quantities must be such that motions can meet all of them",
        value=" and ".join(classes),
        remedy="State one quantity alone, or shares that go together",
        where=path,
    )
