"""What was simulated from the records: ellipses, the example and the four cases, as far as there are any."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import pandas as pd
import scipy
import xarray as xr

from reliab.core.arrays import Array
from reliab.core.vocabulary import CurveName, Metric, Side
from reliab.criterion.laws.registry import MANY_MOTION_LAWS
from reliab.criterion.population import EllipseSample, is_ellipse
from reliab.tracking.boundary.contour import Contour
from reliab.tracking.boundary.curves import Curve, Ellipse, fit_line

from .fits import quantile
from .printed import EXAMPLE, FIVE_PERCENT, ONE_HERTZ, TWO_PERCENT


@dataclass(frozen=True, kw_only=True, eq=False)
class Records:
    """Results of the records at 5 % RMS^R, or nothing; what is not there is NaN.

    `ellipses`: `a` [-] and `b` [ms²] (and `sse` [ms⁴]) over (motion, f, xi, threshold, metric, curve),
    motions named as in Table 2.
    """

    ellipses: xr.Dataset | None = None
    example: xr.Dataset | None = None
    cases: xr.Dataset | None = None

    @cached_property
    def frequencies(self) -> Array:
        """Frequencies of the ellipses [Hz], increasing."""
        return self._nodes("f")

    @cached_property
    def damping_ratios(self) -> Array:
        """Damping ratios of the ellipses [-], increasing."""
        return self._nodes("xi")

    @cached_property
    def motions(self) -> list[str]:
        """Names of the motions that have ellipses."""
        return [] if self.ellipses is None else [str(name) for name in self.ellipses["motion"].values]

    def values_of_motions(
        self, parameter: str, frequency: float, damping_ratio: float = TWO_PERCENT
    ) -> Array:
        """Array "a" [-], "b" [ms²] or "sse" [ms⁴] of all motions at a structure; empty where unknown."""
        if self.ellipses is None or parameter not in self.ellipses:
            return np.empty(0)
        cells = self.ellipses[parameter]
        for name, value in (("f", frequency), ("xi", damping_ratio), ("threshold", FIVE_PERCENT)):
            nearest = np.flatnonzero(np.isclose(cells[name].values, value, rtol=1e-9))
            if nearest.size == 0:
                return np.empty(0)
            cells = cells.isel({name: nearest[0]})
        cells = cells.sel(metric=str(Metric.RMS))
        for name, label in (("curve", CurveName.ELLIPSE), ("side", Side.LAG)):
            cells = cells.sel({name: str(label)}) if name in cells.dims else cells
        return np.asarray(cells.transpose("motion").values, dtype=np.float64)

    def value_of_motion(
        self, parameter: str, frequency: float, damping_ratio: float, motion: str = EXAMPLE
    ) -> float:
        """Value of one motion, the example's by default, and one structure."""
        values = self.values_of_motions(parameter, frequency, damping_ratio)
        return float(values[self.motions.index(motion)]) if values.size and motion in self.motions else np.nan

    def values_over_frequencies(self, parameter: str) -> Array:
        """Value of the example's motion at each frequency, at 2 % damping."""
        return np.array([self.value_of_motion(parameter, f, TWO_PERCENT) for f in self.frequencies.tolist()])

    def values_over_damping_ratios(self, parameter: str) -> Array:
        """Value of the example's motion at each damping ratio, at 1 Hz."""
        return np.array(
            [self.value_of_motion(parameter, ONE_HERTZ, xi) for xi in self.damping_ratios.tolist()]
        )

    def guaranteed(self, parameter: str) -> Array:
        """5 % quantiles over the motions at each frequency, at 2 % damping: Table 3."""
        return np.array([quantile(self.values_of_motions(parameter, f)) for f in self.frequencies.tolist()])

    def pooled(self, parameter: str) -> float:
        """5 % quantile over the motions at all frequencies together; NaN of nothing."""
        values = [self.values_of_motions(parameter, f) for f in self.frequencies.tolist()]
        return quantile(np.concatenate(values)) if values else np.nan

    def sample(self, frequency: float = ONE_HERTZ, damping_ratio: float = TWO_PERCENT) -> EllipseSample:
        """Ellipses of all motions at a structure; motions without an ellipse are left out."""
        a, b = (self.values_of_motions(name, frequency, damping_ratio) for name in "ab")
        sound = is_ellipse(a, b)
        events = () if self.ellipses is None else self.ellipses["event"].values.tolist()
        return EllipseSample(
            a=a[sound],
            b=b[sound],
            motions=np.array(self.motions, dtype=np.str_)[sound],
            events=np.array(events, dtype=np.str_)[sound],
            frequency=frequency,
            damping_ratio=damping_ratio,
            threshold=FIVE_PERCENT,
            metric=str(Metric.RMS),
        )

    @cached_property
    def curves(self) -> dict[str, Curve]:
        """Curves fitted to the contour (Table 1, Figure 10) by their names; empty without the example."""
        if self.example is None:
            return {}
        contour, kinds = contour_with_ends(self.example), (Ellipse, Cosine, Parabola)
        return {kind.name: kind.fit(contour) for kind in kinds}

    def _nodes(self, name: str) -> Array:
        if self.ellipses is None:
            return np.empty(0)
        return np.sort(self.ellipses[name].values.astype(np.float64))


