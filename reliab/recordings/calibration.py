"""What two displacement channels do to one motion: skew, relative scale, hysteresis, resolution and noise.

Both channels record the same motion x(t), in a test made for it: an actuator without a specimen, or one
signal on both channels. The measured one then reads

    y(t) = offset + drift t + s [x − Σⱼ wⱼ stop(x; rⱼ)](t − δ) + noise,

with the skew δ, the scale s and a hysteresis of plays (Prandtl–Ishlinskii: x − stop(x; r) is a play of half
width r). For a given δ this is linear, with weights wⱼ that are not negative; δ minimises what is left.
Standard deviations are those of estimates from stretches of the test.
"""

import re
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.core.plain_values import PlainResult
from reliab.core.significant_digits import percent
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI
from reliab.recordings.behaviour import white_noise
from reliab.recordings.recording import Recording
from reliab.signals.filters import filter_symmetrically, low_pass
from reliab.signals.noise import converter_step

_RADII: Array = np.geomspace(3e-4, 0.05, 32)  # half widths of the plays over half the range of the motion
_STRETCHES = 8  # each gives an estimate of its own
_SPACING, _SKEWS = 1.25e-3, 40  # s and their number on both sides, about which skews are looked for
_LOCKED_SHARE = 0.01  # of the command's range: a measured channel that moves less is locked
_LEAST_CORRELATION = 0.9
_ALWAYS_LEFT = 3e-4  # of half the range
_MODEL_MARGIN = 1.3  # times its noise: what is left where the channels hold more than the model
_HARMONICS = 6.0  # of the motion's highest frequency, by which a play shows itself
_SAMPLES_OF_EDGE = 12.0  # in a period of the highest frequency that passes
_MOST_SAMPLES, _FEW_SAMPLES = 8_000, 1_000  # of an estimate, and of where to look for it
_NOISE_MARGIN = 30.0  # times the mean power of the noise: no noise reaches it
_ENERGY_SHARE = 1.0 - 1e-9  # of the command's energy, which the filter against its noise lets through
_SHORTEST_REST = 0.2  # s
_STILL = 1e-4  # of the command's range
_WINDOW = 0.06  # s, over which the path between rests is averaged
# what the filter and interpolation may add, seen on simulated calibrations
_SKEW_TOLERANCE, _SCALE_TOLERANCE, _HYSTERESIS_TOLERANCE = 0.03, 3e-5, 0.03
_SHARE_UNSURE, _LEAST_UNSURE = 0.3, 5e-4
_FEWEST_LEVELS = 3  # of rests in steps
_SHARE_OF_RESTS = 0.4

