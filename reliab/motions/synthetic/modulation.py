"""Intensity of the motion over time: the modulating function and its fit to the durations."""

from dataclasses import dataclass
from math import log, log1p, pi
from typing import Final

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.motions.synthetic.parameters import ComponentParameters
from reliab.vocabulary import STANDARD_GRAVITY

_ONSET: Final = 0.05
_RISE: Final = 0.30
_END: Final = 0.95
_GENTLEST: Final = 1.0
"""Largest 1 / (2α + 1); with more the motion would be strongest at its start (α < 0)."""


@dataclass(frozen=True, kw_only=True)
class Modulation:
    """A power of time up to the peak, an exponential after it (Dabaghi & Der Kiureghian 2017, eq. 4).

    q(t) = c (t / t_m)^α up to t_m and c exp(−β (t − t_m)) after it. The expected Arias intensity of a process
    of unit variance modulated by q is (π/2g) ∫ q² dt, so that its share at any time has a closed form.

    >>> shape = Modulation(peak_time=4.0, peak_share=0.4, growth=3.0, arias_intensity=1.0)
    >>> round(shape.time_of_share(0.4), 6), round(shape.time_of_share(0.95), 3)
    (4.0, 8.97)
    """

    peak_time: float  # Time t_m of the largest intensity [s]
    peak_share: float  # Share of the Arias intensity that has arrived by then, p
    growth: float  # Exponent 2α + 1 of the share before the peak
    arias_intensity: float  # Arias intensity [m/s]

    @property
    def decay_time(self) -> float:
        """Time constant 1 / (2β) in which the remaining intensity falls by e [s]."""
        return self.peak_time * (1.0 - self.peak_share) / (self.growth * self.peak_share)

    def time_of_share(self, share: float) -> float:
        """Time at which a share of the Arias intensity, between 0 and 1, has arrived [s]."""
        if share <= self.peak_share:
            return float(self.peak_time * (share / self.peak_share) ** (1.0 / self.growth))
        return self.peak_time - self.decay_time * log((1.0 - share) / (1.0 - self.peak_share))

    def __call__(self, times: Array) -> Array:
        """Return the standard deviation of the acceleration [m/s²] at times from zero [s], shape (n,)."""
        rising = (np.minimum(times, self.peak_time) / self.peak_time) ** (0.5 * (self.growth - 1.0))
        falling = np.exp(-0.5 * np.maximum(times - self.peak_time, 0.0) / self.decay_time)
        mean_square = 2.0 * STANDARD_GRAVITY / pi * self.arias_intensity * (1.0 - self.peak_share)
        deviations: Array = rising * falling * (mean_square / self.decay_time) ** 0.5
        return deviations


def fit_modulation(component: ComponentParameters) -> Modulation:
    """Find the modulating function that has the durations of a component.

    D0-5 and D5-95 leave a family of functions that differ in the share of the intensity at the peak; D0-30
    picks one of them. A D0-30 outside the reach of the family (up to a third of the draws) gives its nearest
    member, whose peak is at 5 % or at 95 %. Dabaghi & Der Kiureghian minimise the squares of the three errors
    instead; the two agree wherever all three durations can be had.

    Returns with D0-5 and D5-95 exactly, unless D5-95 is so much longer than D0-5 that only D0-95 can be had.
    """
    ratio = component.strong_end / component.onset_duration
    rise_over_end = component.rise_duration / component.strong_end

    def excess(peak_share: float) -> float:
        shape = _unit_shape(peak_share, ratio)
        return shape.time_of_share(_RISE) / shape.time_of_share(_END) - rise_over_end

    if excess(_ONSET) >= 0.0:
        peak_share = _ONSET
    elif excess(_END) <= 0.0:
        peak_share = _END
    else:
        peak_share = scipy.optimize.brentq(excess, _ONSET, _END, xtol=1e-15)
    shape = _unit_shape(peak_share, ratio)
    return Modulation(
        peak_time=component.strong_end / shape.time_of_share(_END),
        peak_share=peak_share,
        growth=shape.growth,
        arias_intensity=component.arias_intensity,
    )


def _unit_shape(peak_share: float, ratio: float) -> Modulation:
    """Return the function with its peak at time 1 and a given ratio of D0-95 to D0-5."""
    before = log(peak_share / _ONSET)
    after = (1.0 - peak_share) / peak_share * log((1.0 - peak_share) / (1.0 - _END))

    def excess(rate: float) -> float:
        return rate * before + log1p(rate * after) - log(ratio)

    rate = (
        _GENTLEST if excess(_GENTLEST) <= 0.0 else scipy.optimize.brentq(excess, 0.0, _GENTLEST, xtol=1e-15)
    )
    return Modulation(peak_time=1.0, peak_share=peak_share, growth=1.0 / rate, arias_intensity=1.0)
