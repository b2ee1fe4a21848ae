"""Spectra of stretches of tests, from all samples and from a few of them."""

import numpy as np
import pytest

from reliab.discrepancy.segment import Segment

RATE = 1024.0
TIME = np.arange(4096) / RATE
MOTION = np.sin(2.0 * np.pi * 1.3 * TIME) + 0.3 * np.cos(2.0 * np.pi * 7.1 * TIME)


@pytest.mark.parametrize("thinning", [1, 2, 4])
@pytest.mark.parametrize(("begin", "end"), [(0, 2048), (512, 3072), (512, 4096)])
def test_a_stretch_cut_out_of_a_motion_has_the_same_spectrum_at_fewer_instants(begin, end, thinning):
    segment = Segment(test=0, begin=begin, end=end, rate=RATE, highest=25.0)
    spectrum = segment.spectrum(MOTION)
    difference = segment.coarse_spectrum(MOTION[::thinning], thinning) - spectrum
    assert np.abs(difference).max() < 1e-4 * np.sqrt(np.mean(np.abs(spectrum) ** 2))
