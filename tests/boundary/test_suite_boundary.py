"""Boundaries of many motions traced together are those of each motion traced by itself."""

import numpy as np
import pytest

from reliab.core.vocabulary import Side
from reliab.motions.loading import load_motions
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.suite_boundary import motion_contours, suite_contours

LEVELS, SIDES = (0.05, 0.05, 0.15), (Side.LAG, Side.LEAD, Side.LAG)


def loops_under(motions, structure, window=(0.0, -1.0), engine=Engine.AUTOMATIC):
    return [
        Loop(
            excitation=Excitation(acceleration=m.acceleration, time_step=m.time_step, window=window),
            structure=structure,
            engine=engine,
        )
        for m in motions
    ]


def assert_same(loops, tolerance):
    together = suite_contours(loops, LEVELS, SIDES)
    for loop, contours in zip(loops, together, strict=True):
        for alone, contour in zip(motion_contours(loop, LEVELS, side=SIDES), contours, strict=True):
            np.testing.assert_allclose(contour.amplitude, alone.amplitude, rtol=tolerance)
            np.testing.assert_allclose(
                contour.delay,
                alone.delay,
                rtol=tolerance,
                atol=tolerance * np.abs(alone.delay).max(initial=0.0),
            )


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("frequency", "xi"), [(1.0, 0.02), (2.0, 0.05)])
def test_contours_are_those_of_each_motion(frequency, xi):
    motions = load_motions("synthetic")[:3]
    assert_same(loops_under(motions, Structure(frequency=frequency, damping_ratio=xi)), 2e-4)


def test_a_suite_may_hold_one_motion():
    assert_same(
        loops_under(load_motions("synthetic")[3:4], Structure(frequency=1.0, damping_ratio=0.05)), 2e-4
    )


@pytest.mark.slow
def test_contours_of_short_windows_and_of_a_chosen_engine_are_those_of_each_motion():
    motions = load_motions("synthetic")[:2]
    structure = Structure(frequency=1.0, damping_ratio=0.03)
    assert_same(loops_under(motions, structure, window=(4.0, 9.0)), 2e-4)
    late = suite_contours(loops_under(motions, structure, engine=Engine.DELAY), LEVELS[:1], SIDES[:1])
    assert all(contours[0].amplitude.size >= 11 for contours in late)


@pytest.mark.slow
def test_contours_are_those_of_each_real_motion(real_motions_folder):
    motions = load_motions(real_motions_folder)
    few = [motions[k] for k in range(0, len(motions), len(motions) // 4)]
    assert_same(loops_under(few, Structure(frequency=1.0, damping_ratio=0.05)), 2e-4)