_UNSURE = (("skew_ms", "skew_sd_ms"), ("scale", "scale_sd"), ("hysteresis", "hysteresis_sd"))
_PLAIN = ("resolution_m", "noise_m", "command_noise_m")
_CALIBRATION_TABLE = re.compile(r"^\[calibration\].*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)

_HOLDS_DELAY = (
    "The skew includes the actuator's delay, which these two channels cannot show apart: give "
    "`actuator_delay`, unless you fed one signal to both channels."
)
_LOCKED_NOTE = "The measured channel does not move, so that this test shows only its noise and resolution."
_ACTUATOR_MOVES = (
    "The measured displacement also contains the dynamics of the actuator. Scale and hysteresis come from "
    "the samples at rest; the skew cannot be determined."
)


@dataclass(frozen=True, kw_only=True)
class ChannelCalibration(PlainResult):
    """What the measured channel adds to a motion that the command's channel records as well."""

    # Time by which the measured channel is late against the command's [ms]; None where it does not follow
    skew_ms: StatedValue | None
    # Reading of the measured channel over that of the command's [-]; None where it did not move
    scale: StatedValue | None
    # Difference of the readings at one position that is reached from either side, over the range of the
    # motion [-]
    hysteresis: StatedValue | None
    noise_m: float  # noise_m, command_noise_m: RMS noise of the measured and of the command's channel [m]
    command_noise_m: float
    resolution_m: float  # Step between readings of the measured channel [m]; 0 where there is none
    notes: tuple[str, ...] = ()  # What limits these statements, in sentences


def calibrate_channels(
    recording: Recording, *, actuator_delay_ms: StatedValue | None = None
) -> ChannelCalibration:
    """Measure what the measured channel adds to a motion that both channels record.

    The measured displacement of the test is the command but for the channels: sines, sweeps or steps with
    rests of an actuator without a specimen, or one signal on both channels. With a locked actuator only noise
    and resolution follow. `actuator_delay_ms` is taken off the lag between the channels. Refused is a
    measured displacement that moves otherwise than the command, and a test that never rests although an
    actuator's own motion is in it.

    >>> time = np.arange(0.0, 20.0, 0.004)
    >>> command, late = 0.02 * np.sin(6.0 * time), 0.02 * np.sin(6.0 * (time - 4e-4))
    >>> measured = calibrate_channels(Recording(command=command, measured=1.01 * late, time_step=0.004))
    >>> round(measured.skew_ms.value, 3), round(measured.scale.value, 4)
    (0.4, 1.01)
    """
    noise, command_noise = white_noise(recording.measured), white_noise(recording.command)
    resolution = converter_step(recording.measured)
    calibration = ChannelCalibration(
        skew_ms=None,
        scale=None,
        hysteresis=None,
        noise_m=noise,
        command_noise_m=command_noise,
        resolution_m=resolution,
        notes=(_LOCKED_NOTE,),
    )
    if np.ptp(recording.measured) < _LOCKED_SHARE * np.ptp(recording.command):
        return calibration
    _require_one_motion(recording)
    rests = _rests(recording, command_noise)
    estimate = _estimate_at_rest(recording, rests) if rests else None
    channels = _Channels(recording, rests, None if estimate is None else estimate.weights)
    white = float(np.linalg.norm([noise, command_noise, resolution / np.sqrt(12.0)]))
    skew, scale, hysteresis, remainder = channels.estimate()
    if remainder > _MODEL_MARGIN * channels.noise_gain * white + _ALWAYS_LEFT * channels.half_range:
        if estimate is None:
            raise _never_rests(recording, remainder / channels.half_range)
        unsure = StatedValue(estimate.hysteresis.value, _unsure(estimate.hysteresis))
        return replace(calibration, scale=estimate.scale, hysteresis=unsure, notes=(_ACTUATOR_MOVES,))
    deviations = channels.deviations(skew, scale, hysteresis)
    delay = actuator_delay_ms or StatedValue(0.0)
    deviation = float(np.hypot(MILLI * deviations[0], delay.deviation))
    return replace(
        calibration,
        skew_ms=StatedValue(MILLI * skew - delay.value, deviation),
        scale=estimate.scale if estimate else StatedValue(scale, float(deviations[1])),
        hysteresis=estimate.hysteresis if estimate else StatedValue(hysteresis, float(deviations[2])),
        notes=() if actuator_delay_ms else (_HOLDS_DELAY,),
    )


def _never_rests(recording: Recording, remainder: float) -> InputError:
    return InputError(
        f"This looks like a real test: {percent(remainder, decimals=2)} of the motion's amplitude is neither "
        "skew, scale, hysteresis nor noise",
        remedy=f"Feed one signal to both channels, or move in steps with rests above {_SHORTEST_REST:g} s",
        where=recording.name,
    )


def _unsure(hysteresis: StatedValue) -> float:
    """Deviation of a hysteresis [-] whose path between rests is the actuator's, which overshoots."""
    return float(np.linalg.norm([hysteresis.deviation, _SHARE_UNSURE * hysteresis.value, _LEAST_UNSURE]))


def calibration_in_toml(calibration: ChannelCalibration, description: str, source: str) -> str:
    """Write a calibration as the table of a file `channels.toml`, after what the file states of channels.

    `description`: content of such a file, of which a former calibration is left out; may be empty; `source`:
    from what it was measured, for a comment.

    >>> locked = ChannelCalibration(
    ...     skew_ms=None, scale=None, hysteresis=None, noise_m=2e-6, command_noise_m=0.0, resolution_m=0.0
    ... )
    >>> print(calibration_in_toml(locked, "", "locked.csv"))
    [calibration]  # measured by `reliab calibrate` from locked.csv
    resolution_m = 0
    noise_m = 2e-06
    command_noise_m = 0
    <BLANKLINE>
    """
    printable = "".join(character for character in source if character.isprintable())
    lines = [f"[calibration]  # measured by `reliab calibrate` from {printable}"]
    for name, deviation in _UNSURE:
        value = getattr(calibration, name)
        if value is not None:
            lines += [f"{name} = {value.value:.6g}", f"{deviation} = {value.deviation:.4g}"]
    lines += [f"{name} = {getattr(calibration, name):.6g}" for name in _PLAIN]
    remaining = _CALIBRATION_TABLE.sub("", description).rstrip()
    return "\n".join([*([remaining, ""] if remaining else []), *lines, ""])


def _require_one_motion(recording: Recording) -> None:
    correlation = float(np.corrcoef(recording.command, recording.measured)[0, 1])
    if correlation < _LEAST_CORRELATION:
        raise InputError(
            f"Command and measured displacement do not record one motion: correlation {correlation:.2f}",
            remedy="Feed one signal to both channels, or move the actuator slowly and without a specimen",
            where=recording.name,
        )


class _Channels:
    """The two channels of a test, with the plays of its motion, without noise above the motion."""

    def __init__(self, recording: Recording, rests: list[NDArray[np.intp]], weights: Array | None) -> None:
        rate = 1.0 / recording.time_step
        edge, coefficients = _filter_of(recording.command, rate)
        motion = _flatten_rests(filter_symmetrically(recording.command, coefficients), rests)
        self.half_range = 0.5 * float(np.ptp(motion))
        stops = _stops(motion, self.half_range)
        if weights is not None:
            motion, stops = motion - weights @ stops, stops[:0]
        self.radii: Array = self.half_range * _RADII[: len(stops)]
        self.noise_gain = float(np.linalg.norm(coefficients))
        # near its ends the filtered motion is a guess, and the plays have not turned yet
        full_overlap = slice(coefficients.size // 2, motion.size - coefficients.size // 2)
        thinning = max(int(rate / (_SAMPLES_OF_EDGE * edge)), 1)
        rows = np.stack(
            [filter_symmetrically(values, coefficients) for values in (recording.measured, *stops)]
        )
        self.time_step = recording.time_step
        self.times = np.float64(recording.time_step) * np.arange(motion.size)[full_overlap][::thinning]
        self.measured = rows[0][full_overlap][::thinning]
        basis = np.vstack([motion, rows[1:]]).T[full_overlap][::thinning]
        self.path = scipy.interpolate.make_interp_spline(self.times, basis)

    def estimate(self) -> tuple[float, float, float, float]:
        """Estimate skew [s], scale, hysteresis and the RMS of what is left [m]."""
        samples = np.arange(self.times.size)
        skews = _SPACING * np.arange(-_SKEWS, _SKEWS + 1)
        thin_samples = samples[:: 1 + samples.size // _FEW_SAMPLES]
        remainders = np.array([self._fit(thin_samples, skew)[2] for skew in skews])
        lowest = sorted(scipy.signal.argrelmin(remainders)[0], key=remainders.__getitem__)[:3]
        near = skews[lowest or [int(remainders.argmin())]]
        return min((self._refine(samples, float(skew)) for skew in near), key=lambda values: values[3])

    def deviations(self, *values: float) -> Array:
        """Return standard deviations of skew [s], scale and hysteresis, by estimates from stretches."""
        parts = np.array_split(np.arange(self.times.size), _STRETCHES)
        estimates = np.array([self._refine(part, values[0])[:3] for part in parts])
        # weights that are not negative bias the estimates, those of stretches √8 times as much
        biases = (estimates.mean(axis=0) - values) / (np.sqrt(_STRETCHES) - 1.0)
        scatter = estimates.std(axis=0, ddof=1) / np.sqrt(_STRETCHES)
        floors = np.array(
            [_SKEW_TOLERANCE * self.time_step, _SCALE_TOLERANCE, _HYSTERESIS_TOLERANCE * values[2]]
        )
        return np.asarray(np.linalg.norm([scatter, biases, floors], axis=0))

    def _refine(self, samples: NDArray[np.intp], near: float) -> tuple[float, float, float, float]:
        part = samples[:: 1 + samples.size // _MOST_SAMPLES]
        skew = scipy.optimize.minimize_scalar(
            lambda skew: self._fit(part, skew)[2],
            bounds=(near - _SPACING, near + _SPACING),
            method="bounded",
            options={"xatol": 1e-8},
        ).x
        scale, weights, remainder = self._fit(part, float(skew))
        return float(skew), scale, float(weights @ _RADII[: weights.size]), remainder

    def _fit(self, samples: NDArray[np.intp], skew: float) -> tuple[float, Array, float]:
        """Fit scale [-] and weights of the plays; returns them with the RMS of what is left [m]."""
        shifted_times = self.times[samples] - skew  # beyond its ends the path is unknown
        inner_samples = samples[(shifted_times >= self.times[0]) & (shifted_times <= self.times[-1])]
        times = self.times[inner_samples]
        basis = self.path(times - skew)
        return _fit_plays(times, basis[:, 0], basis[:, 1:], self.measured[inner_samples], self.radii)


def _fit_plays(
    times: Array, motion: Array, stops: Array, reading: Array, radii: Array
) -> tuple[float, Array, float]:
    """Fit offset, drift, scale and plays to a reading [m], shape (n,); stops [m] of shape (n, radii)."""
    free, triangle = np.linalg.qr(np.stack([np.ones_like(times), times, motion], axis=1))
    reading_products, play_products = free.T @ reading, -free.T @ stops
    plays = (-stops - free @ play_products) / radii  # columns of one size
    remainder = reading - free @ reading_products
    if not radii.size:
        scale = float(np.linalg.solve(triangle, reading_products)[2])
        return scale, radii, float(np.sqrt(np.mean(remainder**2)))
    root = scipy.linalg.cholesky(plays.T @ plays + 1e-12 * times.size * np.eye(radii.size))
    target = scipy.linalg.solve_triangular(root, plays.T @ remainder, trans="T")
    weights = scipy.optimize.nnls(root, target)[0]
    scale = float(np.linalg.solve(triangle, reading_products - play_products @ (weights / radii))[2])
    rms = float(np.sqrt(np.mean((remainder - plays @ weights) ** 2)))
    return scale, weights / radii / scale, rms


@dataclass(frozen=True, kw_only=True, eq=False)
class _RestEstimate:
    scale: StatedValue  # [-]
    hysteresis: StatedValue  # [-]
    weights: Array  # of the plays [-], shape (radii,)


def _estimate_at_rest(recording: Recording, rests: list[NDArray[np.intp]]) -> _RestEstimate:
    """Estimate scale and plays from the second halves of the rests of a test, by the path between them."""
    command, reading = (
        np.array([values[stretch].mean() for stretch in rests])
        for values in (recording.command, recording.measured)
    )
    half_range = 0.5 * float(np.ptp(recording.command))
    window = np.hanning(max(round(_WINDOW / recording.time_step), 1) | 1)  # steps do not ring in it
    path = _flatten_rests(filter_symmetrically(recording.measured, window / window.sum()), rests)
    stops = _stops(path, half_range)[:, [stretch[-1] for stretch in rests]].T
    times = np.array([stretch.mean() for stretch in rests])

    def estimate(mask: NDArray[np.bool_]) -> tuple[float, Array]:
        return _fit_plays(times[mask], command[mask], stops[mask], reading[mask], half_range * _RADII)[:2]

    places = np.arange(len(rests)) % _STRETCHES
    leave_one_out = [estimate(places != place) for place in range(_STRETCHES)]
    jackknife = np.std([(scale, float(weights @ _RADII)) for scale, weights in leave_one_out], axis=0)
    deviations = jackknife * np.sqrt(_STRETCHES - 1.0)
    scale, weights = estimate(places >= 0)
    hysteresis = float(weights @ _RADII)
    return _RestEstimate(
        scale=StatedValue(scale, float(np.hypot(deviations[0], _SCALE_TOLERANCE))),
        hysteresis=StatedValue(
            hysteresis, float(np.hypot(deviations[1], _HYSTERESIS_TOLERANCE * hysteresis))
        ),
        weights=weights,
    )


def _filter_of(command: Array, rate: float) -> tuple[float, Array]:
    """Design the filter that lets the command's motion through [Hz], shape (odd,)."""
    size = command.size
    spectrum = np.fft.rfft((command - command.mean()) * scipy.signal.windows.hann(size))
    noise_power = 0.375 * size * white_noise(command) ** 2
    energy = np.cumsum(np.maximum(np.abs(spectrum) ** 2 - _NOISE_MARGIN * noise_power, 0.0))
    edge = _HARMONICS * float(np.searchsorted(energy, _ENERGY_SHARE * energy[-1])) * rate / size
    return edge, low_pass(edge, rate)


def _stops(motion: Array, half_range: float) -> Array:
    """Answers of stops (elastic, perfectly plastic) of all radii to a motion [m], shape (radii, n)."""
    stops = np.zeros((_RADII.size, motion.size))
    _follow(motion, half_range * _RADII, stops)
    return stops


@compiled
def _follow(motion: Array, radii: Array, stops: Array) -> None:
    for j in range(radii.size):
        for i in range(1, motion.size):
            value = stops[j, i - 1] + motion[i] - motion[i - 1]
            stops[j, i] = min(max(value, -radii[j]), radii[j])


def _rests(recording: Recording, noise: float) -> list[NDArray[np.intp]]:
    """Find the samples of the second half of each rest of a command in steps; `noise` [m] is its own."""
    reach = max(round(0.25 * _SHORTEST_REST / recording.time_step), 1)
    command = np.pad(recording.command, reach, mode="edge")
    still = np.abs(command[2 * reach :] - command[: -2 * reach]) <= 8.0 * noise + _STILL * np.ptp(command)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    spans = zip(edges[::2], edges[1::2], strict=True)
    rests = [np.arange((begin + end) // 2, end) for begin, end in spans if end - begin >= 4 * reach]
    levels = {round(2.0 * float(recording.command[stretch].mean() / np.ptp(command)), 1) for stretch in rests}
    has_steps = still.mean() > _SHARE_OF_RESTS and len(levels) >= _FEWEST_LEVELS and len(rests) >= _STRETCHES
    return rests if has_steps else []


def _flatten_rests(motion: Array, rests: list[NDArray[np.intp]]) -> Array:
    """Take the noise from the rests of a motion, which would move its plays, shape (n,)."""
    flat = motion.copy()
    for stretch in rests:
        flat[stretch] = motion[stretch].mean()
    return flat
