"""What effects do to the criterion, where it can be said beforehand."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.effect_shift import criterion_shift
from reliab.discrepancy.adding import shaking_of
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.effects.registry import find_effect
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.structure import Structure
from reliab.tracking.boundary.curves import Ellipse
from reliab.tracking.boundary.suite_boundary import motion_contours

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.03)


def shaken(seed, *, duration=20.0, step=0.01):
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, duration, step)
    return 3.0 * rng.standard_normal(t.size) * np.exp(-(((t - 0.3 * duration) / (0.2 * duration)) ** 2))


@pytest.fixture(scope="module")
def shaking():
    return [Excitation(acceleration=shaken(seed), time_step=0.01) for seed in range(3)]


def add_effect(name, *values):
    kind = find_effect(name)
    return HybridTest(structure=STRUCTURE, effects=(kind.from_values(np.array(values)),))


def test_without_effects_nothing_shifts(shaking):
    shift = criterion_shift(HybridTest(structure=STRUCTURE), shaking)
    assert shift == {"a": 1.0, "b": 1.0}


def test_lag_takes_its_time_off_the_remaining_delay(shaking):
    """Under one motion, √b is shortened by the time constant of a short lag."""
    loop = Loop(excitation=shaking[0], structure=STRUCTURE)
    delay_limit = 1e-3 * np.sqrt(Ellipse.fit(motion_contours(loop)[0]).b)
    shift = criterion_shift(add_effect("first_order_lag", 0.2 * delay_limit), shaking[:1])
    assert np.sqrt(shift["b"]) == pytest.approx(0.8, abs=0.03)
    assert 0.7 < shift["a"] < 1.0


def test_an_effect_beyond_the_threshold_leaves_no_criterion(shaking):
    shift = criterion_shift(add_effect("first_order_lag", 0.05), shaking)
    assert shift == {"a": 0.0, "b": 0.0}


@pytest.mark.slow
def test_dissipative_specimen_tolerates_more(shaking):
    """Viscous damping that doubles the damping ratio: a and b grow as its square, nearly."""
    damping = 2.0 * STRUCTURE.damping_ratio * STRUCTURE.circular_frequency
    shift = criterion_shift(add_effect("viscous_damping", damping), shaking)
    twice = Structure(frequency=1.0, damping_ratio=2.0 * STRUCTURE.damping_ratio)
    ratios = []
    for excitation in shaking:
        result = [
            Ellipse.fit(motion_contours(Loop(excitation=excitation, structure=model))[0])
            for model in (twice, STRUCTURE)
        ]
        ratios.append((result[0].a / result[1].a, result[0].b / result[1].b))
    low, high = np.min(ratios, axis=0), np.max(ratios, axis=0)
    assert 0.9 * low[0] < shift["a"] < 1.1 * high[0]
    assert 0.9 * low[1] < shift["b"] < 1.1 * high[1]


def test_ground_motions_are_needed():
    with pytest.raises(InputError, match="ground motions"):
        criterion_shift(HybridTest(structure=STRUCTURE), [])


def campaign(channels_of):
    tests = tuple(
        MeasuredTest(
            file=f"{k}", motion="", held_out=k == 2, channels=channels_of(shaken(k, step=1.0 / 256.0))
        )
        for k in range(3)
    )
    return Campaign(
        name="", structure=STRUCTURE, mass=1.0, actuator=None, specimen=None, rate=256.0, tests=tests
    )


def response(ground):
    return run_closed_loop(HybridTest(structure=STRUCTURE), ground, 1.0 / 256.0).measured


def test_recorded_ground_motions_are_taken():
    shaken_campaign = campaign(lambda ground: {Channel.GROUND: ground, Channel.MEASURED: response(ground)})
    result = shaking_of(shaken_campaign)
    assert len(result) == 3
    np.testing.assert_array_equal(result[1].acceleration, shaken_campaign.tests[1].channels[Channel.GROUND])


def test_motions_of_the_built_in_suite_reach_the_measured_displacement():
    plain = campaign(lambda ground: {Channel.COMMAND: response(ground), Channel.MEASURED: response(ground)})
    peak = max(np.ptp(test.channels[Channel.COMMAND]) / 2.0 for test in plain.tests)
    for excitation in shaking_of(plain):
        displacement = run_closed_loop(plain.nominal, excitation.acceleration, excitation.time_step).measured
        assert np.abs(displacement).max() == pytest.approx(peak)