def contour_with_ends(example: xr.Dataset) -> Contour:
    """Contour of 5 % RMS^R of the example (Figure 9b), with its two ends on the axis d = 0.

    Amplitude [-] and delay [s]; for KOBE/NIS000 the 25 points of the paper.
    """
    low, high = example["ends_rms"].values
    amplitude, delay = (example[f"{name}_rms"].values for name in ("amplitude", "delay"))
    return Contour(amplitude=np.r_[low, amplitude, high], delay=np.r_[0.0, delay, 0.0])


LAWS = ("guo_2017_15", "guo_2017_18", "guo_2017_15_corrected", "guo_2017_18_corrected")


def containment(records: Records) -> pd.DataFrame:
    """Share of the motions whose own fitted ellipse contains a published criterion, at ξ = 0.02.

    Columns f [Hz] and one for each law, shares [-].
    """
    rows = []
    for f in records.frequencies.tolist():
        sample = records.sample(f)
        row = {"f": f}
        for name in LAWS:
            a, b = (float(limit) for limit in MANY_MOTION_LAWS[name].limits(f, TWO_PERCENT))
            row[name] = float(((sample.a >= a) & (sample.b >= b)).mean())
        rows.append(row)
    return pd.DataFrame(rows)


@dataclass(frozen=True, kw_only=True)
class Cosine(Curve):
    """Cosine d = a cos(b(A − 1)) with a [ms] and b [rad], equation (7b)."""

    name: ClassVar[str] = "cosine"

    @classmethod
    def _parameters(cls, offset: Array, delay: Array) -> tuple[float, float]:
        guess = (float(delay.max()), 0.5 * np.pi / float(np.abs(offset).max()))
        (a, b), _ = scipy.optimize.curve_fit(lambda x, a, b: a * np.cos(b * x), offset, delay, p0=guess)
        return float(a), float(b)

    @classmethod
    def _delay_squared(cls, offset: Array, a: float, b: float) -> Array:
        return np.asarray((a * np.cos(b * offset)) ** 2)


@dataclass(frozen=True, kw_only=True)
class Parabola(Curve):
    """Parabola d = a(A − 1)² + b with a and b [ms], equation (7c)."""

    name: ClassVar[str] = "parabola"

    @classmethod
    def _parameters(cls, offset: Array, delay: Array) -> tuple[float, float]:
        return fit_line(offset**2, delay)

    @classmethod
    def _delay_squared(cls, offset: Array, a: float, b: float) -> Array:
        return np.asarray((a * offset**2 + b) ** 2)
