"""Established measures of actuator tracking in the time domain.

All compare the measured displacement x_m with the command x_c. They measure how well the actuator followed,
not how reliable the test is: tracking errors accumulate in the loop.
"""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.signals.spectra import cross_correlate


def maximum_tracking_error(command: Array, measured_displacement: Array) -> float:
    """Largest |x_m − x_c| over largest |x_c| [-].

    `command`, `measured_displacement`: displacements [m], shape (n,). Returns the error [-].
    """
    return float(np.abs(measured_displacement - command).max() / np.abs(command).max())


def rms_tracking_error(command: Array, measured_displacement: Array) -> float:
    """Root mean square of x_m − x_c over that of x_c [-].

    `command`, `measured_displacement`: displacements [m], shape (n,). Returns the error [-].
    """
    return float(np.linalg.norm(measured_displacement - command) / np.linalg.norm(command))


def tracking_indicator(command: Array, measured_displacement: Array) -> Array:
    """Tracking indicator: signed area between the two displacements, Mercan and Ricles 2007.

    Half of ∫x_c dx_m − ∫x_m dx_c by the trapezoidal rule; it grows while the actuator lags, falls
    while it leads and stays level while it follows. It is π times amplitude squared times the
    sine of the lag for each cycle of a harmonic.

    `command`, `measured_displacement`: displacements [m], shape (n,). Returns
    indicator [m²] up to each sample, shape (n,); zero at the first.

    One cycle at unit amplitude with a lag of 0.1 rad encloses an area of π sin 0.1:

    >>> phase = np.linspace(0.0, 2.0 * np.pi, 1001)
    >>> float(tracking_indicator(np.sin(phase), np.sin(phase - 0.1))[-1].round(4))
    0.3136
    """
    middle_command = 0.5 * (command[1:] + command[:-1])
    middle_measured = 0.5 * (measured_displacement[1:] + measured_displacement[:-1])
    increments = middle_command * np.diff(measured_displacement) - middle_measured * np.diff(command)
    return np.concatenate([[0.0], 0.5 * np.cumsum(increments)])


@dataclass(frozen=True, kw_only=True)
class PhaseAmplitudeErrors:
    """Phase and amplitude error indices."""

    phase: float  # Phase lag of the measured displacement [rad], negative when it leads
    amplitude: float  # Measured over command amplitude, less one [-]


def phase_amplitude_errors(command: Array, measured_displacement: Array) -> PhaseAmplitudeErrors:
    """Phase and amplitude error indices from the ellipse of x_m over x_c, Hessabi and Mercan 2012.

    The ellipse is the one with the second moments of the trace, which stays meaningful when the
    amplitude varies; for a harmonic it is the trace itself. The direction of travel gives the sign.

    `command`, `measured_displacement`: displacements [m], shape (n,). Returns phase lag and
    relative amplitude error.

    >>> phase = np.linspace(0.0, 20.0 * np.pi, 20001)
    >>> found = phase_amplitude_errors(np.sin(phase), 0.98 * np.sin(phase - 0.05))
    >>> round(found.phase, 3), round(found.amplitude, 3)
    (0.05, -0.02)
    """
    amplitude = float(np.std(measured_displacement) / np.std(command))
    correlation = float(
        np.corrcoef(command, measured_displacement)[0, 1]
    )  # within ±1, rounding errors cut by NumPy
    direction = float(np.sign(tracking_indicator(command, measured_displacement)[-1]))
    return PhaseAmplitudeErrors(phase=direction * float(np.arccos(correlation)), amplitude=amplitude - 1.0)


def energy_error(command: Array, measured_displacement: Array, force: Array) -> Array:
    """Energy that the tracking error adds to the structure, Mosqueda and others 2007.

    The specimen does the work ∫r dx_m; the numerical substructure assumes the work ∫r dx_c. The structure
    receives the difference as energy that no ground motion supplied.

    `command`, `measured_displacement`: displacements [m], shape (n,); `force`: restoring force r of the
    specimen [N], shape (n,). Returns energy error [J] up to each sample, positive when energy is added,
    shape (n,).
    """
    middle_force = 0.5 * (force[1:] + force[:-1])
    return np.concatenate(
        [[0.0], np.cumsum(middle_force * (np.diff(measured_displacement) - np.diff(command)))]
    )


def delay_by_cross_correlation(command: Array, measured_displacement: Array, time_step: float) -> float:
    """Delay at which the cross-correlation of command and measured displacement is largest [s].

    `command`, `measured_displacement`: displacements [m], shape (n,); `time_step`: step between samples [s].
    Returns delay [s], refined between samples by a parabola; positive when the measured displacement lags.

    >>> t = np.arange(0.0, 20.0, 0.001)
    >>> command, measured = np.sin(2 * np.pi * t) * np.exp(-t / 5), np.zeros_like(t)
    >>> measured[4:] = command[:-4]
    >>> round(1e3 * delay_by_cross_correlation(command, measured, 0.001), 2)
    4.0
    """
    correlation = cross_correlate(measured_displacement, command)
    lags = np.arange(1 - command.size, command.size)
    best = int(np.argmax(correlation))
    shift = 0.0
    if 0 < best < correlation.size - 1:
        value_before, peak, value_after = correlation[best - 1 : best + 2]
        shift = 0.5 * (value_before - value_after) / (value_before - 2.0 * peak + value_after)
    return float((lags[best] + shift) * time_step)
