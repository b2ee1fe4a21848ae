"""What is known of a test's error once it has been rebuilt."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.rebuilt_error.error_statistics import mean_square
from reliab.rebuilt_error.initial import Start
from reliab.rebuilt_error.interval import (
    HALF_WIDTH,
    ErrorDraws,
    Estimate,
    Histories,
    Spread,
    Unknown,
    combine,
    estimate,
    probability_below,
)
from reliab.rebuilt_error.noise import SensorNoise
from reliab.rebuilt_error.noise_share import NoiseShare
from reliab.rebuilt_error.parts import Parts, divide
from reliab.rebuilt_error.recursion import Recursion
from reliab.rebuilt_error.whole_structure import WholeStructure
from reliab.rebuilt_error.widenings import Widening, widenings
from reliab.vocabulary import Metric

Array = NDArray[np.float64]

_WIDENING_DRAWS = 128


@dataclass(frozen=True, kw_only=True, eq=False)
class RebuiltError:
    """The error of a test with what is uncertain about it.

    Attributes
    ----------
    time_step : float
        Step between samples [s].
    structure : WholeStructure
        The structure with which it was rebuilt.
    error : numpy.ndarray
        x_m − x_I [m] sample by sample as the sensor reads x_m, its offset taken away, shape (n,).
    smooth_error : numpy.ndarray
        The same without the sensor's noise above the band of the motion [m], shape (n,).
    reference : numpy.ndarray
        x_I [m], what the undisturbed structure would have done, shape (n,).
    low, high : numpy.ndarray
        90 % band of x_m − x_I at each sample [m], shape (n,).
    rms, mte : Estimate
        RMS^R and MTE^R [-] with their 90 % intervals.
    draws : ErrorDraws
        RMS^R and MTE^R of the draws behind the intervals.
    noise : SensorNoise
        Noise of the displacement sensor.
    start : Start
        How the test begins, and the sensor's offset.
    unknown : Unknown
        Standard deviations that went into the intervals.
    histories : Histories
        Smoothed histories from which everything follows.
    share : NoiseShare
        What noise adds to mean square and peak.
    seed : int
        Seed of the draws.
    """

    time_step: float
    structure: WholeStructure
    error: Array
    smooth_error: Array
    reference: Array
    low: Array
    high: Array
    rms: Estimate
    mte: Estimate
    draws: ErrorDraws
    noise: SensorNoise
    start: Start
    unknown: Unknown
    histories: Histories
    share: NoiseShare
    seed: int

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R with its interval."""
        return self.rms if metric is Metric.RMS else self.mte

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that the error is below a threshold.

        Parameters
        ----------
        threshold : float
            Relative error [-], positive.
        metric : Metric, optional
            Which error; RMS^R by default.

        Returns
        -------
        float
            Never 0 or 1: no nearer to them than half a draw.
        """
        return probability_below(self.draws.rms if metric is Metric.RMS else self.draws.mte, threshold)

    def parts(self) -> Parts:
        """Divide the error in amplitude, delay, what is neither, and the fed-back force."""
        return divide(self.histories, Recursion.of_displacement(self.structure, self.time_step))

    def widenings(self, metric: Metric = Metric.RMS) -> tuple[Widening, ...]:
        """Which unknowns widen the interval most, the widest first."""
        return widenings(
            self.histories,
            self.structure,
            self.unknown,
            self.share,
            rms=metric is Metric.RMS,
            draws=_WIDENING_DRAWS,
            seed=self.seed,
        )


def conclude(
    histories: Histories,
    read: Array,
    reference: Array,
    *,
    structure: WholeStructure,
    noise: SensorNoise,
    share: NoiseShare,
    spread: Spread,
    unknown: Unknown,
    start: Start,
    seed: int,
) -> RebuiltError:
    """Bring histories, noise and draws together.

    Parameters
    ----------
    histories : Histories
        Smoothed histories.
    read : numpy.ndarray
        x_m as the sensor reads it, its offset taken away [m], shape (n,).
    reference : numpy.ndarray
        x_I [m], shape (n,).
    structure, noise, share, spread, unknown, start, seed
        What the attributes of the same names say; `spread` holds the draws.

    Returns
    -------
    RebuiltError
        Errors with their intervals.
    """
    smooth = histories.measured - reference
    peak = float(np.abs(reference).max())
    square = max(mean_square(smooth) - share.white, 0.0)
    largest = max(float(np.abs(smooth).max()) - share.white_in_peak, 0.0)
    drawn = combine(spread, share, seed)
    half = HALF_WIDTH * np.hypot(spread.deviation, share.deviation)
    return RebuiltError(
        time_step=histories.time_step,
        structure=structure,
        error=read - reference,
        smooth_error=smooth,
        reference=reference,
        low=smooth - half,
        high=smooth + half,
        rms=estimate(float(np.sqrt(square)) / peak, drawn.rms),
        mte=estimate(largest / peak, drawn.mte),
        draws=drawn,
        noise=noise,
        start=start,
        unknown=unknown,
        histories=histories,
        share=share,
        seed=seed,
    )
