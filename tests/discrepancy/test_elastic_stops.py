"""Elastic stops on both sides: linear ones, and rounded bodies whose force grows with the power 1.5."""

import numpy as np
import pytest
from discrepancy.test_specimen_forms import STIFFNESS, written

from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.block_diagnosis import Verdict
from reliab.effects.general.general_terms import ElasticStops
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.specimen import Specimen

TIME = np.arange(0.0, 3.0, 0.002)
MOVED = 0.1 * np.sin(2.0 * np.pi * TIME)


@pytest.mark.parametrize("power", [1.0, 1.5])
def test_a_stop_is_silent_within_its_clearance_and_grows_with_the_power_beyond(power):
    stops = ElasticStops(stiffness_n_per_m=2000.0, clearance_m=0.04, power=power)
    test = HybridTest(specimen=Specimen(stiffness=1000.0), effects=(stops,))
    beyond = np.maximum(np.abs(MOVED) - 0.04, 0.0) / 0.04
    expected = 1000.0 * MOVED + 2000.0 * 0.04 * np.sign(MOVED) * beyond**power
    np.testing.assert_allclose(
        load(test, Motion3.interpolate(MOVED, TIME[1])), expected, rtol=1e-9, atol=1e-9
    )
    assert (beyond > 0.0).sum() > 100


@pytest.mark.slow
def test_hertzian_stops_are_told_in_these_words_and_given_no_other_name(tmp_path):
    peak = 0.0

    def stopped(moved):
        nonlocal peak
        peak = peak or np.abs(moved).max()
        beyond = np.maximum(np.abs(moved) / (0.4 * peak) - 1.0, 0.0)
        return STIFFNESS * (moved + 0.5 * 0.4 * peak * np.sign(moved) * beyond**1.5)

    found = diagnose(written(tmp_path, f"stiffness_n_per_m = {STIFFNESS}", stopped))
    assert found.verdict is Verdict.UNKNOWN_EFFECT
    assert found.effects == ()
    assert "stops" in found.unknown.description
    assert found.gap.after < 0.1 * found.gap.before
