"""A frame with one actuator under one ground motion, solved with the pole pairs of the test.

Many actuators are stepped side by side, by one recursion of two states for each pole pair. A pair
z' = pz + a_g with residue r is exact for a ground acceleration that is linear in each step. With
E = e^(ph) and the weights F₀, F₁ of both ends of a step its displacement y = −2Re(rz) obeys::

    y₊₊ = 2Re(E)y₊ − |E|²y − 2Re(rF₁)a₊₊ − 2Re(rF₀ − rE*F₁)a₊ + 2Re(rE*F₀)a

The hybrid test is reduced to one pole pair for each mode and a fast remainder. With g = γᵀD⁻¹γ of the
undivided structure, D = M s² + C s + K, and σ = k_p e^(−sτ), the poles of the test are the roots of ``1 +
Z(s)(σ(s) − 1)g(s) = 0``. Each pole λ of the structure grows into one of them as the actuator's error grows,
and is traced by Newton's iteration on ``(s − λ)(1 + Z(σ − 1)g)``, which has no singularity at λ, so that a
mode that the specimen does not drive stays where it is. At a pole p the response is that of the shape v with
``(D + Z(σ − 1)γγᵀ)v = 0``; since the matrix is symmetric the residue of the floors under −a_g is ``v vᵀMι /
vᵀ(dD/ds + d(Z(σ − 1))/ds γγᵀ)v``. The remainder of the transfer function is nearly constant over the
frequencies of earthquakes; a first-order lag with its value and slope at s = 0 approximates it.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled, copy_rows
from reliab.core.errors import InputError
from reliab.simulation.excitation import (
    LATEST,
    TRACKS,
    Deviation,
    Excitation,
    follow,
    peak_of_history,
    summary,
)
from reliab.simulation.linear_loop.blocks import ramp_weights
from reliab.structures.critical_delay import stability_limit
from reliab.structures.frame import reference_response
from reliab.structures.partition import Partition

_PARTS = 4  # in which the actuator's error is approached
_NEWTON_STEPS = 30
_CONVERGENCE_TOLERANCE = 1e-12
_CIRCLE = 8  # points around s = 0 from which value and slope there are taken
_UNKNOWN_POLES = np.errstate(over="ignore", invalid="ignore", divide="ignore")
"""A pole that is not found runs away, and is NaN in what is computed from it."""


@dataclass(frozen=True, kw_only=True)
class PoleLoop:
    """Poles and residues of one output of the test, one column per cell."""

    # poles, residues: Poles p [1/s] with positive imaginary part and residues r [s] of the response to −a_g,
    # shape (modes, cells); their conjugates belong to them. NaN where Newton's iteration did not converge
    poles: Spectrum
    residues: Spectrum
    # remainder, remainder_time: Static value R [s²] and time constant T [s] of what the pairs leave, shape
    # (cells,): R/(1 + Ts), or for T < 0 the ground ahead, R e^(−Ts)
    remainder: Array
    remainder_time: Array

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether every followed pole lies in the left half-plane, shape (cells,)."""
        return np.asarray((self.poles.real < 0.0).all(axis=0))

    @_UNKNOWN_POLES
    def transfer(self, s: Spectrum) -> Spectrum:
        """Reduced transfer function from −a_g [s²] at s [rad/s], shape (frequencies, cells)."""
        s_column = np.asarray(s)[:, np.newaxis]
        lag, ahead = np.maximum(self.remainder_time, 0.0), np.maximum(-self.remainder_time, 0.0)
        total = self.remainder * np.exp(s_column * ahead) / (1.0 + s_column * lag)
        for pole, residue in zip(self.poles, self.residues, strict=True):
            total = total + residue / (s_column - pole) + residue.conj() / (s_column - pole.conj())
        return np.asarray(total)


