"""Ends of records that a model cannot predict.

At the start of a record that does not begin at rest the model forgets an unknown initial state. What an
integration demands at the end of a record moves the command after it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from reliab.discrepancy.campaign.campaign import Stretch
from reliab.simulation.hybrid_test import Motion3

_AT_REST = 0.1  # of the RMS of the velocity
_FIRST = 5  # samples
_REVERSALS = 3  # after which the motion has gone through a whole swing
_LARGEST_SHARE = 0.2  # of a record


def settled(
    stretches: Sequence[Stretch], motions: Sequence[Motion3], memory: float = 0.0
) -> tuple[Stretch, ...]:
    """Leave out the start of records that begin while the piston moves.

    Motion before the record leaves the rig in a state, of a lag or of a hysteresis, that is not recorded. The
    error of a simulation that starts without this state vanishes after one swing, that of an oscillator after
    its free vibration has died away.

    `memory` [s].
    """
    return tuple(
        replace(stretch, begin=_begin(motions[stretch.test], stretch.end, memory))
        if stretch.begin == 0
        else stretch
        for stretch in stretches
    )


def _begin(motion: Motion3, end: int, memory: float) -> int:
    velocity = motion.values[1][:end]
    usual = float(np.sqrt(np.mean(velocity**2)))
    if float(np.abs(velocity[:_FIRST]).mean()) < _AT_REST * usual:
        return 0
    moving = np.flatnonzero(np.abs(velocity) > _AT_REST * usual)
    signs = np.sign(velocity[moving])
    reversals = moving[1:][np.diff(signs) != 0.0]
    most = int(_LARGEST_SHARE * end)
    swing = int(reversals[_REVERSALS - 1]) if reversals.size >= _REVERSALS else most
    return min(max(swing, int(memory / motion.step)), most)


def answered(
    stretches: Sequence[Stretch], motions: Sequence[Motion3], unanswered: float
) -> tuple[Stretch, ...]:
    """Leave out the end of records whose output shows in the input only after it.

    `unanswered` [s].
    Returns the same parts; those that reach into this time end where it begins, unless they lie within it.
    """
    sizes = [motion.values.shape[1] for motion in motions]
    ends = [
        size - min(round(unanswered / motion.step), int(_LARGEST_SHARE * size))
        for size, motion in zip(sizes, motions, strict=True)
    ]
    return tuple(
        replace(stretch, end=min(stretch.end, ends[stretch.test]))
        if stretch.begin < ends[stretch.test]
        else stretch
        for stretch in stretches
    )
