"""Both horizontal components of one recording, from their parameters to samples.

White noise goes through a filter whose frequency varies in time, is modulated in amplitude, loses its
spurious long-period content, and comes to rest at its end.
"""

from collections.abc import Sequence
from math import ceil, cos, pi, sin
from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.motions.synthetic.filtered_noise import filter_frequency, filter_noise
from reliab.motions.synthetic.high_pass import high_pass, padding, settle
from reliab.motions.synthetic.modulation import fit_modulation
from reliab.motions.synthetic.parameters import ComponentParameters, RecordingParameters
from reliab.motions.synthetic.pulse import pulse_acceleration
from reliab.motions.synthetic.random_stream import RandomStream
from reliab.vocabulary import STANDARD_GRAVITY

TIME_STEP: Final = 0.01
"""Interval between samples [s]."""

_LENGTH: Final = 2.5
"""Length of the motion before filtering, in units of D0-95."""

_STILL: Final = 0.01
"""Part of its largest displacement below which a component is at rest, before and after the motion."""


def simulate_recording(
    parameters: RecordingParameters, magnitude: float, noises: Sequence[RandomStream]
) -> Array:
    """Simulate both components along the axes of the model, from rest to rest.

    Returns acceleration [m/s²] every 0.01 s, with the quiet time that the filter needs before and after.
    """
    components = (parameters.first, parameters.second)
    count = ceil(_LENGTH * max(component.strong_end for component in components) / TIME_STEP)
    quiet = padding(magnitude, TIME_STEP)
    times = TIME_STEP * np.arange(count, dtype=np.float64)
    strong = [_modulate_noise(*pair, times) for pair in zip(components, noises, strict=True)]
    motion = high_pass(np.pad(strong, ((0, 0), (quiet, quiet))), magnitude, TIME_STEP)
    intensities = np.array([component.arias_intensity for component in components])
    motion *= np.sqrt(intensities / _arias_intensity(motion))[:, np.newaxis]
    if parameters.pulse is not None:
        motion[0, quiet : quiet + count] += pulse_acceleration(parameters.pulse, times)
    return motion


def _modulate_noise(component: ComponentParameters, noise: RandomStream, times: Array) -> Array:
    modulation = fit_modulation(component)
    frequency = filter_frequency(component, modulation, times)
    process = filter_noise(noise.normals(times.size), frequency, component.bandwidth, TIME_STEP)
    return process * modulation(times)


def _arias_intensity(motion: Array) -> Array:
    intensities: Array = pi / (2.0 * STANDARD_GRAVITY) * TIME_STEP * np.sum(motion**2, axis=1)
    return intensities


def turned(motion: Array, angle: float) -> Array:
    """Turn two orthogonal components to the axes of an instrument.

    `motion` (2, n); `angle` [rad]; returns (2, n).

    >>> turned(np.array([[1.0], [0.0]]), pi / 6).round(3)
    array([[ 0.866],
           [-0.5  ]])
    """
    first, second = motion
    return np.stack([cos(angle) * first + sin(angle) * second, cos(angle) * second - sin(angle) * first])


def trim_quiet_ends(motion: Array) -> Array:
    """Cut off the quiet time before and after a motion, and bring what is left to rest.

    Both components are cut where the displacement of the first to move, and of the last to rest, is 1 % of
    its largest (Dabaghi & Der Kiureghian 2018); `settle` removes the small residual velocity and displacement
    after the cut.

    `motion` (2, n) [m/s²]; returns (2, m).
    """
    displacement = np.abs(np.cumsum(np.cumsum(motion, axis=1), axis=1))
    moving = (displacement > _STILL * displacement.max(axis=1, keepdims=True)).any(axis=0)
    first, last = np.flatnonzero(moving)[[0, -1]]
    return settle(motion[:, first : last + 1])