@_UNKNOWN_POLES
def pole_loop(partition: Partition, gain: Array, delay: Array, output: Array | None = None) -> PoleLoop:
    """Follow the poles of the test for many actuators, and work out the residues of an output."""
    start = partition.frame.poles
    if start.size < partition.frame.size:
        raise InputError(
            "A mode of the frame does not oscillate",
            value=f"{partition.frame.size - start.size} overdamped modes",
            remedy="Reduce the damping, or the number of degrees of freedom",
        )
    poles = np.stack([_follow_pole(partition, complex(pole), gain, delay) for pole in start])
    residues = _residues(partition, poles, gain, delay, output)
    remainder, remainder_time = _remaining_gain(partition, poles, residues, gain, delay, output)
    return PoleLoop(poles=poles, residues=residues, remainder=remainder, remainder_time=remainder_time)


def _follow_pole(partition: Partition, pole: complex, gain: Array, delay: Array) -> Spectrum:
    """Pole that grows out of one of the structure's, shape (cells,)."""
    start, other_poles, residue, other_residues = _receptance(partition, pole)
    k, c, m = partition.specimen.stiffness, partition.specimen.damping, partition.specimen.mass
    s = np.full(gain.size, start, dtype=np.complex128)
    step = s
    for stage in range(1, _PARTS + 1):
        share = stage / _PARTS
        for _ in range(_NEWTON_STEPS):
            sigma = gain * np.exp(-s * delay)
            error = share * (sigma - 1.0)
            impedance, impedance_slope = k + s * (c + s * m), c + 2.0 * s * m
            distance = s[:, np.newaxis] - other_poles
            sum_over_others = (other_residues / distance).sum(axis=1)
            slope_over_others = -(other_residues / distance**2).sum(axis=1)
            smooth = residue + (s - start) * sum_over_others  # (s − λ)·g
            smooth_slope = sum_over_others + (s - start) * slope_over_others
            force = impedance * error
            force_slope = impedance_slope * error - impedance * share * delay * sigma
            value = (s - start) + smooth * force
            slope = 1.0 + smooth_slope * force + smooth * force_slope
            step = value / slope
            s = s - step
            if np.all(np.abs(step) <= _CONVERGENCE_TOLERANCE * np.abs(s)):
                break
    has_converged = (np.abs(step) <= 1e-8 * np.abs(s)) & (s.imag > 0.0)
    return np.asarray(np.where(has_converged, s, np.nan))


def _receptance(partition: Partition, pole: complex) -> tuple[complex, Spectrum, complex, Spectrum]:
    """Split g = Σ r/(s − λ) into the pole nearest to a given one and the others."""
    matrix = partition.frame.state_matrix
    n = partition.frame.size
    eigenvalues, right = np.linalg.eig(matrix)
    driven = np.concatenate([np.zeros(n), np.linalg.solve(partition.frame.mass, partition.direction)])
    residues = (partition.direction @ right[:n]) * np.linalg.solve(right, driven.astype(complex))
    place = int(np.argmin(np.abs(eigenvalues - pole)))
    rows = np.arange(2 * n) != place
    return (complex(eigenvalues[place]), eigenvalues[rows], complex(residues[place]), residues[rows])


def _residues(
    partition: Partition, poles: Spectrum, gain: Array, delay: Array, output: Array | None
) -> Spectrum:
    """Residues of the output at each pole, shape (modes, cells)."""
    frame, gamma = partition.frame, partition.direction
    load = frame.mass @ frame.influence
    k, c, m = partition.specimen.stiffness, partition.specimen.damping, partition.specimen.mass
    s = np.nan_to_num(poles, nan=1.0)
    sigma = gain * np.exp(-s * delay)
    force = partition.impedance(s)[..., 0, 0] * (sigma - 1.0)
    force_slope = (c + 2.0 * s * m) * (sigma - 1.0) - (k + s * (c + s * m)) * delay * sigma
    s_matrix = s[..., np.newaxis, np.newaxis]
    outer = np.outer(gamma, gamma)
    matrix = frame.dynamic_stiffness(s) + force[..., np.newaxis, np.newaxis] * outer
    slope = 2.0 * s_matrix * frame.mass + frame.damping + force_slope[..., np.newaxis, np.newaxis] * outer
    shapes = np.linalg.svd(matrix)[2][..., -1, :].conj()
    scale = np.einsum("...i,...ij,...j->...", shapes, slope, shapes)
    response = (shapes @ load) / scale
    output_shapes = sigma * (shapes @ gamma) if output is None else shapes @ output
    return np.asarray(np.where(np.isnan(poles), np.nan, response * output_shapes))


