"""The law of the experimental fraction against boundaries that are traced, and where it is refused."""

import numpy as np
import pytest
import xarray as xr

from reliab.core.errors import InputError
from reliab.criterion.experimental_share import carry_to_share, growth
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.tracking.boundary.first_order import first_order_ellipse


@pytest.mark.slow
def test_white_noise_has_the_growth_of_the_law():
    random = np.random.default_rng(7)
    excitation = Excitation(acceleration=random.normal(size=8_000), time_step=0.05)
    whole, part = (
        first_order_ellipse(
            excitation, Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=alpha)
        )
        for alpha in (1.0, 0.5)
    )
    assert part.amplitude / whole.amplitude == pytest.approx(float(growth(0.5, 0.05)), rel=0.1)


def test_carried_ellipses_are_near_those_that_are_traced():
    motions = synthetic_suite(count=2)
    whole, part = (
        trace_ellipses(
            motions,
            EllipseRequest(frequencies=(1.0,), damping_ratios=(0.02,), experimental_fractions=(alpha,)),
        )
        for alpha in (1.0, 0.5)
    )
    carried = carry_to_share(whole, 0.5)
    assert carried.attrs["experimental_fraction"] == 0.5
    assert "transferred" in carried.attrs["caution"]
    for name in ("a", "b"):
        ratio = (part[name] / carried[name]).values
        assert np.median(ratio) == pytest.approx(1.0, abs=0.05)
        assert carried[name].dims == whole[name].dims


def test_a_whole_structure_keeps_its_limits():
    np.testing.assert_array_equal(growth(1.0, [0.02, 0.05, 0.3]), 1.0)


@pytest.mark.parametrize(("share", "xi"), [(0.1, 0.02), (0.4, 0.05), (0.9, 0.1)])
def test_a_share_that_damping_outweighs_is_refused(share, xi):
    with pytest.raises(InputError, match="at least 10 ξ"):
        growth(share, xi)


@pytest.mark.parametrize("share", [0.0, 1.2, np.nan])
def test_what_is_no_share_is_refused(share):
    with pytest.raises(InputError, match="laboratory must be above 0"):
        growth(share, 0.02)


def test_ellipses_of_a_part_are_not_carried_again():
    ellipses = xr.Dataset(attrs={"experimental_fraction": 0.5})
    with pytest.raises(InputError, match="with all stiffness in the laboratory"):
        carry_to_share(ellipses, 0.4)
