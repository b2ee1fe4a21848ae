"""A test of one mass, stepped finely by its differential equation, and a play: nothing of the package."""

from dataclasses import dataclass

import numba
import numpy as np
import scipy


@dataclass(frozen=True, kw_only=True)
class SimulatedTest:
    """Channels on a common clock, and the true errors."""

    time_step: float
    command: np.ndarray
    measured: np.ndarray  # Without noise
    ground: np.ndarray
    force: np.ndarray  # Of a unit mass
    exact: np.ndarray
    rms: float
    mte: float


def simulate(
    *, frequency, damping_ratio, share=1.0, gain=1.0, delay=0.0, ground, time_step, fine=8, noise=0.0, seed=0
):
    """Simulate a linear specimen behind an actuator with a gain and a delay [s] (of fine steps).

    Central differences at `time_step/fine`; the exact response is stepped by the same rule.
    """
    step = time_step / fine
    omega = 2.0 * np.pi * frequency
    times = np.arange((ground.size - 1) * fine + 1) * step
    driven = scipy.interpolate.CubicSpline(np.arange(ground.size) * time_step, ground)(times)
    late = round(delay / step)
    command, measured_displacement = _step_loop(driven, omega, damping_ratio, share, gain, late, step)
    exact, _ = _step_loop(driven, omega, damping_ratio, share, 1.0, 0, step)
    error = measured_displacement - exact
    peak = np.abs(exact).max()
    measured_displacement, command, exact = (
        values[::fine] for values in (measured_displacement, command, exact)
    )
    read = measured_displacement + noise * measured_displacement.std() * np.random.default_rng(
        [seed, 1]
    ).standard_normal(measured_displacement.size)
    return SimulatedTest(
        time_step=time_step,
        command=command,
        measured=read,
        ground=ground,
        force=share * omega**2 * measured_displacement,
        exact=exact,
        rms=float(np.sqrt(np.mean(error**2)) / peak),
        mte=float(np.abs(error).max() / peak),
    )


def _step_loop(driven, omega, ratio, share, gain, late, step):
    """Responses of the structure, and of the actuator that follows it."""
    x = _march(driven, omega, ratio, share, gain, late, step)
    following_part = np.concatenate([np.zeros(late), x[: x.size - late]]) if late else x
    return x, gain * following_part


@numba.njit(cache=True)
def _march(driven, omega, ratio, share, gain, late, step):
    """March x'' + 2ξωx' + (1 − α)ω²x + αω²·k·x(t − τ) = −a by central differences."""
    x, v = np.zeros(driven.size), 0.0
    stiff = (1.0 - share) * omega**2
    own_value, damped_frame = share * omega**2 * gain, ratio * omega * step
    for i in range(driven.size - 1):
        back = x[i - late] if i >= late else 0.0
        undamped_frame = -driven[i] - stiff * x[i] - own_value * back
        v = ((1.0 - damped_frame) * v + step * undamped_frame) / (1.0 + damped_frame)
        x[i + 1] = x[i] + step * v
    return x


def earthquake(*, duration, time_step, seed, corner=8.0):
    """Broad-band ground motion with an envelope [m/s²]."""
    generator = np.random.default_rng(seed)
    size = int(duration / time_step)
    white = generator.standard_normal(size)
    shaped = scipy.signal.lfilter(*scipy.signal.butter(2, [0.1, corner], "band", fs=1.0 / time_step), white)
    time = np.arange(size) * time_step
    envelope = np.minimum(time / 3.0, 1.0) * np.exp(-np.maximum(time - 12.0, 0.0) / 5.0)
    motion = shaped * envelope
    return motion / np.abs(motion).max() * 3.0


def play(motion, width):
    """Readings of a sensor whose loop is as wide as a share of the span."""
    radius, reading = 0.5 * width * np.ptp(motion), [motion[0]]
    for place in motion[1:]:
        reading.append(min(max(reading[-1], place - radius), place + radius))
    return np.array(reading)