def _remaining_gain(
    partition: Partition, poles: Spectrum, residues: Spectrum, gain: Array, delay: Array, output: Array | None
) -> tuple[Array, Array]:
    """Value and time constant at s = 0 of what the pole pairs leave of the transfer function."""
    radius = 0.5 * float(np.abs(partition.frame.poles).min())
    s = radius * np.exp(2j * np.pi * (np.arange(_CIRCLE) + 0.5) / _CIRCLE)
    exact = transfer(partition, gain, delay, s, output)
    s_matrix = s[:, np.newaxis, np.newaxis]
    remainder = exact - (residues / (s_matrix - poles) + residues.conj() / (s_matrix - poles.conj())).sum(
        axis=1
    )
    value = remainder.mean(axis=0).real
    slope = (remainder / s[:, np.newaxis]).mean(axis=0).real
    time = np.nan_to_num(-slope / value, nan=0.0, posinf=0.0, neginf=0.0)
    # A delay leaves a remainder that lags (T > 0), a lead one that is ahead (T < 0); any other is static.
    sound = (time * delay > 0.0) & (np.abs(time) < 2.0 * np.abs(delay))
    return np.asarray(np.nan_to_num(value)), np.where(sound, time, 0.0)


def transfer(
    partition: Partition, gain: Array, delay: Array, s: Spectrum, output: Array | None = None
) -> Spectrum:
    """Exact transfer function of an output from −a_g [s²], for many actuators.

    The structure is solved once for each frequency; an actuator's error only adds a multiple of γγᵀ, which
    the formula of Sherman and Morrison takes into account.

    `s` [rad/s].
    """
    frame, gamma = partition.frame, partition.direction
    loads = np.column_stack([frame.mass @ frame.influence, gamma]).astype(complex)
    solution = np.linalg.solve(frame.dynamic_stiffness(s), loads[np.newaxis])
    command_transfer, receptance = (
        (solution[..., 0] @ gamma)[:, np.newaxis],
        (solution[..., 1] @ gamma)[:, np.newaxis],
    )
    sigma = gain * np.exp(-np.asarray(s)[:, np.newaxis] * delay)
    force = partition.impedance(s)[..., 0] * (sigma - 1.0)
    command = command_transfer / (1.0 + force * receptance)
    if output is None:
        return np.asarray(sigma * command)
    ideal, force_transfer = (
        (solution[..., 0] @ output)[:, np.newaxis],
        (solution[..., 1] @ output)[:, np.newaxis],
    )
    return np.asarray(ideal - force_transfer * force * command)


LANES = 64
"""Cells that advance side by side."""

_COEFFICIENTS = 7


def recursion(loop: PoleLoop, step: float) -> Array:
    """Coefficients of every pair and of the remainder.

    `step` [s].
    Returns shape (modes + 1, 7, cells): of the last two displacements, of the ground at the end of this step,
    at its begin and a step before, the displacement a step before the record for which its first sample acts
    as a jump, and of the ground at the end of the next step. The last row is the remainder.
    """
    early, late, decay = ramp_weights(loop.poles, step)
    r, back = loop.residues, loop.residues * decay.conj()
    jump = 2.0 * (back * late).real
    decay_squared = np.abs(decay) ** 2
    pairs = np.stack(
        [
            2.0 * decay.real,
            -decay_squared,
            -2.0 * (r * late).real,
            jump - 2.0 * (r * early).real,
            2.0 * (back * early).real,
            jump / decay_squared,
            np.zeros_like(jump),
        ],
        axis=1,
    )
    return np.concatenate([pairs, _remainder(loop, step)[np.newaxis]])


