"""Command and measured displacement in two units, and what is no matter of units."""

import numpy as np
import pytest

from reliab.assessment.plausibility import require_plausible
from reliab.core.errors import InputError
from reliab.recordings.recording import Recording

STEP = 0.01
TIME = STEP * np.arange(4000)
COMMAND = np.sin(2.0 * np.pi * TIME) * np.sin(np.pi * TIME / TIME[-1]) ** 2


def recording(factor, late=0.02):
    measured_displacement = factor * np.interp(TIME - late, TIME, COMMAND, left=0.0)
    return Recording(command=COMMAND, measured=measured_displacement, time_step=STEP, name="test.csv")


@pytest.mark.parametrize(
    ("factor", "units"),
    [
        (1000.0, "millimetres and the other in metres"),
        (1e-3, "millimetres and the other in metres"),
        (1.05 / 100.0, "centimetres and the other in metres"),
        (0.95 * 25.4, "millimetres and the other in inches"),
        (2.54, "centimetres and the other in inches"),
        (1.0 / 12.0, "inches and the other in feet"),
    ],
)
def test_two_units_are_told_by_their_ratio(factor, units):
    with pytest.raises(
        InputError, match=f"different units; found .* times the command, as if one were in {units}"
    ):
        require_plausible(recording(factor))


@pytest.mark.parametrize("factor", [0.5, 1.0, 1.3, 5.0, 100.0 * 1.2])
def test_other_ratios_are_no_units(factor):
    require_plausible(recording(factor))


def test_a_rig_that_is_so_late_that_it_attenuates_has_no_wrong_unit():
    """A quarter of a period late, the two are not alike enough for their sizes to be compared."""
    require_plausible(recording(2.54, late=0.25))
    with pytest.raises(InputError, match="different units"):
        require_plausible(recording(2.54, late=0.05))


def test_partly_following_force_has_no_wrong_unit():
    noise = np.random.default_rng(3).standard_normal(TIME.size)
    second = np.convolve(noise, np.hanning(50), "same")
    second *= 0.5 * np.linalg.norm(COMMAND) / np.linalg.norm(second)
    measured_displacement = (
        2.54 / 1.118 * (COMMAND + second)
    )  # 2.54 times as large in all, with a correlation of 0.9
    require_plausible(
        Recording(command=COMMAND, measured=measured_displacement, time_step=STEP, name="test.csv")
    )
