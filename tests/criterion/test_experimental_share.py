"""Shares of the stiffness in the laboratory: growth of limits, and criteria compared."""

import numpy as np
import pytest
import xarray as xr

from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.experimental_share import carry_to_share, growth
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.cells import Cells
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.sweep.labels import select_share
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.first_order import first_order_ellipse
from reliab.tracking.indices.response_error import relative_error


@pytest.mark.slow
def test_white_noise_has_the_growth_of_the_law():
    random = np.random.default_rng(7)
    excitation = Excitation(acceleration=random.normal(size=8_000), time_step=0.05)
    complete, part = (
        first_order_ellipse(
            excitation, Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=alpha)
        )
        for alpha in (1.0, 0.5)
    )
    assert part.amplitude / complete.amplitude == pytest.approx(float(growth(0.5, 0.05)), rel=0.1)


def test_carried_ellipses_are_near_traced_ones():
    motions = synthetic_suite(count=2)
    complete, part = (
        trace_ellipses(
            motions,
            EllipseRequest(frequencies=(1.0,), damping_ratios=(0.02,), experimental_fractions=(alpha,)),
        )
        for alpha in (1.0, 0.5)
    )
    carried = carry_to_share(complete, 0.5)
    assert carried.attrs["experimental_fraction"] == 0.5
    assert "transferred" in carried.attrs["caution"]
    for name in ("a", "b"):
        ratio = (part[name] / carried[name]).values
        assert np.median(ratio) == pytest.approx(1.0, abs=0.05)
        assert carried[name].dims == complete[name].dims


def test_a_whole_structure_keeps_its_limits():
    np.testing.assert_array_equal(growth(1.0, [0.02, 0.05, 0.3]), 1.0)


@pytest.mark.parametrize(("share", "xi"), [(0.1, 0.02), (0.4, 0.05), (0.9, 0.1)])
def test_share_outweighed_by_damping_is_refused(share, xi):
    with pytest.raises(InputError, match="at least 10 ξ"):
        growth(share, xi)


@pytest.mark.parametrize("share", [0.0, 1.2, np.nan])
def test_invalid_share_is_refused(share):
    with pytest.raises(InputError, match="laboratory must be above 0"):
        growth(share, 0.02)


def test_ellipses_of_a_part_are_not_carried_again():
    ellipses = xr.Dataset(attrs={"experimental_fraction": 0.5})
    with pytest.raises(InputError, match="with all stiffness in the laboratory"):
        carry_to_share(ellipses, 0.4)


def table_of(growths, xi=0.02):
    """Ellipses in a CSV table, those of each share larger than those of the whole by a factor."""
    rng = np.random.default_rng(3)
    bases = np.exp(rng.normal(size=(12, 2)) * 0.3) * (2e-4, 3.0)
    lines = [
        f"E{k}/1,1,{xi},{alpha},{g * a},{g * b}" for alpha, g in growths for k, (a, b) in enumerate(bases)
    ]
    return "\n".join(["motion,f,xi,alpha,a,b", *lines])


def criteria_of(ellipses):
    return [
        derive_criterion(select_share(ellipses, alpha), method="quantile")
        for alpha in ellipses["alpha"].values
    ]


def test_a_table_of_one_share_states_it(tmp_path):
    (tmp_path / "ellipses.csv").write_text(table_of([(0.5, 1.0)]))
    assert read_ellipses(tmp_path / "ellipses.csv").attrs["experimental_fraction"] == 0.5


def test_a_criterion_of_several_shares_is_refused(tmp_path):
    (tmp_path / "ellipses.csv").write_text(table_of([(0.5, 4.0), (1.0, 1.0)]))
    with pytest.raises(InputError, match="one share"):
        derive_criterion(read_ellipses(tmp_path / "ellipses.csv"), method="quantile")


def largest_errors(motions, structures, shares):
    """Largest error over the threshold of tests on the inscribed ellipses of α = 1, shape (cases, shares)."""
    angles = np.linspace(0.0, np.pi, 9)
    errors = []
    for f, xi in structures:
        request = EllipseRequest(frequencies=(f,), damping_ratios=(xi,))
        complete = (
            trace_ellipses(motions, request)
            .sel(curve="inscribed")
            .squeeze(["f", "xi", "threshold", "metric"])
        )
        for motion in motions:
            excitation = excitation_of(motion, request.window)
            for side, sign in (("lag", 1e-3), ("lead", -1e-3)):
                a, b = (float(complete[name].sel(motion=motion.name, side=side)) for name in ("a", "b"))
                actuators = {
                    "gain": 1.0 + np.sqrt(a) * np.cos(angles),
                    "delay": sign * np.sqrt(b) * np.sin(angles),
                }
                partial = [Structure(frequency=f, damping_ratio=xi, experimental_fraction=s) for s in shares]
                errors.append(
                    [
                        relative_error(
                            Loop(excitation=excitation, structure=part).deviation(
                                Cells(structure=part, **actuators)
                            ),
                            Metric.RMS,
                        ).max()
                        / 0.05
                        for part in partial
                    ]
                )
    return np.array(errors)


def test_partial_stiffness_improves_allowed_tests():
    errors = largest_errors(synthetic_suite(count=1), [(1.0, 0.02), (3.0, 0.1)], (0.05, 1.0))
    assert errors[:, -1] == pytest.approx(1.0, abs=0.03)
    assert errors[:, :-1].max() < 0.8


@pytest.mark.slow
def test_real_motions_allow_more_with_a_part_of_the_stiffness(real_motions_folder):
    from reliab import load_motions

    motions = load_motions(real_motions_folder)[::20]
    structures = [(f, xi) for f in (0.5, 1.0, 3.0) for xi in (0.01, 0.1)]
    errors = largest_errors(motions, structures, (0.05, 0.2, 0.5, 0.7))
    assert errors.max() < 0.9


def test_a_stiff_and_damped_structure_may_allow_less_with_a_part_of_the_stiffness():
    t = np.arange(0.0, 20.0, 0.005)
    slow = Excitation(acceleration=np.sin(2.0 * np.pi * t) * t * np.exp(-0.5 * t), time_step=0.005)
    part, complete = (
        first_order_ellipse(slow, Structure(frequency=20.0, damping_ratio=0.1, experimental_fraction=share))
        for share in (0.2, 1.0)
    )
    assert part.amplitude < complete.amplitude