def _remainder(loop: PoleLoop, step: float) -> Array:
    """Coefficients of the remainder, shape (7, cells): a first-order lag, or the ground some time ahead."""
    remainder = np.zeros((_COEFFICIENTS, loop.remainder.size))
    ahead = np.maximum(-loop.remainder_time, 0.0) / step
    remainder[2], remainder[6] = -loop.remainder * (1.0 - ahead), -loop.remainder * ahead
    lags = loop.remainder_time > 0.0
    if lags.any():
        pole = -1.0 / loop.remainder_time[lags]
        early, late, decay = ramp_weights(pole, step)
        static = -loop.remainder[lags] * pole
        remainder[0, lags], remainder[2, lags], remainder[3, lags] = decay, -static * late, -static * early
    return remainder


@compiled
def track(ground: Array, ideal: Array, first: int, coefficients: Array) -> Array:
    """Step cells from rest and track their deviation from the sample `first` on, shape (tracks, cells)."""
    cells = coefficients.shape[2]
    tracks = np.empty((TRACKS, cells))
    for begin in range(0, cells, LANES):
        lanes = slice(begin, begin + LANES)
        copy_rows(_track_lanes(ground, ideal, first, coefficients[:, :, lanes]), tracks[:, lanes])
    return tracks


@compiled
def _track_lanes(  # noqa: C901 - one compiled loop
    ground: Array, ideal: Array, first: int, coefficients: Array
) -> Array:
    pairs, last = coefficients.shape[0] - 1, ground.size - 1
    k = np.empty((pairs + 1, _COEFFICIENTS, LANES))
    for p in range(pairs + 1):
        copy_rows(coefficients[p], k[p])
    t = np.zeros((TRACKS, LANES))
    for j in range(LANES):
        t[LATEST, j] = np.nan
    x, y, remainder, total = (
        np.zeros((pairs, LANES)),
        np.zeros((pairs, LANES)),
        np.zeros(LANES),
        np.zeros(LANES),
    )
    # y lies one step before x; it starts where a jump at the first sample puts it.
    for p in range(pairs):
        for j in range(LANES):
            y[p, j] = k[p, 5, j] * ground[0]
    for i in range(last + 1):
        now, next_load = ground[i], ground[min(i + 1, last)]
        previous_load = ground[i - 1] if i > 0 else 0.0
        earlier = ground[i - 2] if i > 1 else 0.0
        for j in range(LANES):
            remainder[j] = k[pairs, 0, j] * remainder[j] + k[pairs, 2, j] * now
            remainder[j] += k[pairs, 3, j] * previous_load + k[pairs, 6, j] * next_load
            total[j] = remainder[j]
        if i > 0:
            for p in range(pairs):
                for j in range(LANES):
                    displacement = k[p, 0, j] * x[p, j] + k[p, 1, j] * y[p, j]
                    displacement += k[p, 2, j] * now + k[p, 3, j] * previous_load + k[p, 4, j] * earlier
                    y[p, j] = x[p, j]
                    x[p, j] = displacement
                    total[j] += displacement
        if i >= first:
            weight = 0.5 if i in (first, last) else 1.0
            exact = ideal[i]
            for j in range(LANES):
                track_of = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                track_of = follow(track_of, total[j] - exact, weight)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track_of
    return t


