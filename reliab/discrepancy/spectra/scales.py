"""Typical sizes of motion and force in a campaign; bounds, priors and starts are multiples of them."""

from collections.abc import Sequence

import numpy as np

from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.spectra.smoothing import highest_frequency, smoothed_motion
from reliab.effects import Scales
from reliab.errors import InputError
from reliab.simulation.hybrid_test import Motion3


def motions_of(campaign: Campaign) -> tuple[Motion3, ...]:
    """Motion of the piston in every test from the channels: the command, else the smoothed reading."""
    highest = highest_frequency(campaign.rate, campaign.structure)
    return tuple(_motion(test, campaign.step, highest) for test in campaign.tests)


def _motion(test: MeasuredTest, step: float, highest: float) -> Motion3:
    if Channel.COMMAND in test.channels:
        return Motion3.through(test.channels[Channel.COMMAND], step)
    return smoothed_motion(test.channels[Channel.MEASURED], step, highest)


def scales_of(campaign: Campaign, motions: Sequence[Motion3]) -> Scales:
    """Peaks of the motion and the force over the tests that are not held out."""
    kept = [k for k, test in enumerate(campaign.tests) if not test.held_out]
    centred = [motions[k].values - [[motions[k].values[0].mean()], [0.0], [0.0]] for k in kept]
    peaks = np.max([np.quantile(np.abs(history), 0.9995, axis=1) for history in centred], axis=0)
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
        force=_force(campaign, kept, float(peaks[0])),
        duration=max(campaign.tests[k].size for k in kept) * campaign.step,
    )


def _force(campaign: Campaign, kept: Sequence[int], displacement: float) -> float:
    if Channel.FORCE in campaign.channels:
        forces = [campaign.tests[k].channels[Channel.FORCE] for k in kept]
        peak = max(float(np.abs(force - np.median(force)).max()) for force in forces)
    else:
        specimen = campaign.nominal.specimen
        peak = 0.0 if specimen is None else specimen.stiffness * displacement
    return peak if peak > 0.0 else 1.0
