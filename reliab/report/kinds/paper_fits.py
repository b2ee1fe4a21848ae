"""What the paper fits to its own results, from equation (12) to equation (18), done again."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from reliab.boundary import Contour, Cosine, Curve, Ellipse, Parabola
from reliab.criterion import EllipseSample, sample_of
from reliab.criterion.distributions import Lognormal

SHARE = 0.05
"""The quantile that the paper calls 95 % confidence."""

THRESHOLD, METRIC = 0.05, "rms"
"""The error of the paper's criterion."""

Values = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class PaperFits:
    """The paper's steps on simulated ellipses.

    Parameters
    ----------
    example : xarray.Dataset
        The example, as `reliab.paper.example` makes it.
    ellipses : xarray.Dataset
        Ellipses of the 100 motions over frequencies and damping ratios, with 1 Hz and ξ = 0.02.
    """

    example: xr.Dataset
    ellipses: xr.Dataset

    @cached_property
    def contour(self) -> Contour:
        """Contour of 5 % RMS^R of the example (Figure 9b)."""
        return Contour(amplitude=self.example["amplitude_rms"].values, delay=self.example["delay_rms"].values)

    @cached_property
    def curves(self) -> tuple[Curve, Curve, Curve]:
        """Ellipse, cosine and parabola fitted to it (Table 1, Figure 10)."""
        return Ellipse.fit(self.contour), Cosine.fit(self.contour), Parabola.fit(self.contour)

    @cached_property
    def sample(self) -> EllipseSample:
        """Ellipses of all motions at 1 Hz and ξ = 0.02 (Table 2)."""
        return self.at(1.0, 0.02)

    def at(self, frequency: float, damping_ratio: float) -> EllipseSample:
        """Ellipses of all motions at a structure [Hz, -]."""
        return sample_of(
            self.ellipses,
            frequency=frequency,
            damping_ratio=damping_ratio,
            threshold=THRESHOLD,
            metric=METRIC,
        )

    @cached_property
    def frequencies(self) -> Values:
        """Frequencies of the ellipses [Hz]."""
        return np.sort(self.ellipses["f"].values.astype(np.float64))

    @cached_property
    def damping_ratios(self) -> Values:
        """Damping ratios of the ellipses [-]."""
        return np.sort(self.ellipses["xi"].values.astype(np.float64))

    @cached_property
    def guaranteed(self) -> tuple[Values, Values]:
        """5 % quantiles of the lognormal distributions of a and b by frequency (Table 3)."""
        samples = [self.at(f, 0.02) for f in self.frequencies.tolist()]
        a, b = (
            np.array([float(Lognormal.fit(getattr(sample, name)).quantile(SHARE)) for sample in samples])
            for name in ("a", "b")
        )
        return a, b

    @cached_property
    def pooled_a(self) -> float:
        """5 % quantile of a over all motions and frequencies, as in equation (15)."""
        return float(
            Lognormal.fit(np.concatenate([self.at(f, 0.02).a for f in self.frequencies.tolist()])).quantile(
                SHARE
            )
        )

    def of_example(self, name: str, dimension: str) -> Values:
        """Parameter "a" or "b" of the example's motion along "f" (at ξ = 0.02) or "xi" (at 1 Hz)."""
        chosen = (
            self.ellipses[name]
            .sel(motion=self.example.attrs["motion"], metric=METRIC, curve="ellipse")
            .sel(threshold=THRESHOLD, method="nearest")
        )
        other = {"xi": 0.02} if dimension == "f" else {"f": 1.0}
        return np.asarray(chosen.sel(other, method="nearest").sortby(dimension).values, dtype=np.float64)

    @cached_property
    def exponential_of_example(self) -> tuple[float, float]:
        """k₁ [ms²] and k₂ [1/Hz] of equation (13) for the example's motion, equation (14)."""
        return exponential(self.frequencies, self.of_example("b", "f"))

    @cached_property
    def exponential_guaranteed(self) -> tuple[float, float]:
        """k₁ [ms²] and k₂ [1/Hz] of equation (13) for 95 % of the motions, equation (15)."""
        return exponential(self.frequencies, self.guaranteed[1])

    @cached_property
    def linear_in_damping(self) -> tuple[float, float]:
        """k₃ and k₄ of equations (16a) and (16b) as the paper fits them, k₄ to √b."""
        a, root_b = self.of_example("a", "xi"), np.sqrt(self.of_example("b", "xi"))
        return proportional(self.damping_ratios, a), proportional(self.damping_ratios, root_b)

    @cached_property
    def combined(self) -> tuple[float, float]:
        """Factors of ξ and of ξ e^(−k₂f) in equation (18), from (11), (15) and (17) as the text does."""
        k3, k4 = self.linear_in_damping
        ellipse = self.curves[0]
        return k3 * self.pooled_a / ellipse.a, k4 * self.exponential_guaranteed[0] / ellipse.b


def exponential(frequencies: Values, b: Values) -> tuple[float, float]:
    """Fit b = k₁ e^(−k₂f), equation (13), by least squares of b itself.

    Parameters
    ----------
    frequencies, b : array of float, shape (n,)
        Frequencies [Hz] and parameters [ms²].

    Returns
    -------
    k1, k2 : float
        [ms²] and [1/Hz].

    Examples
    --------
    Table 3 as printed gives equation (15):

    >>> from reliab.report.printed import printed_tables
    >>> table = printed_tables().frequencies
    >>> [round(k, 1) for k in exponential(table["f_hz"].to_numpy(), table["b"].to_numpy())]
    [121.6, 6.6]
    """
    slope, intercept = np.polyfit(frequencies, np.log(b), 1)
    start = (np.exp(intercept), -slope)
    (k1, k2), _ = curve_fit(lambda f, k1, k2: k1 * np.exp(-k2 * f), frequencies, b, p0=start, maxfev=10_000)
    return float(k1), float(k2)


def proportional(x: Values, y: Values) -> float:
    """Slope of the least-squares line through the origin."""
    return float(x @ y / (x @ x))