_COMPARISON_POINTS = 61
_HIGHEST = 100.0  # Hz, above which the content of records is neglected
_NO_DEVIATION = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class ReducedLoop:
    """A frame with one actuator under one ground motion, whose test is reduced to pole pairs."""

    excitation: Excitation  # Record and window
    partition: Partition
    output: Array | None  # Weights of the degrees of freedom, shape (n,); None for the measured interface
    step: float  # s, the record's divided by a whole number

    def poles(self, gain: Array, delay: Array) -> PoleLoop:
        """Poles and residues of the test with actuators of gains [-] and delays [s], shape (cells,)."""
        return pole_loop(self.partition, gain, delay, self.output)

    def deviation(self, poles: PoleLoop) -> Deviation:
        """Deviation of the output; infinite where the test is unstable and poles could not be followed."""
        ground, first = self._sample_excitation
        cells = poles.remainder.size
        with np.errstate(all="ignore"):  # a violently unstable cell may overflow, or its poles be unknown
            coefficients = recursion(poles, self.step)
            lanes = np.pad(coefficients, ((0, 0), (0, 0), (0, -cells % LANES)), mode="edge")
            tracks = track(ground, self._ideal, first, np.ascontiguousarray(lanes))[:, :cells]
            deviation = summary(tracks, float(ground.size - 1 - first), peak_of_history(self._ideal[first:]))
        return replace(
            deviation,
            mean_square=np.nan_to_num(deviation.mean_square, nan=np.inf, posinf=np.inf),
            peak=np.nan_to_num(deviation.peak, nan=np.inf, posinf=np.inf),
        )

    def stable(self, gain: Array, delay: Array) -> NDArray[np.bool_]:
        """Whether each delay is below the critical delay, as every lead is."""
        gains, places = np.unique(gain, return_inverse=True)
        limits = np.array([stability_limit(self.partition, gain).delay for gain in gains.tolist()])
        return np.asarray(delay < limits[places])

    def error(self, poles: PoleLoop, gain: Array, delay: Array) -> Array:
        """Relative error of RMS^R that the reduction causes for this record [-], shape (cells,)."""
        s = (2j * np.pi * self._frequencies).astype(np.complex128)
        exact = transfer(self.partition, gain, delay, s, self.output)
        ideal = transfer(self.partition, np.ones(1), np.zeros(1), s, self.output)
        neglected_power = np.abs(exact - poles.transfer(s)) ** 2
        neglected_power = np.where(np.isfinite(neglected_power), neglected_power, np.inf)
        total = np.maximum(np.abs(exact - ideal), _NO_DEVIATION * np.abs(ideal)) ** 2
        with np.errstate(invalid="ignore"):
            error = np.sqrt(self._band_power @ neglected_power / np.maximum(self._band_power @ total, 1e-300))
        return np.where(np.isnan(error), np.inf, error)

    @cached_property
    def _sample_excitation(self) -> tuple[Array, int]:
        """Ground acceleration at the steps up to the end of the window, and the step at which it begins."""
        begin, end = self.excitation.window
        times = self.step * np.arange(round(end / self.step) + 1)
        record_times = self.excitation.time_step * np.arange(self.excitation.acceleration.size)
        return np.interp(times, record_times, self.excitation.acceleration), round(begin / self.step)

    @cached_property
    def _ideal(self) -> Array:
        """Exact response of the output [m] at the steps."""
        floors = reference_response(self.partition.frame, self._sample_excitation[0], self.step)
        output_row = self.partition.direction if self.output is None else self.output
        return np.ascontiguousarray(output_row @ floors)

    @cached_property
    def _frequencies(self) -> Array:
        """Frequencies [Hz] at which the reduction is compared with the exact loop, shape (bands,)."""
        modes = self.partition.frame.modes.frequency
        return np.geomspace(0.1 * modes[0], max(_HIGHEST, 4.0 * modes[0]), _COMPARISON_POINTS)

    @cached_property
    def _band_power(self) -> Array:
        half = np.sqrt(self._frequencies[1] / self._frequencies[0])
        return self.excitation.band_power(np.append(self._frequencies / half, self._frequencies[-1] * half))
