"""The motion behind the recorded channels of a campaign, and its peaks."""

from collections.abc import Sequence

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.effects.effect import Scales
from reliab.signals.wiener import smooth_displacement
from reliab.simulation.hybrid_test.open_loop import Motion3
from reliab.structures.structure import Structure

HIGHEST_SIGNAL = 45.0
"""Highest frequency [Hz] at which the test of a structure of some hertz may hold a signal."""

_HARMONICS = 5.0  # of a structure, at which a stiffness that grows with the square still answers
_LARGEST_SHARE = 0.4  # of the sampling rate


def highest_frequency(rate: float, structure: Structure | None = None) -> float:
    """Highest frequency [Hz] at which a test may hold a signal; above it is noise.

    `rate` [Hz].
    Returns 45 Hz, or five times the natural frequency, but no more than the sampling rate allows.

    >>> highest_frequency(1024.0)
    45.0
    >>> highest_frequency(1024.0, Structure(frequency=20.0, damping_ratio=0.02))
    100.0
    """
    natural = 0.0 if structure is None else structure.frequency
    return min(max(HIGHEST_SIGNAL, _HARMONICS * natural), _LARGEST_SHARE * rate)


def smooth_motion(displacement: Array, step: float, highest: float) -> Motion3:
    """Motion behind a noisy displacement.

    `displacement` [m]; `step` [s]; `highest` [Hz].
    """
    return Motion3.interpolate(smooth_displacement(displacement, step, highest), step)


def motions_of(campaign: Campaign) -> tuple[Motion3, ...]:
    """Motion of the piston in every test from the channels: the command, else the smoothed reading."""
    highest = highest_frequency(campaign.rate, campaign.structure)
    return tuple(_piston_in(test, campaign.step, highest) for test in campaign.tests)


def _piston_in(test: MeasuredTest, step: float, highest: float) -> Motion3:
    if Channel.COMMAND in test.channels:
        return Motion3.interpolate(test.channels[Channel.COMMAND], step)
    return smooth_motion(test.channels[Channel.MEASURED], step, highest)


def scales_of(campaign: Campaign, motions: Sequence[Motion3]) -> Scales:
    """Peaks of the motion and the force over the tests that are not held out."""
    fitted_tests = [k for k, test in enumerate(campaign.tests) if not test.held_out]
    centred_motions = [
        motions[k].values - [[motions[k].values[0].mean()], [0.0], [0.0]] for k in fitted_tests
    ]
    peaks = np.max([np.quantile(np.abs(history), 0.9995, axis=1) for history in centred_motions], axis=0)
    if not peaks.min() > 0.0:
        raise InputError(
            "The displacement must move in at least one test that is not held out",
            value="a constant",
            remedy="Check that the column holds the recording, in metres",
        )
    return Scales(
        displacement=float(peaks[0]),
        velocity=float(peaks[1]),
        acceleration=float(peaks[2]),
        force=_peak_force(campaign, fitted_tests, float(peaks[0])),
        duration=max(campaign.tests[k].size for k in fitted_tests) * campaign.step,
    )


def _peak_force(campaign: Campaign, fitted_tests: Sequence[int], displacement: float) -> float:
    if Channel.FORCE in campaign.channels:
        forces = [campaign.tests[k].channels[Channel.FORCE] for k in fitted_tests]
        peak = max(float(np.abs(force - np.median(force)).max()) for force in forces)
    else:
        specimen = campaign.nominal.specimen
        peak = 0.0 if specimen is None else specimen.stiffness * displacement
    return peak if peak > 0.0 else 1.0
