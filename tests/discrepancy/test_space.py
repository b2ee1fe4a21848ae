"""What the parameters of a model may be."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest

from reliab.discrepancy.blocks.actuator import ActuatorBlock
from reliab.discrepancy.blocks.specimen import SpecimenBlock
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.segment import motions_of, scales_of
from reliab.effects.registry import find_effect


@pytest.fixture
def specimen_block(sample_campaigns):
    campaign = read_campaign(sample_campaigns / "rig_b")
    motions = motions_of(campaign)
    return SpecimenBlock(campaign, scales_of(campaign, motions), motions)


@pytest.mark.parametrize("name", ["viscous_damping", "added_mass"])
def test_no_more_is_missing_of_damping_and_mass_than_there_is(specimen_block, name):
    space = ModelSpace(specimen_block, (find_effect(name),))
    least = space.values(space.bounds[0])[space.places(find_effect(name))][0]
    specimen = specimen_block.nominal.specimen
    is_believed = {"viscous_damping": specimen.damping, "added_mass": specimen.mass}[name]
    assert least == pytest.approx(-is_believed)


@pytest.mark.parametrize(("lag", "remaining_delay"), [(0.004, 0.008), (0.02, 0.0)])
def test_an_added_lag_takes_its_delay_from_the_actuator_s(sample_campaigns, lag, remaining_delay):
    """A first-order lag 1/(1 + T s) is late by T at low frequencies; the actuator keeps the rest."""
    campaign = read_campaign(sample_campaigns / "rig_b")
    block = ActuatorBlock(campaign, scales_of(campaign, motions_of(campaign)))
    kind = find_effect("first_order_lag")
    base, space = ModelSpace(block, ()), ModelSpace(block, (kind,))
    place = [parameter.name for parameter in base.parameters].index("delay_s")
    is_known = base.values(np.zeros(base.size))
    is_known[place] = 0.012
    lagging = space.values(np.zeros(space.size))
    lagging[space.places(kind)] = lag
    with patch.object(ModelSpace, "_start", return_value=space.coordinates(lagging)):
        (start, *_) = space.starts(base, base.coordinates(is_known))
    assert space.values(start)[place] == pytest.approx(remaining_delay, abs=1e-6)


def test_each_start_of_an_added_effect_is_tried_and_nothing_twice_without_one(specimen_block):
    kind = find_effect("backlash")
    base, space = ModelSpace(specimen_block, ()), ModelSpace(specimen_block, (kind,))
    assert len(list(base.starts(base, np.zeros(base.size)))) == 1
    fresh = list(space.starts(base, np.zeros(base.size)))
    sizes = [space.values(start)[space.places(kind)][0] for start in fresh]
    starts = np.array(kind.parameters[0].starts)  # shares of the channel's own scale
    np.testing.assert_allclose(sizes, sizes[0] / starts[0] * starts)


def test_parameter_without_effect_at_one_has_its_own_start(specimen_block):
    kind = find_effect("excitation_scale")
    base, space = ModelSpace(specimen_block, ()), ModelSpace(specimen_block, (kind,))
    sizes = [space.values(start)[space.places(kind)][0] for start in space.starts(base, np.zeros(base.size))]
    assert kind.parameters[0].neutral == 1.0
    assert sizes == pytest.approx(kind.parameters[0].starts)


@pytest.mark.parametrize("factor", [0.5, -1.0, 1e9, -1e9])
def test_scaled_signed_parameter_stays_within_its_bounds(specimen_block, factor):
    signed, unsigned_effect = find_effect("cubic_stiffness"), find_effect("backlash")
    space = ModelSpace(specimen_block, (signed, unsigned_effect))
    place = space.places(signed).start
    begin = np.zeros(space.size)
    begin[place] = 0.25 * space.bounds[1][place]
    scaled_start = space.scale_size(begin, signed, factor)
    lower, upper = 0.9 * space.bounds[0][place], 0.9 * space.bounds[1][place]
    reference = {0.5: 0.5 * begin[place], -1.0: -begin[place], 1e9: upper, -1e9: lower}[factor]
    assert lower < 0.0 < upper
    assert scaled_start[place] == pytest.approx(reference)
    assert np.array_equal(np.delete(scaled_start, place), np.delete(begin, place))
    assert space.scale_size(begin, unsigned_effect, factor) is begin


def _exactly_fitted(block, name, value):
    """Deviation of an effect's only parameter where the data leave none."""
    kind = find_effect(name)
    space = ModelSpace(block, (kind,))
    values = space.values(np.zeros(space.size))
    values[space.places(kind)] = value
    exact = space.standard_deviations(space.coordinates(values), np.zeros((space.size, space.size)))
    return exact[space.places(kind)][0]


@pytest.mark.parametrize(("name", "spread"), [("time_step_error", 2e-5), ("excitation_scale", 1.2e-4)])
def test_simulations_differ_by_a_share_of_the_error_in_a_time_ratio(specimen_block, name, spread):
    """A scale is no better known than amplitudes are simulated; long records tell a clock far better."""
    assert _exactly_fitted(specimen_block, name, 1.2) == pytest.approx(spread, rel=1e-3)


@pytest.mark.parametrize("ratio", [1.0, 1.0 + 1e-6])
def test_a_ratio_of_times_is_no_better_known_than_the_phase_at_the_end_of_a_record(specimen_block, ratio):
    """A motion of 10 rad/s is simulated to 1e-4 rad: within 1000 rad of it to a tenth of a millionth."""
    scales = replace(specimen_block.scales, displacement=0.02, velocity=0.2, duration=100.0)
    specimen_block.scales = scales
    assert _exactly_fitted(specimen_block, "time_step_error", ratio) == pytest.approx(1e-7, rel=1e-4)
