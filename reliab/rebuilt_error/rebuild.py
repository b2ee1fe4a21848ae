"""The error of one test, rebuilt from its own command and measured displacement.

A test obeys M x_c'' + C_n x_c' + K_n x_c = −M ι a_g − γ f, the undisturbed structure the same with the
specimen's true force under its own motion. Their difference e = x_c − x_I obeys the whole structure's own
equation, driven only by the restoring force that was wrong ::

    M e'' + C e' + K e = γ (Z x_c − f),   f = Z x_m,   Z = k_e + c_e s + m_e s²
    one degree of freedom:   e'' + 2ξω₀e' + ω₀²e = αω₀²(x_c − x_m)
    x_m − x_I = e − (x_c − x_m)

Neither the ground motion nor a reference is needed, and the actuator may do anything. It holds for a linear
structure whose properties are the stated ones (derivation: subtract the two equations of motion).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.loop.structure import Structure
from reliab.rebuilt_error.error_statistics import mean_square
from reliab.rebuilt_error.feedback import delayed
from reliab.rebuilt_error.initial import Start, examine_start
from reliab.rebuilt_error.interval import (
    HALF_WIDTH,
    ErrorDraws,
    Estimate,
    Histories,
    NoiseShare,
    Unknown,
    Widening,
    combine,
    estimate,
    probability_below,
    share_of_noise,
    sweep,
    widenings,
)
from reliab.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.rebuilt_error.parts import Parts, divide
from reliab.rebuilt_error.recursion import Recursion, respond
from reliab.rebuilt_error.tolerances import Tolerances
from reliab.rebuilt_error.whole_structure import WholeStructure
from reliab.vocabulary import Metric

Array = NDArray[np.float64]

DRAWS = 256
"""Draws of what is not known; a power of two."""

_FEWEST_SAMPLES = 64
_FEWEST_PER_PERIOD = 10.0
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


def rebuild(
    command: Array,
    measured: Array,
    time_step: float,
    structure: Structure | WholeStructure,
    *,
    feedback_lag: float = 0.0,
    sensor_offset: float | None = None,
    tolerances: Tolerances | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> RebuiltError:
    """Rebuild the error of a test from its command and measured displacement.

    Parameters
    ----------
    command, measured : numpy.ndarray
        x_c and x_m at the interface [m] at equal steps, shape (n,), n ≥ 64.
    time_step : float
        Step between samples [s].
    structure : Structure or WholeStructure
        The whole structure under test.
    feedback_lag : float, optional
        Time by which the force was fed back late [s].
    sensor_offset : float, optional
        Offset of the displacement sensor that the loop did not feel [m]; by default it is read from the rest
        before the test. Give 0 where the force follows the reading, offset included.
    tolerances : Tolerances, optional
        How far stated values may be off; by default they are exact.
    draws : int, optional
        Draws behind the intervals, a power of two.
    seed : int, optional
        Seed of the draws.

    Returns
    -------
    RebuiltError
        Histories, RMS^R and MTE^R with 90 % intervals.

    Raises
    ------
    InputError
        If histories differ in length, are too short, do not move or are not finite, or if the step is too
        long for the structure.

    Examples
    --------
    An actuator that moves 1 % too little under a steady sine at resonance:

    >>> time = np.arange(0.0, 60.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> error = rebuild(command, 0.99 * command, 1.0 / 256.0, Structure(frequency=1.0, damping_ratio=0.05))
    >>> round(error.rms.value, 3)
    0.06
    """
    whole = WholeStructure.of(structure) if isinstance(structure, Structure) else structure
    command, measured = _checked(command, measured, time_step, whole)
    noise = estimate_noise(command, measured, time_step)
    lowest = float(whole.natural_frequencies[0]) or 1.0
    start = examine_start(command, measured, time_step, lowest, noise.white, noise.slow)
    if sensor_offset is not None:
        start = replace(start, offset=sensor_offset, offset_deviation=0.0)
    read = measured - start.offset
    recursion = Recursion.of_displacement(whole, time_step)
    fed_back = command - delayed(read, feedback_lag, time_step)
    response = respond(recursion, fed_back)[0]
    difference = noise.smooth(command - read)
    smooth = response - difference
    histories = Histories(
        command=command,
        measured=command - difference,
        fed_back=difference if feedback_lag == 0.0 else noise.smooth(fed_back),
        time_step=time_step,
    )
    share = share_of_noise(noise, whole, smooth, np.random.default_rng(seed))
    relative = np.sqrt(mean_square(response) / mean_square(command))
    unknown = Unknown(
        tolerances=tolerances or Tolerances(),
        offset=start.offset_deviation,
        error_at_start=0.0 if start.at_rest else float(relative) * start.amplitude,
    )
    spread = sweep(histories, whole, unknown, draws, seed)
    drawn = combine(spread, share, seed)
    peak = float(np.abs(command - response).max())
    half = HALF_WIDTH * np.hypot(spread.deviation, share.deviation)
    return RebuiltError(
        time_step=time_step,
        structure=whole,
        error=response - (command - read),
        smooth_error=smooth,
        reference=command - response,
        low=smooth - half,
        high=smooth + half,
        rms=estimate(float(np.sqrt(max(mean_square(smooth) - share.white, 0.0))) / peak, drawn.rms),
        mte=estimate(max(float(np.abs(smooth).max()) - float(share.in_peak.mean()), 0.0) / peak, drawn.mte),
        draws=drawn,
        noise=noise,
        start=start,
        unknown=unknown,
        histories=histories,
        share=share,
        seed=seed,
    )


def _checked(command: Array, measured: Array, step: float, structure: WholeStructure) -> tuple[Array, Array]:
    command, measured = (np.ascontiguousarray(values, dtype=np.float64) for values in (command, measured))
    if command.ndim != 1 or command.shape != measured.shape or command.size < _FEWEST_SAMPLES:
        raise InputError(
            f"Command and measured displacement must have one length, at least {_FEWEST_SAMPLES} samples",
            value=f"shapes {command.shape} and {measured.shape}",
            remedy="Give the histories of one interface over the whole test",
        )
    for name, values in (("command", command), ("measured displacement", measured)):
        if not np.isfinite(values).all():
            raise InputError(f"The {name} must be finite throughout", remedy="Repair the recording")
    if not np.ptp(command) > 0.0:
        raise InputError("The command must move", remedy="Check that the column is the right one")
    if not (np.isfinite(step) and step > 0.0):
        raise InputError("The time step must be positive", value=f"{step} s")
    lowest = float(structure.natural_frequencies[0])
    if lowest * step * _FEWEST_PER_PERIOD > 1.0:
        raise InputError(
            f"A period of the structure must hold at least {_FEWEST_PER_PERIOD:.0f} samples",
            value=f"{1.0 / (lowest * step):.3g}",
            remedy="Record at a higher rate; between samples the error is not known",
        )
    return command, measured
