"""A line in what a model leaves: its frequency, pickup of the mains, slow drifts, and what is too short."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.fitting.screening import line_terms
from reliab.discrepancy.segment import Segment

RATE, SIZE = 256.0, 2560
TIME = np.arange(SIZE) / RATE


def terms(*lines, block=Block.SPECIMEN, size=SIZE, highest=110.0):
    """Terms for white noise of power one with sines of given frequencies and power."""
    segment = Segment(test=0, begin=0, end=size, rate=RATE, highest=highest)
    rows = np.random.default_rng(4).standard_normal(2 * segment.bins - 1)
    spacing = segment.frequency[1] - segment.frequency[0]
    for frequency, power in lines:
        place = round(float((frequency - segment.frequency[0]) / spacing))
        rows[place] = rows[segment.bins + place - 1] = np.sqrt(power)
    problem = SimpleNamespace(segments=(segment,), block=SimpleNamespace(rate=RATE, block=block))
    return line_terms(problem, SimpleNamespace(residual=rows))


@pytest.mark.parametrize("frequency", [0.5, 3.0, 17.0, 33.3, 101.0])
def test_the_strongest_line_gives_its_frequency(frequency):
    for block in (Block.SPECIMEN, Block.ACTUATOR):
        (result,) = terms((frequency, 60.0), (frequency + 5.0, 40.0), block=block)
        assert result.parameters[-1].typical == pytest.approx(frequency, rel=1e-3)
        assert result.block is block


@pytest.mark.parametrize("frequency", [50.0, 60.0, 76.0, 106.0])
def test_harmonics_of_the_mains_are_pickup_also_where_they_are_folded(frequency):
    """At 256 Hz, 180 Hz appears at 76 Hz, and 150 Hz at 106 Hz."""
    assert terms((frequency, 400.0)) == ()


def test_drifts_and_noise_are_no_lines():
    assert terms() == ()
    assert terms((0.1, 400.0)) == ()
    assert terms((17.0, 20.0)) == ()
    assert terms((17.0, 30.0)) != ()


@pytest.mark.parametrize(("place", "line"), [(1, False), (2, False), (3, True)])
def test_a_line_is_more_than_two_frequencies_of_the_segment_from_zero(place, line):
    """What swings once or twice within a segment cannot be told from a drift."""
    assert bool(terms((place * RATE / 1280.0, 400.0), size=1280)) is line


@pytest.mark.parametrize(("highest", "bins"), [(15.0, 2), (25.0, 3), (35.0, 4)])
def test_four_frequencies_can_hold_a_line_and_three_cannot(highest, bins):
    segment = Segment(test=0, begin=0, end=26, rate=RATE, highest=highest)
    assert segment.bins == bins
    assert bool(terms((segment.frequency[-1], 60.0), size=26, highest=highest)) is (bins > 3)
