"""Established measures of how the actuator followed its command, in the time domain."""

from dataclasses import dataclass

import numpy as np

from reliab.indices import (
    delay_by_cross_correlation,
    energy_error,
    maximum_tracking_error,
    phase_amplitude_errors,
    rms_tracking_error,
    tracking_indicator,
)
from reliab.recordings import Recording


@dataclass(frozen=True, kw_only=True)
class TrackingMeasures:
    """Measures of tracking, which say nothing of how errors accumulate in the loop."""

    maximum_error: float  # Largest |x_m − x_c| over largest |x_c| [-]
    rms_error: float  # RMS of x_m − x_c over that of x_c [-]
    # Tracking indicator at the end of the test [m²]; positive when the measured displacement lags
    tracking_indicator: float
    phase_error: float  # Phase lag of the PAEI [rad]
    amplitude_error: float  # Amplitude error of the PAEI [-]
    # Energy that the tracking error added by the end of the test, over the largest strain energy of the
    # specimen [-]; with the recorded force, or that of a linear specimen
    energy_error: float
    of_recorded_force: bool  # Whether the energy is that of a recorded force
    delay_by_correlation: float  # Delay at which the cross-correlation is largest [s]


def measure_tracking(recording: Recording) -> TrackingMeasures:
    """Evaluate the measures of tracking of a test.

    >>> phase = np.linspace(0.0, 20.0 * np.pi, 20001)
    >>> found = measure_tracking(
    ...     Recording(command=np.sin(phase), measured=0.98 * np.sin(phase - 0.05), time_step=0.001)
    ... )
    >>> round(found.phase_error, 3), round(found.amplitude_error, 3), round(found.tracking_indicator, 2)
    (0.05, -0.02, 1.54)
    """
    command, measured = recording.command, recording.measured
    force = measured if recording.force is None else recording.force
    errors = phase_amplitude_errors(command, measured)
    largest_energy = 0.5 * float(np.abs(force * measured).max())
    return TrackingMeasures(
        maximum_error=maximum_tracking_error(command, measured),
        rms_error=rms_tracking_error(command, measured),
        tracking_indicator=float(tracking_indicator(command, measured)[-1]),
        phase_error=errors.phase,
        amplitude_error=errors.amplitude,
        energy_error=float(energy_error(command, measured, force)[-1]) / largest_energy,
        of_recorded_force=recording.force is not None,
        delay_by_correlation=delay_by_cross_correlation(command, measured, recording.time_step),
    )
