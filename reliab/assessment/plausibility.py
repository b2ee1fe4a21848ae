"""Recordings that cannot be judged: too short or coarse, opposite signs, two units, exchanged, unrelated.

Those that are nearly so are warned of.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_structure
from reliab.assessment.recorded_force import ExaminedForce, require_order, require_restoring_force
from reliab.assessment.tracking_index import TrackingIndex, white_noise_share
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, significant
from reliab.recordings.behaviour import remove_spikes
from reliab.recordings.recording import Part, Recording
from reliab.signals.spectra import cross_correlate
from reliab.structures.partition import Partition

_OPPOSITE = -0.8
"""Correlation below which the measured displacement runs against the command."""

_LEAST_CORRELATION = 0.2
"""Correlation at the best lag below which the measured displacement does not follow the command; in an
unstable test it follows late, but with a higher correlation."""

_LONGEST_REACTION = 0.1
"""Time by which a rig may be late [s]. Half a period below it is no reversed sign for sure."""

_STEP_CORRELATION = 0.8
"""Correlation above which a rig is not late enough to attenuate by a filter of its own."""

_PROPORTIONAL = 0.98
"""Correlation at the best lag above which a difference in size is a factor, not a limit of the rig."""

_FEWEST_PERIODS = 2.0
_LONGEST_STEP = 0.2  # of a period
_LONGEST_LAG = 0.25  # of the test
_LARGEST_NOISE = 0.5  # in power

_UNIT_FACTORS = {
    1000.0: "millimetres and the other in metres",
    100.0: "centimetres and the other in metres",
    10.0: "millimetres and the other in centimetres",
    39.3701: "inches and the other in metres",
    25.4: "millimetres and the other in inches",
    2.54: "centimetres and the other in inches",
    3.28084: "feet and the other in metres",
    12.0: "inches and the other in feet",
}
_UNIT_TOLERANCE = 0.1
_FEW_PERIODS = 10.0
_FEW_SAMPLES = 20.0  # of a period
_NOISY = 0.05  # of the measured displacement


def require_length(recording: Recording, frequency: float) -> None:
    """Refuse a test of less than two periods of the structure, or of less than five samples in a period.

    `frequency` [Hz].
    """
    periods = recording.duration * frequency
    if periods < _FEWEST_PERIODS:
        raise InputError(
            f"The test is shorter than {_FEWEST_PERIODS:g} periods of the structure",
            value=f"{significant(periods, 2)} ({recording.duration:g} s at {frequency:g} Hz)",
            remedy="Give the whole test; times are in seconds unless `time_units` says otherwise",
            where=recording.name,
        )
    if recording.time_step * frequency > _LONGEST_STEP:
        raise InputError(
            f"The time step is longer than {_LONGEST_STEP:g} of a period of the structure",
            value=f"{recording.time_step:g} s at {frequency:g} Hz",
            remedy='Times are in seconds; if they are in milliseconds, give `time_units="ms"`',
            where=recording.name,
        )


def require_drawable(recording: Recording, structure: Partition) -> None:
    """Refuse a test that is too long for the intervals of its error, before anything is computed from it."""
    step = recording.time_step
    require_fitting(recording.samples, samples_in_step_of_structure(structure, step), step)


def require_plausible(
    recording: Recording,
    *,
    stiffness: float | None = None,
    linear: bool = False,
    is_stiffness_fitted: bool = False,
) -> ExaminedForce | None:
    """Refuse a recording whose channels contradict each other by a sign, a unit or their order.

    Returns the recorded force as it was examined, if there is one in a test that is long enough.

    `stiffness`: stated one of the specimen [N/m], without which the unit of a recorded force is not examined;
    `linear`: whether the specimen is taken as linear; `is_stiffness_fitted`: whether its stiffness is fitted.
    """
    clean, *_ = remove_spikes(recording)
    _require_following(clean)
    if clean.force is None:
        return None
    examined = require_restoring_force(
        clean.measured,
        clean.force,
        clean.time_step,
        stiffness=stiffness,
        linear=linear,
        is_stiffness_fitted=is_stiffness_fitted,
        is_unit_stated=all(channel.unit for channel in clean.channels if channel.part is Part.FORCE),
        name=clean.name,
    )
    if examined is not None:
        require_order(clean.command, examined, clean.name)
    return examined


def _require_following(recording: Recording) -> None:
    """Refuse measured displacement with another sign or unit than its command, or unrelated to it."""
    command, measured_displacement = _moving(recording.command), _moving(recording.measured)
    size = float(np.linalg.norm(command) * np.linalg.norm(measured_displacement))
    correlation = float(command @ measured_displacement) / size
    reach, centre = int(_LONGEST_LAG * command.size), command.size - 1
    products = cross_correlate(measured_displacement, command)[centre - reach : centre + reach + 1]
    best, lag = float(products.max()) / size, abs(int(np.argmax(products)) - reach) * recording.time_step
    if correlation < _OPPOSITE and lag > _LONGEST_REACTION:
        raise InputError(
            "The measured displacement has the opposite sign of the command",
            value=f"a correlation of {correlation:.2f} between the two",
            remedy="Reverse the sign of one channel",
            where=recording.name,
        )
    if best < _LEAST_CORRELATION:
        raise InputError(
            "The measured displacement does not follow the command",
            value=f"a correlation of at most {best:.2f} between the two",
            remedy="Check that the columns and their units are the right ones",
            where=recording.name,
        )
    noise = white_noise_share(recording.measured)
    if noise > _LARGEST_NOISE and best**2 < 1.0 - _LARGEST_NOISE:  # else it follows a random command
        raise InputError(
            "The measured displacement does not follow the command",
            value=f"{percent(noise, decimals=0)} of its power is white noise",
            remedy="Check that the channel was connected",
            where=recording.name,
        )
    if correlation > _STEP_CORRELATION and best > _PROPORTIONAL:
        _require_one_unit(
            float(np.linalg.norm(measured_displacement) / np.linalg.norm(command)), recording.name
        )


def _require_one_unit(ratio: float, name: str) -> None:
    """Refuse a measured displacement that is larger or smaller than the command by the ratio of two units."""
    for factor, units in _UNIT_FACTORS.items():
        for unit_ratio in (factor, 1.0 / factor):
            if abs(ratio / unit_ratio - 1.0) < _UNIT_TOLERANCE:
                raise InputError(
                    "Command and measured displacement seem to have different units",
                    value=f"a measured displacement of {ratio:.4g} times the command, as if one were in "
                    f"{units}",
                    remedy="State the unit in the column's name (measured_mm), or convert the column",
                    where=name,
                )


def warn_of_signal(recording: Recording, tracking: TrackingIndex, frequency: float) -> Iterator[str]:
    """Say where a recording is too short, coarse or noisy for its structure; `frequency` [Hz]."""
    periods = recording.duration * frequency
    if periods < _FEW_PERIODS:
        yield (
            f"The test is short: {significant(periods, 2)} periods of the structure. "
            "Give the whole recording."
        )
    samples = 1.0 / (recording.time_step * tracking.plain.equivalent_frequency)
    if samples < _FEW_SAMPLES:
        yield (
            f"The test is sampled coarsely: {significant(samples)} samples in a period. "
            "Record at a higher rate."
        )
    noise = float(np.sqrt(max(tracking.noise_share**2 - tracking.unexplained_share**2, 0.0)))
    if noise > _NOISY:
        yield (
            f"The test is noisy: {percent(noise, decimals=1)} of the measured displacement is unrelated "
            "to the command. Use a sensor with less noise, or drive the specimen further."
        )


class RunningSign:
    """Sign of the measured displacement against its command while a test runs, by actuators."""

    def __init__(self) -> None:
        self._size, self._sums, self._products = 0, np.zeros((2, 1)), np.zeros((2, 2, 1))

    def add(self, command: Array, measured_displacement: Array) -> None:
        """Add the next samples, shape (k,) or (p, k)."""
        rows = np.stack([np.atleast_2d(command), np.atleast_2d(measured_displacement)])
        self._size += rows.shape[2]
        self._sums = self._sums + rows.sum(axis=2)
        self._products = self._products + np.einsum("apk,bpk->abp", rows, rows)

    def is_reversed(self, frequency: float) -> bool:
        """Whether one of them runs against its command, which no delay below half a period [Hz] makes."""
        if 2.0 * frequency * _LONGEST_REACTION >= 1.0 or not self._size:
            return False
        means = self._sums / self._size
        covariance = self._products / self._size - means * means[:, np.newaxis]
        size = np.sqrt(np.maximum(covariance[0, 0] * covariance[1, 1], 0.0))
        return bool((covariance[0, 1] < _OPPOSITE * size).any())


def _moving(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(values - values.mean(), dtype=np.float64)
