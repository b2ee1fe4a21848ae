"""Elastic stops on both sides: linear ones, and rounded bodies whose force grows with the power 1.5."""

import numpy as np
import pytest
from discrepancy.test_specimen_forms import STIFFNESS, write_tests

from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.block_diagnosis import Verdict
from reliab.effects.general.general_terms import ElasticStops
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.frame import Specimen

TIME = np.arange(0.0, 3.0, 0.002)
DISPLACEMENT = 0.1 * np.sin(2.0 * np.pi * TIME)


@pytest.mark.parametrize(("power", "middle"), [(1.0, 0.0), (1.5, 0.0), (1.0, 0.02)])
def test_a_stop_is_silent_within_its_clearance_and_grows_with_the_power_beyond(power, middle):
    stops = ElasticStops(stiffness_n_per_m=2000.0, clearance_m=0.04, power=power, middle_m=middle)
    test = HybridTest(specimen=Specimen(stiffness=1000.0), effects=(stops,))
    place = DISPLACEMENT - middle
    excess = np.maximum(np.abs(place) - 0.04, 0.0) / 0.04
    reference = 1000.0 * DISPLACEMENT + 2000.0 * 0.04 * np.sign(place) * excess**power
    np.testing.assert_allclose(
        load(test, Motion3.interpolate(DISPLACEMENT, TIME[1])), reference, rtol=1e-9, atol=1e-9
    )
    assert (excess > 0.0).sum() > 100


@pytest.mark.slow
def test_hertzian_stops_are_told_in_these_words_and_given_no_other_name(tmp_path):
    peak = 0.0

    def stopped(displacement):
        nonlocal peak
        peak = peak or np.abs(displacement).max()
        excess = np.maximum(np.abs(displacement) / (0.4 * peak) - 1.0, 0.0)
        return STIFFNESS * (displacement + 0.5 * 0.4 * peak * np.sign(displacement) * excess**1.5)

    diagnosis = diagnose(write_tests(tmp_path, f"stiffness_n_per_m = {STIFFNESS}", stopped))
    assert diagnosis.verdict is Verdict.UNKNOWN_EFFECT
    assert diagnosis.effects == ()
    assert "stops" in diagnosis.unknown.description
    assert diagnosis.gap.after < 0.1 * diagnosis.gap.before
